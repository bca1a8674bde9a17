//! A finished run: its summary, and the results of `femdem analyse`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use crate::validate::program::{Program, Summary};
use crate::validate::report::short;

/// With fewer blocks the bootstrap's error is not used.
const FEWEST_BLOCKS: f64 = 8.0;

/// The file with all results of `femdem analyse`.
const ANALYSIS: &str = "analysis.json";

/// A folder with a finished run.
#[derive(Debug, Clone)]
pub(super) struct Run {
    pub(super) folder: PathBuf,
    pub(super) summary: Summary,
    /// Commit and machine, where they are recorded.
    pub(super) origin: Option<String>,
}

/// The results of `femdem analyse` with one inset of the core.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Analysis {
    values: Value,
    /// The folder of the tables.
    pub(super) tables: PathBuf,
}

impl Run {
    /// # Errors
    /// When the summary cannot be read.
    pub(super) fn read(folder: &Path, origin: Option<String>) -> Result<Self> {
        Ok(Self {
            folder: folder.to_owned(),
            summary: Summary::read(folder)?,
            origin,
        })
    }

    /// Whether its tables exist, and not only the record on a page.
    pub(super) fn has_tables(&self) -> bool {
        self.folder.is_dir()
    }

    /// Bodies in the container.
    ///
    /// # Errors
    /// When the summary does not state it.
    pub(super) fn count(&self) -> Result<f64> {
        self.summary.number("count")
    }

    /// Its analysis with a core that keeps `inset` d from walls, floor and top: an earlier one, or one made
    /// now.
    ///
    /// # Errors
    /// When the program fails, or its results cannot be read.
    pub(super) fn analysis(&self, program: &Program, inset: f64) -> Result<Analysis> {
        let out = self.folder.join(format!("inset-{inset}"));
        if out.join(ANALYSIS).is_file() {
            return Analysis::read(&out);
        }
        analysis_in(program, &self.tables()?, &self.surroundings()?, inset, &out)
    }

    /// A plot of `femdem report`: an earlier one, or one made now.
    ///
    /// # Errors
    /// When the program fails, or the plot cannot be read.
    pub(super) fn plot(&self, program: &Program, name: &str) -> Result<String> {
        let out = self.folder.join("report");
        let path = out.join("plots").join(name);
        if !path.is_file() {
            program.measure("report", &self.tables()?, &self.surroundings()?, &out)?;
        }
        fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))
    }

    /// A folder with the tables and surfaces of the run, without its checkpoint, which possibly only the
    /// version of the program that wrote it can read.
    fn tables(&self) -> Result<PathBuf> {
        let folder = self.folder.join("tables");
        fs::create_dir_all(&folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let files = fs::read_dir(&self.folder)
            .with_context(|| format!("cannot read {}", self.folder.display()))?;
        for file in files {
            let path = file.context("cannot read a folder of a run")?.path();
            let ending = path.extension().and_then(|ending| ending.to_str());
            if let (Some("csv" | "obj"), Some(name)) = (ending, path.file_name()) {
                fs::copy(&path, folder.join(name))
                    .with_context(|| format!("cannot copy {}", path.display()))?;
            }
        }
        Ok(folder)
    }

    /// The inside of the box and gravity, as options of `femdem analyse`.
    fn surroundings(&self) -> Result<String> {
        let number = |path: &str| self.summary.number(path);
        let half = |path: &str| number(path).map(|width| 0.5 * width);
        let (x, y) = (half("container.width")?, half("container.depth")?);
        let top = number("container.top")? + number("diameter")?;
        let scene = self.folder.join("scene.toml");
        let text = fs::read_to_string(&scene)
            .with_context(|| format!("cannot read {}", scene.display()))?;
        let gravity = gravity(&text)
            .with_context(|| format!("{} does not state gravity", scene.display()))?;
        Ok(format!(
            "--inside {},{},0,{x},{y},{top} --gravity {gravity}",
            -x, -y
        ))
    }

    /// A row of the table of runs, after its label.
    ///
    /// # Errors
    /// When the summary lacks a number.
    pub(super) fn row(&self, label: &str, analysis: &Analysis) -> Result<Vec<String>> {
        let number = |path: &str| self.summary.number(path).map(short);
        let found = |path: &str| {
            let value = analysis.number(path);
            if value.is_finite() {
                format!("{value:.4}")
            } else {
                "none".to_owned()
            }
        };
        Ok(vec![
            label.to_owned(),
            number("count")?,
            found("density.exact"),
            found("density.grid"),
            found("density.standard_error"),
            found("core.inset_over_d"),
            found("coordination.mean"),
            found("core_coordination.mean"),
            found("core_mean_coordination.standard_error"),
            number("penetration.mean_over_d")?,
            number("residual.max_over_weight")?,
            self.summary.is_settled().to_string(),
            number("cpu_seconds").unwrap_or_else(|_| "none".to_owned()),
            number("wall_seconds")?,
            number("threads")?,
            self.origin
                .clone()
                .unwrap_or_else(|| "not recorded".to_owned()),
        ])
    }
}

/// The analysis of a folder of tables: an earlier one, or one made now.
///
/// # Errors
/// When the program fails, or its results cannot be read.
pub(super) fn analysis_in(
    program: &Program,
    tables: &Path,
    options: &str,
    inset: f64,
    out: &Path,
) -> Result<Analysis> {
    if !out.join(ANALYSIS).is_file() {
        let options = format!("{options} --core-inset {inset}");
        program.measure("analyse", tables, &options, out)?;
    }
    Analysis::read(out)
}

/// Gravity in a scene, m/s².
fn gravity(scene: &str) -> Option<f64> {
    let line = scene
        .lines()
        .find_map(|line| line.strip_prefix("gravity ="));
    line?.trim().parse().ok()
}

/// The columns of the table of runs.
pub(super) const COLUMNS: [&str; 16] = [
    "run",
    "bodies",
    "density_exact",
    "density_grid",
    "standard_error",
    "inset_over_d",
    "coordination",
    "core_coordination",
    "core_coordination_error",
    "mean_penetration_over_d",
    "largest_residual_over_weight",
    "settled",
    "cpu_s",
    "wall_s",
    "threads",
    "machine",
];

impl Analysis {
    /// For a run of which only these numbers remain.
    pub(super) fn without_tables(values: Value) -> Self {
        Self {
            values,
            tables: PathBuf::new(),
        }
    }

    fn read(out: &Path) -> Result<Self> {
        let path = out.join(ANALYSIS);
        let text =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        Ok(Self {
            values: serde_json::from_str(&text)
                .with_context(|| format!("{} is not JSON", path.display()))?,
            tables: out.join("analysis"),
        })
    }

    /// A number by its path, such as "density.exact"; NaN if there is none.
    pub(super) fn number(&self, path: &str) -> f64 {
        self.at(path).as_f64().unwrap_or(f64::NAN)
    }

    /// Numbers of a list by its path.
    pub(super) fn numbers(&self, path: &str) -> Vec<f64> {
        let list = self.at(path).as_array();
        list.map_or_else(Vec::new, |l| l.iter().filter_map(Value::as_f64).collect())
    }

    /// A number of each object of a list.
    pub(super) fn column(&self, path: &str, key: &str) -> Vec<f64> {
        let list = self.at(path).as_array();
        let cell = |object: &Value| object[key].as_f64();
        list.map_or_else(Vec::new, |l| l.iter().filter_map(cell).collect())
    }

    /// The density of the core with its standard error, which is NaN if the core has too few blocks for the
    /// bootstrap.
    pub(super) fn density(&self) -> (f64, f64) {
        let error = if self.number("density.blocks") >= FEWEST_BLOCKS {
            self.number("density.standard_error")
        } else {
            f64::NAN
        };
        (self.number("density.exact"), error)
    }

    fn at(&self, path: &str) -> &Value {
        path.split('.')
            .fold(&self.values, |value, key| match key.parse::<usize>() {
                Ok(index) => &value[index],
                Err(_) => &value[key],
            })
    }
}

#[cfg(test)]
impl Analysis {
    pub(super) fn of(text: &str) -> Self {
        Self::without_tables(serde_json::from_str(text).unwrap())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravity_is_read_from_the_scene() {
        assert_eq!(gravity("drag = 0.0\ngravity = 1.62\n"), Some(1.62));
        assert_eq!(gravity("drag = 0.0\n"), None);
    }

    #[test]
    fn values_are_found_by_path() {
        let analysis = Analysis::of(
            r#"{"density": {"exact": 0.5, "standard_error": 0.01, "blocks": 7},
                "core_coordination": {"histogram": [0, 2, 3]},
                "tensor": [[1.0, 2.0], [3.0, 4.0]],
                "chains": [{"bodies": 3}, {"bodies": 5}, {}]}"#,
        );
        let (density, error) = analysis.density();
        assert!(density == 0.5 && error.is_nan());
        let more =
            Analysis::of(r#"{"density": {"exact": 0.5, "standard_error": 0.01, "blocks": 8}}"#);
        assert_eq!(more.density(), (0.5, 0.01));
        assert_eq!(
            analysis.numbers("core_coordination.histogram"),
            [0.0, 2.0, 3.0]
        );
        assert_eq!(analysis.column("chains", "bodies"), [3.0, 5.0]);
        assert_eq!(analysis.number("tensor.1.0"), 3.0);
        assert!(analysis.number("tensor.7.0").is_nan() && analysis.numbers("none").is_empty());
    }
}
