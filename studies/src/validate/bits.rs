//! The same bits: at any number of threads, without the feature `parallel`, through a restart.

use std::collections::BTreeSet;
use std::time::Duration;

use anyhow::Result;

use super::program::{Summary, Workshop};
use super::report::{Check, Report, short};

/// Times of the interruptions, as parts of the time of the uninterrupted run.
const INTERRUPTIONS: [f64; 2] = [0.2, 0.6];

const COLUMNS: [&str; 5] = ["run", "steps", "settled", "wall_seconds", "state_hash"];

/// Packs `count` bodies at 1, 2 and 3 threads, and with the serial program.
///
/// # Errors
/// When a program cannot be built or fails.
pub(crate) fn threads(workshop: &Workshop, count: u32) -> Result<Report> {
    let parallel = workshop.build("femdem", &[])?;
    let serial = workshop.build("femdem-serial", &["--no-default-features"])?;
    let (mut commands, mut rows) = (Vec::new(), Vec::new());
    let runs = [
        (&parallel, "", "1 thread", 1),
        (&parallel, "", "2 threads", 2),
        (&parallel, "", "3 threads", 3),
        (&serial, " --no-default-features", "without parallel", 1),
    ];
    for (program, features, name, threads) in runs {
        let options = format!("--count {count} --threads {threads}");
        let folder = workshop.results(&format!("threads{}-{threads}", features.trim()));
        rows.push(row(name, &program.pack(&options, &folder)?)?);
        commands.push(format!("cargo run --release{features} -- pack {options}"));
    }
    Ok(Report {
        name: "threads",
        title: "The same bits at any number of threads".to_owned(),
        text: format!(
            "{count} truncated dodecahedra at the program's defaults. The state hash is made of all \
             bits of the state at the end: poses, velocities, friction history, caches, ledger."
        ),
        commands,
        checks: vec![equal_hashes(&rows)],
        columns: COLUMNS.to_vec(),
        rows,
        attachments: Vec::new(),
    })
}

/// Packs `count` bodies in one go, and with an interruption early and late.
///
/// # Errors
/// When the program cannot be built or fails.
pub(crate) fn restart(workshop: &Workshop, count: u32) -> Result<Report> {
    let program = workshop.build("femdem", &[])?;
    let options = format!("--count {count} --threads 2");
    let whole = program.pack(&options, &workshop.results("whole"))?;
    let mut commands = vec![format!("cargo run --release -- pack {options}")];
    let mut rows = vec![row("in one go", &whole)?];
    for part in INTERRUPTIONS {
        let after = part * whole.number("wall_seconds")?;
        let folder = workshop.results(&format!("parts-{part}"));
        program.pack_interrupted(&options, &folder, Duration::from_secs_f64(after))?;
        let resumed = program.resume("--threads 3", &folder)?;
        rows.push(row(
            &format!("interrupted after {} s, resumed", short(after)),
            &resumed,
        )?);
        commands.push(format!(
            "cargo run --release -- pack {options} --out DIR  # Ctrl-C after {} s\n\
             cargo run --release -- resume DIR --threads 3",
            short(after)
        ));
    }
    Ok(Report {
        name: "restart",
        title: "The same bits through an interruption".to_owned(),
        text: format!(
            "{count} truncated dodecahedra at the program's defaults: in one go on two threads, and \
             twice stopped by Ctrl-C (SIGINT), which leaves a checkpoint, and resumed on three."
        ),
        commands,
        checks: vec![equal_hashes(&rows)],
        columns: COLUMNS.to_vec(),
        rows,
        attachments: Vec::new(),
    })
}

fn row(name: &str, summary: &Summary) -> Result<Vec<String>> {
    Ok(vec![
        name.to_owned(),
        short(summary.number("steps")?),
        summary.is_settled().to_string(),
        short(summary.number("wall_seconds")?),
        summary.hash()?,
    ])
}

/// The hash is the last cell of a row.
fn equal_hashes(rows: &[Vec<String>]) -> Check {
    let hashes: BTreeSet<_> = rows.iter().filter_map(|row| row.last()).collect();
    let measured = format!("{} different in {} runs", hashes.len(), rows.len());
    Check::holds("state hashes", "all equal", measured, hashes.len() == 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(hashes: &[&str]) -> Vec<Vec<String>> {
        hashes
            .iter()
            .map(|hash| vec!["run".to_owned(), (*hash).to_owned()])
            .collect()
    }

    #[test]
    fn one_hash_for_all_runs_or_not() {
        assert!(equal_hashes(&rows(&["a", "a", "a"])).met);
        assert!(!equal_hashes(&rows(&["a", "a", "b"])).met);
        assert!(!equal_hashes(&rows(&[])).met);
    }

    #[test]
    fn a_row_ends_with_the_hash() {
        let text = r#"{"settled": true, "steps": 12, "wall_seconds": 1.5, "state_hash": "f0"}"#;
        let row = row("x", &Summary::parse(text).unwrap()).unwrap();
        assert_eq!(row, ["x", "12", "true", "1.5", "f0"]);
        assert_eq!(row.len(), COLUMNS.len());
    }
}
