//! The main job at its defaults.

use anyhow::Result;

use super::program::{Summary, Workshop};
use super::report::{Check, Report, short};

/// Packs `count` truncated dodecahedra on two threads.
///
/// # Errors
/// When the program cannot be built or fails.
pub(crate) fn run(workshop: &Workshop, count: u32) -> Result<Report> {
    let options = format!("--shape A10 --count {count} --friction 0.6 --seed 1 --threads 2");
    let program = workshop.build("femdem", &[])?;
    let summary = program.pack(&options, &workshop.results("pack500"))?;
    Ok(Report {
        name: "pack500",
        title: format!("The main job: {count} truncated dodecahedra"),
        text: "Sequential deposition at the program's defaults on two threads. A residual is the net \
               force on a body at the end, with all bodies awake, over its weight. The target is for the \
               net force over the larger of weight and mean contact force, which is at most that."
            .to_owned(),
        commands: vec![format!("cargo run --release -- pack {options}")],
        checks: checks(&summary)?,
        columns: vec!["quantity", "value"],
        rows: rows(&summary)?,
        attachments: Vec::new(),
    })
}

fn checks(summary: &Summary) -> Result<Vec<Check>> {
    let number = |path| summary.number(path);
    let settled = summary.is_settled();
    Ok(vec![
        Check::holds(
            "settled, verified with all bodies awake",
            "true",
            settled,
            settled,
        ),
        Check::at_most("time on the clock", number("wall_seconds")?, 60.0, "s"),
        Check::at_most(
            "mean penetration over d",
            number("penetration.mean_over_d")?,
            0.005,
            "",
        ),
        Check::at_most(
            "largest residual over weight",
            number("residual.max_over_weight")?,
            0.02,
            "",
        ),
    ])
}

/// The numbers of the summary that are listed on the page.
///
/// # Errors
/// When the summary has no fingerprint.
pub(super) fn rows(summary: &Summary) -> Result<Vec<Vec<String>>> {
    let paths = [
        "count",
        "threads",
        "wall_seconds",
        "cpu_seconds",
        "contact_nanoseconds_per_pair",
        "steps",
        "time_step",
        "simulated_time",
        "contact.penalty",
        "packing_density.exact",
        "packing_density.grid",
        "packing_density.standard_error",
        "coordination.mean",
        "penetration.mean_over_d",
        "penetration.max_over_d",
        "penetration.overlap_volume_fraction",
        "residual.mean_over_weight",
        "residual.max_over_weight",
        "residual.kinetic_energy_over_mgd",
        "energy.ledger_error_relative",
        "peak_memory_bytes",
    ];
    let mut rows = Vec::new();
    for path in paths {
        // A small trial has no core, and a system may not report the memory.
        let value = summary
            .number(path)
            .map_or_else(|_| "none".to_owned(), short);
        rows.push(vec![path.to_owned(), value]);
    }
    rows.push(vec!["state_hash".to_owned(), summary.hash()?]);
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary(wall: f64, residual: f64) -> Summary {
        Summary::parse(&format!(
            r#"{{"settled": true, "wall_seconds": {wall}, "state_hash": "ab",
                "penetration": {{"mean_over_d": 0.004}}, "residual": {{"max_over_weight": {residual}}}}}"#
        ))
        .unwrap()
    }

    #[test]
    fn each_figure_is_judged_by_itself() {
        let met = |wall, residual| -> Vec<bool> {
            let checks = checks(&summary(wall, residual)).unwrap();
            checks.iter().map(|check| check.met).collect()
        };
        assert_eq!(met(50.0, 0.01), [true; 4]);
        assert_eq!(met(61.0, 0.03), [true, false, true, false]);
    }

    #[test]
    fn numbers_that_were_not_found_are_none() {
        let rows = rows(&summary(50.0, 0.01)).unwrap();
        let value = |name: &str| rows.iter().find(|row| row[0] == name).unwrap()[1].clone();
        assert_eq!(value("packing_density.exact"), "none");
        assert_eq!(value("wall_seconds"), "50");
        assert_eq!(value("state_hash"), "ab");
    }
}
