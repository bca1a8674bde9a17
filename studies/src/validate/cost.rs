//! Processor time per deposited body as packs grow.

use anyhow::Result;

use super::program::{Summary, Workshop};
use super::report::{Check, Report, short};

/// Sizes of the packs, as multiples of the smallest.
const SIZES: [u32; 4] = [1, 2, 4, 8];

/// Penalty of the first series, in Pa: about the default for 500 bodies in this box.
const PENALTY: &str = "5.2e6";

/// The largest part by which the cost per body may differ from that of the smallest pack.
const FLAT: f64 = 0.15;

/// A way to choose box and penalty, with its options.
const SERIES: [(&str, &str); 2] = [("fixed", "--box 7x7 --penalty 5.2e6"), ("defaults", "")];

/// Packs `smallest` to eight times as many bodies, in boxes of one width and in default boxes.
///
/// # Errors
/// When the program cannot be built or fails.
pub(crate) fn run(workshop: &Workshop, smallest: u32) -> Result<Report> {
    let program = workshop.build("femdem", &[])?;
    let (mut commands, mut checks, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    for (series, choice) in SERIES {
        let mut costs = Vec::new();
        for size in SIZES {
            let count = smallest * size;
            let options = format!("--count {count} --threads 1 {choice}");
            let summary =
                program.pack(&options, &workshop.results(&format!("{series}-{count}")))?;
            commands.push(format!(
                "cargo run --release -- pack {}",
                options.trim_end()
            ));
            costs.push(summary.number("cpu_seconds")? / f64::from(count));
            rows.push(row(series, count, &summary, &costs)?);
        }
        checks.push(flatness(series, &costs));
    }
    Ok(Report {
        name: "cost",
        title: format!("Cost per body, {smallest} to {} bodies", 8 * smallest),
        text: format!(
            "Truncated dodecahedra on one thread. Processor time of the whole run, verification and \
             files included, over the number of bodies; its ratio to the smallest pack's is to stay \
             within {FLAT} of 1. In the series \"fixed\" the box is 7 d x 7 d and the penalty \
             {PENALTY} Pa for all, so that more bodies make a higher tower; in the series \
             \"defaults\" the box is as wide as the pack is high and the penalty grows with the load, \
             so that the time step shrinks."
        ),
        commands,
        checks,
        columns: vec![
            "series",
            "bodies",
            "penalty_pa",
            "cpu_seconds",
            "cpu_milliseconds_per_body",
            "ratio",
            "steps",
            "time_step",
            "contact_nanoseconds_per_pair",
            "mean_penetration_over_d",
            "settled",
            "peak_memory_bytes",
        ],
        rows,
        attachments: Vec::new(),
    })
}

/// A row of the table; the cost of this run is the last of `costs`.
fn row(series: &str, count: u32, summary: &Summary, costs: &[f64]) -> Result<Vec<String>> {
    let number = |path| summary.number(path).map(short);
    Ok(vec![
        series.to_owned(),
        count.to_string(),
        number("contact.penalty")?,
        number("cpu_seconds")?,
        short(1e3 * costs.last().copied().unwrap_or_default()),
        short(ratios(costs).last().copied().unwrap_or_default()),
        number("steps")?,
        number("time_step")?,
        number("contact_nanoseconds_per_pair")?,
        number("penetration.mean_over_d")?,
        summary.is_settled().to_string(),
        number("peak_memory_bytes").unwrap_or_else(|_| "none".to_owned()),
    ])
}

/// Costs over the first.
fn ratios(costs: &[f64]) -> Vec<f64> {
    let first = costs.first().copied().unwrap_or(f64::NAN);
    costs.iter().map(|cost| cost / first).collect()
}

fn flatness(series: &str, costs: &[f64]) -> Check {
    let ratios = ratios(costs);
    let met = ratios.iter().all(|ratio| (ratio - 1.0).abs() <= FLAT);
    let list: Vec<String> = ratios.iter().map(|ratio| format!("{ratio:.2}")).collect();
    Check::holds(
        &format!("cost per body over the smallest pack's, series {series}"),
        &format!("1 within {FLAT}"),
        list.join(", "),
        met,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_and_decline_beyond_the_limit_are_not_flat() {
        assert!(flatness("x", &[0.10, 0.11, 0.09, 0.1149]).met);
        assert!(!flatness("x", &[0.10, 0.10, 0.12]).met);
        assert!(!flatness("x", &[0.10, 0.08]).met);
        assert!(!flatness("x", &[0.0, 0.1]).met);
        assert_eq!(flatness("x", &[0.10, 0.11]).measured, "1.00, 1.10");
    }

    #[test]
    fn the_fixed_series_states_the_penalty_it_uses() {
        assert!(SERIES[0].1.ends_with(PENALTY));
    }
}
