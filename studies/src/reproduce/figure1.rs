//! Figure 1: time against threads, 288 deformable boulders.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::Scale;
use super::paper::{FIGURE1, FIGURE1_TEXT};
use super::runs::Runs;
use crate::validate::chart::{self, Series};
use crate::validate::lines::Output;
use crate::validate::report::{Check, Report, markdown_table, short};

/// Threads of the runs.
const THREADS: [u32; 3] = [1, 2, 4];

/// How often each is timed, in turns: the shortest time counts, since others use the machine, too.
fn turns(scale: Scale) -> u32 {
    match scale {
        Scale::Quick => 1,
        Scale::Full => 3,
    }
}

/// Boulders and simulated time, s.
fn stretch(scale: Scale) -> (u32, f64) {
    match scale {
        Scale::Quick => (24, 0.1),
        Scale::Full => (288, 2.0),
    }
}

/// Arguments of the example `boulders`.
fn arguments(scale: Scale, threads: u32) -> String {
    let (boulders, seconds) = stretch(scale);
    format!("-p femdem-solve --example boulders -- {seconds} {threads} {boulders}")
}

/// The file of a run, in the folder of runs.
fn file(runs: &Path, scale: Scale, (turn, threads): Run) -> PathBuf {
    let (boulders, seconds) = stretch(scale);
    runs.join(format!(
        "boulders_{boulders}_{seconds}s_threads{threads}_turn{turn}.tsv"
    ))
}

/// Its turn and its threads.
type Run = (u32, u32);

fn all_runs(scale: Scale) -> impl Iterator<Item = Run> {
    (1..=turns(scale)).flat_map(|turn| THREADS.map(|threads| (turn, threads)))
}

/// The commands of the study, with the files in which their results are looked for.
pub(super) fn commands(runs: &Path, scale: Scale) -> Vec<String> {
    let command = |run: Run| {
        let file = file(runs, scale, run);
        let arguments = arguments(scale, run.1);
        format!(
            "cargo run --release --locked {arguments} > {}",
            file.display()
        )
    };
    all_runs(scale).map(command).collect()
}

/// The output of the example, from an earlier run or from one now. `None`: it is not to be run.
fn output(runs: &Runs, scale: Scale, run: Run) -> Result<Option<Output>> {
    let (file, arguments) = (file(runs.folder(), scale, run), arguments(scale, run.1));
    if file.is_file() {
        let (output, _) = Output::read(&file, &arguments)?;
        // The hash is printed last.
        if output.rows("hash").next().is_some() {
            return Ok(Some(output));
        }
    }
    if runs.is_as_found() {
        return Ok(None);
    }
    let (output, _) = Output::of(runs.workshop(), &arguments)?;
    fs::write(&file, output.to_text())
        .with_context(|| format!("cannot write {}", file.display()))?;
    Ok(Some(output))
}

/// Time on the clock and of all processors.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Timing {
    threads: f64,
    wall: f64,
    cpu: f64,
}

/// # Errors
/// When the example cannot be built or fails.
pub(super) fn run(runs: &Runs, scale: Scale) -> Result<Report> {
    let mut timings: Vec<Timing> = Vec::new();
    let mut hashes = std::collections::BTreeSet::new();
    let mut rows = Vec::new();
    for run in all_runs(scale) {
        let Some(output) = output(runs, scale, run)? else {
            continue;
        };
        let (turn, threads) = run;
        let number = |name: &str| output.number("number", &[name], 1);
        let timing = Timing {
            threads: f64::from(threads),
            wall: number("wall seconds"),
            cpu: number("processor seconds"),
        };
        hashes.extend(output.rows("hash").filter_map(|row| row.first().cloned()));
        rows.push(vec![
            turn.to_string(),
            threads.to_string(),
            short(timing.wall),
            short(timing.cpu),
            short(number("steps")),
            short(number("simulated seconds")),
        ]);
        match timings.iter_mut().find(|t| t.threads == timing.threads) {
            Some(best) if timing.wall < best.wall => *best = timing,
            Some(_) => {}
            None => timings.push(timing),
        }
    }
    let (found, wanted) = (rows.len(), all_runs(scale).count());
    let same = Check::holds(
        "state hashes",
        "all equal",
        format!("{} different", hashes.len()),
        hashes.len() == 1,
    );
    let (boulders, seconds) = stretch(scale);
    let mut report = Report {
        name: "figure1",
        title: "Figure 1: time against threads, deformable boulders".to_owned(),
        text: text(boulders, seconds, &timings),
        commands: THREADS
            .map(|threads| format!("cargo run --release --locked {}", arguments(scale, threads)))
            .to_vec(),
        checks: vec![
            Check::holds(
                "runs",
                "all",
                format!("{found} of {wanted}"),
                found == wanted,
            ),
            same,
        ],
        columns: vec!["turn", "threads", "wall_s", "cpu_s", "steps", "simulated_s"],
        rows,
        attachments: Vec::new(),
    };
    runs.attach(&mut report, "figure1.svg", &picture(&timings))?;
    Ok(report)
}

/// The serial share s of Amdahl's law, T(n) = T(1) (s + (1 - s)/n), by least squares in T(n)/T(1).
fn serial_share(times: &[(f64, f64)]) -> Option<f64> {
    let &(one, first) = times.first()?;
    if one != 1.0 {
        return None;
    }
    let (mut above, mut below) = (0.0, 0.0);
    for (threads, time) in times.iter().skip(1) {
        let lever = 1.0 - 1.0 / threads;
        above += lever * (time / first - 1.0 / threads);
        below += lever * lever;
    }
    (below > 0.0).then(|| above / below)
}

/// The speedup of Amdahl's law.
fn amdahl(share: f64, threads: f64) -> f64 {
    1.0 / (share + (1.0 - share) / threads)
}

fn times(timings: &[Timing]) -> Vec<(f64, f64)> {
    timings.iter().map(|t| (t.threads, t.wall)).collect()
}

fn text(boulders: u32, seconds: f64, timings: &[Timing]) -> String {
    let ours = serial_share(&times(timings));
    let paper = serial_share(&FIGURE1);
    let told =
        |share: Option<f64>| share.map_or_else(|| "unknown".to_owned(), |s| format!("{s:.3}"));
    let predicted = |share: Option<f64>, threads: f64| {
        share.map_or_else(
            || "unknown".to_owned(),
            |s| format!("{:.1}", amdahl(s, threads)),
        )
    };
    let rows: Vec<Vec<String>> = [2.0, 4.0, 8.0, 12.0]
        .into_iter()
        .map(|threads| {
            let speedup = |list: &[(f64, f64)]| {
                let (_, first) = *list.first()?;
                let (_, time) = list.iter().find(|(n, _)| *n == threads)?;
                Some(first / time)
            };
            let cell =
                |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.2}"));
            let stated = FIGURE1_TEXT
                .iter()
                .find(|(n, _)| *n == threads)
                .map(|(_, s)| *s);
            vec![
                threads.to_string(),
                cell(speedup(&times(timings))),
                predicted(ours, threads),
                cell(speedup(&FIGURE1)),
                cell(stated),
            ]
        })
        .collect();
    let cpu = timings.first().map_or(f64::NAN, |t| t.cpu / seconds);
    format!(
        "{boulders} deformable boulders fall into the founding paper's bin for {seconds} simulated seconds, with the same \
         bits on any number of threads; the fastest of several turns counts. One thread takes {} s of processor time per \
         simulated second. The paper's machine, elements and simulated time are others, so speedups are compared. The share \
         of the time that does not gain from threads, by Amdahl's law: **{}** here, {} in the paper.\n\n{}\n![Chart](figure1.svg)",
        short(cpu),
        told(ours),
        told(paper),
        markdown_table(
            &[
                "threads",
                "measured here",
                "Amdahl's law with our share",
                "paper, by its figure",
                "paper, by its text",
            ],
            &rows
        )
    )
}

fn picture(timings: &[Timing]) -> String {
    let series = |name: &str, list: &[(f64, f64)]| Series {
        name: name.to_owned(),
        points: list
            .first()
            .map(|(_, first)| list.iter().map(|(n, time)| [*n, first / time]).collect())
            .unwrap_or_default(),
    };
    let ours = times(timings);
    let mut lines = vec![series("here", &ours), series("paper", &FIGURE1)];
    if let Some(share) = serial_share(&ours) {
        lines.push(Series {
            name: format!("Amdahl, s = {share:.3}"),
            points: (1..=12)
                .map(|n| [f64::from(n), amdahl(share, f64::from(n))])
                .collect(),
        });
    }
    chart::svg(["threads", "speedup"], [0.0, 12.0], [0.0, 12.0], &lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_exact_times_is_found() {
        let time = |n: f64| 50.0 * (0.07 + 0.93 / n);
        let times: Vec<(f64, f64)> = [1.0, 2.0, 4.0].into_iter().map(|n| (n, time(n))).collect();
        let share = serial_share(&times).unwrap();
        assert!((share - 0.07).abs() < 1e-12, "{share}");
        assert!((amdahl(share, 1.0) - 1.0).abs() < 1e-12);
        assert_eq!(serial_share(&times[..1]), None);
        assert_eq!(serial_share(&times[1..]), None);
    }

    /// The paper's speedups of 6.5 and 9 are near those of its own figure.
    #[test]
    fn the_papers_text_and_figure_agree() {
        for (threads, stated) in FIGURE1_TEXT {
            let (_, minutes) = FIGURE1.iter().find(|(n, _)| *n == threads).unwrap();
            assert!(
                (FIGURE1[0].1 / minutes / stated - 1.0).abs() < 0.12,
                "{threads}"
            );
        }
    }
}
