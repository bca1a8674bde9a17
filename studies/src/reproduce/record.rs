//! Runs whose folders are gone, restored from the table of the last page.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};

use super::Scale;
use super::job::Job;
use super::pack::Pack;
use super::run::{Analysis, Run};
use super::runs::Runs;
use crate::validate::program::Summary;

/// The cells of a row by the names of their columns.
type Row = BTreeMap<String, String>;

/// The rows of a table of runs by their labels.
#[derive(Debug, Default)]
pub(super) struct Record(BTreeMap<String, Row>);

impl Record {
    /// The table of a study's page if runs are taken as found; otherwise empty.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(super) fn of(runs: &Runs, study: &str, scale: Scale) -> Result<Self> {
        let path = runs.workshop().root().join("records");
        let path = path.join(format!("{study}.csv"));
        if scale == Scale::Full && runs.is_as_found() && path.is_file() {
            Self::read(&path)
        } else {
            Ok(Self::default())
        }
    }

    fn read(path: &Path) -> Result<Self> {
        let text =
            fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        Self::parse(&text).with_context(|| format!("{} is no table of runs", path.display()))
    }

    fn parse(text: &str) -> Result<Self> {
        let mut lines = text.lines().map(cells);
        let columns = lines.next().context("it is empty")?;
        let mut rows = BTreeMap::new();
        for cells in lines {
            ensure!(
                cells.len() == columns.len(),
                "a row has {} cells, and there are {} columns",
                cells.len(),
                columns.len()
            );
            let label = cells.first().cloned().unwrap_or_default();
            rows.insert(label, columns.iter().cloned().zip(cells).collect());
        }
        Ok(Self(rows))
    }

    /// The run with a label, if it has as many bodies as the job.
    ///
    /// # Errors
    /// When the row lacks a column.
    pub(super) fn pack(&self, label: &str, job: &Job) -> Result<Option<Pack>> {
        let Some(row) = self.0.get(label) else {
            return Ok(None);
        };
        let text = |column: &str| {
            let cell = row.get(column);
            cell.with_context(|| format!("the row of {label} has no column {column}"))
        };
        // "none" or "not recorded" stands for an unknown value.
        let number =
            |column: &str| -> Result<Value> { Ok(json!(text(column)?.parse::<f64>().ok())) };
        if text("bodies")?.parse() != Ok(f64::from(job.bodies)) {
            return Ok(None);
        }
        let error = number("standard_error")?;
        let summary = json!({
            "count": number("bodies")?,
            "settled": text("settled")? == "true",
            "penetration": {"mean_over_d": number("mean_penetration_over_d")?},
            "residual": {"max_over_weight": number("largest_residual_over_weight")?},
            "cpu_seconds": number("cpu_s")?,
            "wall_seconds": number("wall_s")?,
            "threads": number("threads")?,
        });
        let analysis = json!({
            "density": {
                "exact": number("density_exact")?,
                "grid": number("density_grid")?,
                "standard_error": error,
                "blocks": if error.is_null() { 0 } else { u32::MAX },
            },
            "core": {"inset_over_d": number("inset_over_d")?},
            "coordination": {"mean": number("coordination")?},
            "core_coordination": {"mean": number("core_coordination")?},
            "core_mean_coordination": {
                "mean": number("core_coordination")?,
                "standard_error": number("core_coordination_error").unwrap_or_default(),
            },
        });
        Ok(Some(Pack {
            run: Run {
                folder: PathBuf::new(),
                summary: Summary::parse(&summary.to_string())?,
                origin: Some(text("machine")?.clone()),
            },
            analysis: Analysis::without_tables(analysis),
        }))
    }
}

/// The cells of a line of CSV.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            // Two quotes in a row inside quotes are one quote.
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                push(&mut cells, '"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => push(&mut cells, other),
        }
    }
    cells
}

fn push(cells: &mut [String], letter: char) {
    if let Some(last) = cells.last_mut() {
        last.push(letter);
    }
}

#[cfg(test)]
mod tests {
    use super::super::run::COLUMNS;
    use super::*;

    #[test]
    fn lines_are_taken_apart() {
        assert_eq!(cells("a,\"b, \"\"c\"\"\",,d"), ["a", "b, \"c\"", "", "d"]);
        assert_eq!(cells(""), [""]);
    }

    /// A row that is read from a table and written again is the same.
    #[test]
    fn rows_come_back_as_they_were() {
        let row = "\"A3, drag, small, seed 2\",900,0.5812,0.5811,0.0072,2.0000,5.1200,5.9100,0.0600,0.003282,0.001131,\
                   true,48.2,51.1,1,AMD EPYC";
        let record = Record::parse(&format!("{}\n{row}\n", COLUMNS.join(","))).unwrap();
        let job = |bodies| Job {
            options: String::new(),
            bodies,
        };
        let label = "A3, drag, small, seed 2";
        let pack = record.pack(label, &job(900)).unwrap().unwrap();
        assert_eq!(pack.run.row(label, &pack.analysis).unwrap(), cells(row));
        assert_eq!(pack.analysis.density(), (0.5812, 0.0072));
        assert!(pack.run.summary.is_settled());
        assert!(record.pack(label, &job(901)).unwrap().is_none());
        assert!(record.pack("A3", &job(900)).unwrap().is_none());
    }

    #[test]
    fn what_a_table_does_not_tell_is_not_known() {
        let columns = COLUMNS.map(|c| {
            if c == "core_coordination_error" {
                "other"
            } else {
                c
            }
        });
        let row = "x,9,0.5,0.5,none,2,5,6,7,0.003,0.001,false,none,51,1,not recorded";
        let record = Record::parse(&format!("{}\n{row}\n", columns.join(","))).unwrap();
        let job = Job {
            options: String::new(),
            bodies: 9,
        };
        let pack = record.pack("x", &job).unwrap().unwrap();
        assert!(pack.analysis.density().1.is_nan() && !pack.run.summary.is_settled());
        let error = pack
            .analysis
            .number("core_mean_coordination.standard_error");
        assert!(error.is_nan() && pack.run.summary.number("cpu_seconds").is_err());
        assert!(Record::parse("a,b\n1\n").is_err() && Record::parse("").is_err());
    }
}
