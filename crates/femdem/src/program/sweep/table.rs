//! The table of a sweep, and its chart.

use anyhow::{Result, bail};
use femdem::output;
use femdem::output::csv::quoted;
use femdem::plot::{Series, sweep};

use super::{Job, SweepArgs};

/// Numbers of the summary of a pack that the table has, by their keys.
const OF_PACK: [&str; 10] = [
    "settled",
    "packing_density.exact",
    "coordination.mean",
    "penetration.mean_over_d",
    "penetration.max_over_d",
    "residual.max_over_weight",
    "container.mean_top",
    "simulated_time",
    "steps",
    "wall_seconds",
];

/// The same of a run.
const OF_RUN: [&str; 11] = [
    "rest.at_rest",
    "rest.residual",
    "contacts",
    "penetration.peak",
    "energy.kinetic",
    "energy.work_in",
    "energy.dissipated_friction",
    "energy.ledger_error_relative",
    "simulated_time",
    "steps",
    "wall_seconds",
];

/// Name of the table.
pub(super) const TABLE: &str = "sweep.csv";

/// Name of the chart.
pub(super) const CHART: &str = "sweep.svg";

/// What is told of a gauge, sink or source of a run.
const OF_FLOW: [&str; 3] = ["bodies", "mass", "mean_rate"];

/// Numbers of the table: those of a pack, or of a run with gauges, sinks and sources of these names.
pub(super) fn columns(flow: Option<&[String]>) -> Vec<String> {
    let Some(flow) = flow else {
        return OF_PACK.map(str::to_owned).to_vec();
    };
    let counted = |name: &String| OF_FLOW.map(|number| format!("flow.{name}.{number}"));
    let fixed = OF_RUN.map(str::to_owned).into_iter();
    fixed.chain(flow.iter().flat_map(counted)).collect()
}

/// The column that the chart shows.
fn charted(args: &SweepArgs, is_run: bool) -> &str {
    let usual = if is_run {
        "energy.dissipated_friction"
    } else {
        "packing_density.exact"
    };
    args.chart.as_deref().unwrap_or(usual)
}

/// Refuses a chart of a number that the table does not have.
pub(super) fn check(args: &SweepArgs, known: &[String], is_run: bool) -> Result<()> {
    let wanted = charted(args, is_run);
    if !known.iter().any(|column| column == wanted) {
        bail!(
            "--chart {wanted}: the table has no such column, but {}",
            known.join(", ")
        );
    }
    Ok(())
}

/// Means and standard errors of the finished jobs of a combination.
struct Row<'a> {
    values: &'a [String],
    means: Vec<Option<f64>>,
    errors: Vec<Option<f64>>,
}

/// Writes the table of the jobs that are finished, and the chart if there are two points for it; returns whether there are.
pub(super) fn write(args: &SweepArgs, jobs: &[Job], keys: &[String], is_run: bool) -> Result<bool> {
    let mut rows = Vec::new();
    let varied: Vec<String> = args.vary.iter().map(|vary| quoted(&vary.key)).collect();
    let varied: Vec<&str> = varied.iter().map(String::as_str).collect();
    let named: Vec<String> = keys.iter().map(|key| quoted(key)).collect();
    let named: Vec<&str> = named.iter().map(String::as_str).collect();
    let head = ["row"].iter().chain(&varied).chain(&["seed"]).chain(&named);
    let mut lines = vec![head.copied().collect::<Vec<_>>().join(",")];
    let mut line = |row: &str, job: &Job, seed: String, numbers: &[Option<f64>]| {
        let values = job.values.iter().map(|value| quoted(value));
        let numbers = numbers
            .iter()
            .map(|x| x.map_or(String::new(), |x| x.to_string()));
        let fields = [row.to_owned()]
            .into_iter()
            .chain(values)
            .chain([seed])
            .chain(numbers);
        lines.push(fields.collect::<Vec<_>>().join(","));
    };
    for combination in jobs.chunk_by(|a, b| a.values == b.values) {
        let mut found = Vec::new();
        for job in combination {
            let Some(numbers) = job.numbers(keys) else {
                continue;
            };
            let seed = job.seed.map_or(String::new(), |seed| seed.to_string());
            line("job", job, seed, &numbers);
            found.push(numbers);
        }
        if found.is_empty() {
            continue;
        }
        let columns = (0..keys.len()).map(|k| found.iter().filter_map(|row| row[k]).collect());
        let columns: Vec<Vec<f64>> = columns.collect();
        let [means, errors] =
            [mean, standard_error].map(|of| columns.iter().map(|c| of(c)).collect::<Vec<_>>());
        line("mean", &combination[0], String::new(), &means);
        line("standard error", &combination[0], String::new(), &errors);
        rows.push(Row {
            values: &combination[0].values,
            means,
            errors,
        });
    }
    lines.push(String::new());
    output::write_file(args.out.join(TABLE), |w| {
        std::io::Write::write_all(w, lines.join("\n").as_bytes())
    })?;
    let name = charted(args, is_run);
    let column = keys.iter().position(|key| *key == name);
    let Some((column, vary)) = column.zip(args.vary.first()) else {
        return Ok(false);
    };
    let chart = args.out.join(CHART);
    let plot = sweep(&vary.key, name, &vary.values, &series(args, &rows, column));
    match &plot {
        Some(plot) => output::write_file(&chart, |w| plot.write_svg(w))?,
        // That of other jobs, whose scenes have changed.
        None if chart.exists() => std::fs::remove_file(&chart)?,
        None => {}
    }
    Ok(plot.is_some())
}

/// The numbers of a column over the values of the first key, one series for each combination of the others.
fn series(args: &SweepArgs, rows: &[Row], column: usize) -> Vec<Series> {
    let others = args.vary.iter().skip(1);
    let name = |row: &Row| {
        let parts = others.clone().zip(&row.values[1..]);
        let parts = parts.map(|(vary, value)| format!("{} = {value}", vary.key));
        parts.collect::<Vec<_>>().join(", ")
    };
    let mut found: Vec<Series> = Vec::new();
    for row in rows {
        let name = name(row);
        let point = (row.values[0].clone(), row.means[column], row.errors[column]);
        let (value, Some(mean), error) = point else {
            continue;
        };
        match found.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push((value, mean, error)),
            None => found.push(Series {
                name,
                points: vec![(value, mean, error)],
            }),
        }
    }
    found
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Standard error of the mean, from the scatter of two values at least.
fn standard_error(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let count = values.len() as f64;
    let scatter: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    (values.len() > 1).then(|| (scatter / (count - 1.0) / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standard_error_needs_two_values() {
        assert_eq!((mean(&[]), standard_error(&[3.0])), (None, None));
        // Deviations of 1 each: sqrt(2/1/2).
        assert_eq!(
            (mean(&[2.0, 4.0]), standard_error(&[2.0, 4.0])),
            (Some(3.0), Some(1.0))
        );
    }
}
