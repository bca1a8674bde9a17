//! Cost per body and step, and memory per body, from 1,000 to 30,000 bodies.

use anyhow::Result;

use super::lines::Output;
use super::program::Workshop;
use super::report::{Check, Report, short};

/// Copies of the column of 250 bodies along x and y.
const COPIES: [[u32; 2]; 4] = [[2, 2], [3, 4], [5, 8], [10, 12]];

/// Steps of the copies before the cost is measured, rounds of which the fastest counts, and steps per round.
const STEPS: &str = "500 10 10";

/// The largest part by which the cost may differ from that of the smallest pack.
const FLAT: f64 = 0.15;

/// Largest memory of a body, bytes.
const MEMORY: f64 = 4096.0;

/// Packs of the program whose peak memories are compared.
const PROGRAM: [u32; 2] = [250, 2000];

/// Quantities of the example, with their columns.
const NUMBERS: [(&str, &str); 6] = [
    ("bodies", "bodies"),
    (
        "least microseconds per body-step",
        "microseconds_per_body_step",
    ),
    ("median microseconds per body-step", "median_microseconds"),
    ("touching pairs per body", "touching_pairs_per_body"),
    ("candidate pairs per body", "candidate_pairs_per_body"),
    ("bytes per body", "bytes_per_body"),
];

/// Steps packs of up to 30,000 bodies (with `count`, up to that many), and makes packs with the program.
///
/// # Errors
/// When the example or the program cannot be built or fails.
pub(crate) fn run(workshop: &Workshop, count: Option<u32>) -> Result<Report> {
    let largest = count.unwrap_or(u32::MAX);
    let (mut commands, mut rows, mut costs, mut bytes) = (vec![], vec![], vec![], vec![]);
    for [x, y] in COPIES
        .into_iter()
        .filter(|[x, y]| 250 * x * y <= largest.max(1000))
    {
        let example = format!("-p femdem-pack --example size -- {x}x{y} {STEPS}");
        let (output, command) = Output::of(workshop, &example)?;
        commands.push(command);
        let number = |name: &str| output.number("number", &[name], 1);
        costs.push(number("least microseconds per body-step"));
        bytes.push(number("bytes per body"));
        rows.push(
            NUMBERS
                .iter()
                .map(|(name, _)| short(number(name)))
                .collect(),
        );
    }
    let program = workshop.build("femdem", &[])?;
    let mut peaks = Vec::new();
    for bodies in PROGRAM {
        let options = format!("--shape A10 --count {bodies} --box 7x7 --threads 1 --penalty 5.2e6");
        let folder = workshop.results(&format!("size-{bodies}"));
        let summary = program.pack(&options, &folder)?;
        peaks.push(summary.number("peak_memory_bytes")?);
        commands.push(format!("cargo run --release -- pack {options}"));
    }
    let added = (peaks[1] - peaks[0]) / f64::from(PROGRAM[1] - PROGRAM[0]);
    let most = bytes.iter().copied().fold(0.0, f64::max);
    Ok(Report {
        name: "size",
        title: "Cost and memory per body, 1,000 to 30,000 bodies".to_owned(),
        text: text(&peaks),
        commands,
        checks: vec![
            flatness(&costs),
            Check::at_most("memory per body in the world", most, MEMORY, "bytes"),
            Check::at_most(
                "peak of the program while it packs, per added body",
                added,
                MEMORY,
                "bytes",
            ),
        ],
        columns: NUMBERS.iter().map(|(_, column)| *column).collect(),
        rows,
        attachments: Vec::new(),
    })
}

fn text(peaks: &[f64]) -> String {
    let megabytes: Vec<String> = peaks.iter().map(|p| format!("{:.1} MB", p / 1e6)).collect();
    format!(
        "A column of 250 truncated dodecahedra settles once; N bodies are copies of it side by side. All are awake; one \
         thread. Cost is processor time of a step over the bodies, the least of ten rounds of ten steps. Memory is what the \
         process holds more than before the world was made. The program's peak memory while it packs in sequence is {} with \
         {} and {} bodies.",
        megabytes.join(" and "),
        PROGRAM[0],
        PROGRAM[1]
    )
}

fn flatness(costs: &[f64]) -> Check {
    let first = costs.first().copied().unwrap_or(f64::NAN);
    let ratios: Vec<f64> = costs.iter().map(|cost| cost / first).collect();
    let list: Vec<String> = ratios.iter().map(|ratio| format!("{ratio:.2}")).collect();
    Check::holds(
        "cost per body and step over the smallest pack's",
        &format!("1 within {FLAT}"),
        list.join(", "),
        ratios.iter().all(|ratio| (ratio - 1.0).abs() <= FLAT),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stays_near_the_smallest_is_flat() {
        assert!(flatness(&[4.0, 4.5, 3.5]).met);
        assert!(!flatness(&[4.0, 4.7]).met);
        assert!(!flatness(&[4.0, 3.3]).met);
        assert!(!flatness(&[f64::NAN, 1.0]).met);
    }
}
