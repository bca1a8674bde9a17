//! Deformable boulders dumped in the founding paper's bin.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Result;

use super::lines::{Output, cell};
use super::program::Workshop;
use super::report::{Check, Report, short};

/// Threads of the short runs.
const THREADS: [u32; 3] = [1, 2, 4];

/// Threads of the runs to rest: two threads that share a core would take half as much processor time again.
const REST_THREADS: u32 = 1;

/// Simulated seconds of the short runs, one for each number of threads.
const SHORT: f64 = 0.5;

/// Simulated seconds in the medium at the end of the long run, and again without it.
const SETTLING: f64 = 0.5;

/// Simulated seconds before all boulders are woken in the run with freezing, over those of the run without.
const FROZEN: f64 = 8.0 / 11.0;

/// Kinetic energy over m g d of a boulder that counts as rest.
const REST: f64 = 1e-6;

/// Quantities in the table, by run.
const NUMBERS: [&str; 13] = [
    "wall seconds",
    "processor seconds",
    "simulated seconds",
    "steps",
    "step",
    "processor seconds per simulated second",
    "all-in ns per tet-step",
    "elements ns per tet-step",
    "kinetic energy over m g d without a medium",
    "kinetic energy over m g d as the medium ends",
    "kinetic energy over m g d",
    "mean penetration over d",
    "ledger error",
];

/// Dumps `count` boulders for a simulated time, s, and lets them settle; then with boulders at rest frozen;
/// then for a short time at 1, 2 and 4 threads. `earlier` is a folder with earlier output of the example
/// (rest.tsv, frozen.tsv, 1.tsv, 2.tsv, 4.tsv) and the boulders that it wrote (pack).
///
/// # Errors
/// When the example or the program cannot be built or fails, or a file cannot be read.
pub(crate) fn run(
    workshop: &Workshop,
    count: u32,
    seconds: f64,
    earlier: Option<&Path>,
) -> Result<Report> {
    let folder = match earlier {
        Some(earlier) => earlier.join("pack"),
        None => workshop.results("boulders-deformable"),
    };
    let place = format!(" {}", folder.display());
    let rest = format!("{seconds} {REST_THREADS} {count} {SETTLING}{place}");
    let frozen = FROZEN * seconds;
    let frozen = format!("{frozen} {REST_THREADS} {count} {SETTLING} sleep");
    let mut runs = vec![("rest".to_owned(), rest), ("frozen".to_owned(), frozen)];
    runs.extend(THREADS.map(|n| (n.to_string(), format!("{SHORT} {n} {count}"))));
    let mut outputs = Vec::new();
    let mut commands = Vec::new();
    for (name, arguments) in runs {
        let example = format!("-p femdem-solve --example boulders -- {arguments}");
        let (output, command) = match earlier {
            Some(earlier) => Output::read(&earlier.join(format!("{name}.tsv")), &example)?,
            None => Output::of(workshop, &example)?,
        };
        outputs.push(output);
        commands.push(command.replace(&place, ""));
    }
    let program = workshop.build("femdem", &[])?;
    let picture = program.picture(&folder, &workshop.results("boulders-deformable.png"))?;
    Ok(Report {
        name: "boulders-deformable",
        title: format!("{count} deformable boulders in a bin of 5.26 m x 5.3 m x 3.87 m"),
        text: text(&outputs[0]) + &growth(&outputs[0]) + &asleep(&outputs[1]) + note(earlier),
        commands,
        checks: checks(&outputs),
        columns: vec![
            "quantity",
            "to rest, 1 thread",
            "frozen at rest, 1 thread",
            "1 thread",
            "2 threads",
            "4 threads",
        ],
        rows: rows(&outputs),
        attachments: vec![picture],
    })
}

/// The text of a page on the energy between the end of the medium and the end. Vibrations inside the boulders
/// vary by a fifth, far below the limit; boulders that gain speed again are not at rest, even below it.
fn growth(first: &Output) -> String {
    let [start, end] = [
        "kinetic energy over m g d as the medium ends",
        "kinetic energy over m g d",
    ]
    .map(|name| number(first, name));
    let verdict = if end <= start {
        "it does not grow."
    } else if end <= 0.1 * REST {
        "it goes up and down, far below the limit, as what rings inside the boulders does."
    } else {
        "it grows again: below the limit at the end, but **rest is not shown**."
    };
    format!(
        "\nThe kinetic energy is {} m g d as the medium ends and {} at the end without it: {verdict}\n",
        short(start),
        short(end)
    )
}

/// The note on a page made of earlier lines.
fn note(earlier: Option<&Path>) -> &'static str {
    match earlier {
        Some(_) => "\nOther work shared the machine.\n",
        None => "",
    }
}

fn number(output: &Output, name: &str) -> f64 {
    output.number("number", &[name], 1)
}

fn hash(output: &Output) -> String {
    let row = output.rows("hash").next();
    row.and_then(|row| row.first().cloned()).unwrap_or_default()
}

fn text(first: &Output) -> String {
    format!(
        "Boulders of 40 kg, 50 different ones in turn, with {} linear neo-Hookean tetrahedra in all, E = 1e8 Pa, nu = 0.2, \
         kappa h/E = 1. They start at rest on a lattice of 8 x 6 x 6 and fall at once, all awake in every step. What still \
         rings inside them at the end is taken for {SETTLING} s by a medium (drag 10 1/s); the last {SETTLING} s are without it.\n\n\
         ![The pack](boulders-deformable.png)\n\n\
         The run to rest; rates are those of the time since the line above:\n\n{}",
        number(first, "tets"),
        progress(first)
    )
}

/// The lines of progress of a run.
fn progress(of: &Output) -> String {
    let lines = of.rows("progress");
    let lines: String = lines
        .map(|row| format!("| {} |\n", row.join(" | ")))
        .collect();
    format!(
        "| time, s | steps | step, s | processor seconds | per simulated second | ns per tet-step | touching \
         pairs | candidate tetrahedra | overlapping | awake | kinetic energy over m g d |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n{lines}"
    )
}

/// The text of a page on the run in which boulders at rest are frozen.
fn asleep(of: &Output) -> String {
    format!(
        "\nThe same with boulders at rest frozen (`sleeping.deformables`), without a medium. All are woken {} s before \
         the end, and for the last {SETTLING} s none may sleep, so that what is at rest there rests by itself:\n\n{}",
        2.0 * SETTLING,
        progress(of)
    )
}

fn checks(outputs: &[Output]) -> Vec<Check> {
    let one = &outputs[0];
    let frozen = &outputs[1];
    let hashes: BTreeSet<String> = outputs.iter().skip(2).map(hash).collect();
    let energy = |of| number(of, "kinetic energy over m g d");
    let most =
        |name: &str, limit: f64, unit: &str| Check::at_most(name, number(one, name), limit, unit);
    vec![
        Check::at_most(
            "kinetic energy over m g d at the end",
            energy(one),
            REST,
            "",
        ),
        Check::at_most(
            "kinetic energy over m g d at the end, frozen at rest and woken",
            energy(frozen),
            REST,
            "",
        ),
        most("above the rim", 0.0, ""),
        most("processor seconds per simulated second", 80.0, "s"),
        most("elements ns per tet-step", 10.0, "ns"),
        most("all-in ns per tet-step", 25.0, "ns"),
        Check::at_most(
            "all-in ns per tet-step, at rest and frozen",
            at_rest(frozen),
            25.0,
            "ns",
        ),
        Check::holds(
            "state hashes at 1, 2 and 4 threads",
            "all equal",
            format!("{} different", hashes.len()),
            hashes.len() == 1 && !hashes.contains(""),
        ),
    ]
}

/// Total time per tetrahedron and step in the last line of progress in which boulders are frozen, ns.
fn at_rest(of: &Output) -> f64 {
    let all = number(of, "boulders");
    let frozen = of.rows("progress").filter(|row| cell(row, 9) < all);
    frozen.last().map_or(f64::NAN, |row| cell(row, 5))
}

fn rows(outputs: &[Output]) -> Vec<Vec<String>> {
    let line = |name: &&str| {
        let cells = outputs.iter().map(|output| short(number(output, name)));
        std::iter::once((*name).to_owned()).chain(cells).collect()
    };
    let hashes = std::iter::once("state hash".to_owned()).chain(outputs.iter().map(hash));
    let mut rows: Vec<Vec<String>> = NUMBERS.iter().map(line).collect();
    rows.push(hashes.collect());
    // The last rate is that of the settled pack.
    let last = |output: &Output| {
        output
            .rows("progress")
            .last()
            .map_or(f64::NAN, |row| cell(row, 5))
    };
    let settled = outputs.iter().map(|output| short(last(output)));
    rows.push(
        std::iter::once("ns per tet-step at the end".to_owned())
            .chain(settled)
            .collect(),
    );
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_energy_does_without_the_medium_is_told() {
        let told = |start: &str, end: &str| {
            growth(&Output::parse(&format!(
                "number\tkinetic energy over m g d as the medium ends\t{start}\n\
                 number\tkinetic energy over m g d\t{end}\n"
            )))
        };
        assert!(told("1e-8", "9e-7").contains("not shown"));
        assert!(told("9e-7", "1e-8").contains("does not grow"));
        assert!(told("7e-9", "9e-9").contains("up and down"));
    }

    #[test]
    fn one_hash_and_all_figures_or_a_report_missed() {
        let text = |hash: &str, rate: u32| {
            format!(
                "number\tkinetic energy over m g d\t1e-8\nnumber\tabove the rim\t0\n\
                 number\tprocessor seconds per simulated second\t79\n\
                 number\telements ns per tet-step\t9\nnumber\tall-in ns per tet-step\t26\n\
                 number\tboulders\t9\nprogress\t1\t2\t3\t4\t5\t{rate}\t6\t7\t8\t2\nhash\t{hash}\n"
            )
        };
        let met = |hashes: [&str; 2]| {
            let all = [
                ("longer", 26),
                ("frozen", 9),
                (hashes[0], 26),
                (hashes[1], 26),
            ];
            let outputs = all.map(|(hash, rate)| Output::parse(&text(hash, rate)));
            checks(&outputs).iter().map(|c| c.met).collect::<Vec<_>>()
        };
        let figures = [true, true, true, true, true, false, true];
        assert_eq!(met(["a", "a"]), [&figures[..], &[true]].concat());
        assert_eq!(met(["a", "b"]), [&figures[..], &[false]].concat());
    }
}
