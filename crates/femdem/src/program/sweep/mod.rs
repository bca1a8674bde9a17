//! `femdem sweep`: the packs or runs of all combinations of values, one after another, and a table of their results.

mod table;

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::{Context, Result, bail};
use clap::Args;
use femdem::run::{Scenario, Stage};
use femdem::{Scene, output};
use serde_json::Value as Json;
use toml::{Table, Value};

use super::args::{PackArgs, ResumeArgs, RunArgs};
use super::run::SceneArgs;
use super::running::Outcome;
use super::{complain, described, folder, job, run, say, stages};

/// Options of `femdem sweep`.
#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// Scene of `femdem pack` or of `femdem run` (TOML)
    pub scene: PathBuf,

    /// A key of the scene and its values, such as friction=0.2,0.4,0.6 or contact.damping=0.3,0.6; repeat it for all
    /// combinations. Values with a comma are separated by semicolons
    #[arg(long, value_name = "KEY=VALUES")]
    pub vary: Vec<Vary>,

    /// Packs of each combination: with the seed of the scene and the ones after it
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u32).range(1..))]
    pub seeds: u32,

    /// A number of the table, by the name of its column, that the chart shows over the first key [default:
    /// packing_density.exact, and energy.dissipated_friction of runs]
    #[arg(long, value_name = "COLUMN")]
    pub chart: Option<String>,

    /// Folder for the folders of the jobs and the table; what is finished in it is not made again
    #[arg(long, value_name = "DIR", default_value = "out/sweep")]
    pub out: PathBuf,

    /// Threads of each job, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// What ends the sweep, where a host and not the program watches for it.
    #[arg(skip)]
    pub stop: Option<Arc<AtomicBool>>,
}

pub(crate) const HELP: &str = "\
The folder then holds
  sweep.csv                  a row for each job, and the mean and its standard error for each combination
  sweep.svg                  a chart of one of its numbers over the first key
  KEY=VALUE,seed=N           a folder for each job, as of `femdem pack` or `femdem run`
  KEY=VALUE,seed=N.toml      its scene

Jobs run one after another, each on all threads. After Ctrl-C, the same command goes on where it was stopped.";

/// A key and its values.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Vary {
    key: String,
    values: Vec<String>,
}

impl FromStr for Vary {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let vary = text.split_once('=').map(|(key, values)| {
            let between = if values.contains(';') { ';' } else { ',' };
            let values = values.split(between).map(|value| value.trim().to_owned());
            Self {
                key: key.trim().to_owned(),
                values: values.collect(),
            }
        });
        vary.filter(|vary| {
            !vary.key.is_empty() && vary.values.iter().all(|value| !value.is_empty())
        })
        .ok_or_else(|| "give a key and its values, such as friction=0.2,0.4,0.6".to_owned())
    }
}

/// A job of the sweep.
struct Job {
    name: String,
    /// The values of the varied keys.
    values: Vec<String>,
    seed: Option<i64>,
    /// Its scene without the folder, so that this may be written in several ways.
    text: String,
    /// The file with the text.
    scene: PathBuf,
    folder: PathBuf,
    /// The name of its last stage, if it has stages.
    last: Option<String>,
}

pub(crate) fn run(args: &SweepArgs) -> Result<Outcome> {
    let text = fs::read_to_string(&args.scene)
        .with_context(|| format!("cannot read {}", args.scene.display()))?;
    let base: Table = text
        .parse()
        .with_context(|| args.scene.display().to_string())?;
    // A pack has none of these keys.
    let is_run = ["duration", "body", "from", "source", "stage"]
        .iter()
        .any(|key| base.contains_key(*key));
    if is_run && args.seeds > 1 {
        bail!("--seeds is for packs, and a run has no seed of its own: leave it out");
    }
    let jobs = jobs(args, &base, is_run)?;
    // All scenes are understood before the first job begins.
    let mut flow = BTreeSet::new();
    for job in &jobs {
        let read = match is_run {
            true => job.flow_names().map(|names| flow.extend(names)),
            false => Scene::from_toml(&job.text).map(drop),
        };
        read.with_context(|| job.name.clone())?;
    }
    let flow: Vec<String> = flow.into_iter().collect();
    let columns = table::columns(is_run.then_some(flow.as_slice()));
    table::check(args, &columns, is_run)?;
    fs::create_dir_all(&args.out)
        .with_context(|| format!("cannot make the folder {}", args.out.display()))?;
    let mut failed = Vec::new();
    let mut has_chart = false;
    for (k, job) in jobs.iter().enumerate() {
        say(&format!("{} of {}: {}", k + 1, jobs.len(), job.name));
        match job.finish(args, is_run) {
            Ok(Outcome::Finished) => {}
            Ok(Outcome::Interrupted) => return Ok(Outcome::Interrupted),
            Err(error) => {
                complain(&format!("error: {}: {}", job.name, described(&error)));
                failed.push(job.name.as_str());
            }
        }
        has_chart = table::write(args, &jobs, &columns, is_run)?;
    }
    if !failed.is_empty() {
        bail!(
            "{} of {} jobs failed: {}",
            failed.len(),
            jobs.len(),
            failed.join(" ")
        );
    }
    let [table, chart] = [table::TABLE, table::CHART].map(|file| args.out.join(file));
    let chart = match has_chart {
        true => format!(", chart in {}", chart.display()),
        false => String::new(),
    };
    say(&format!("table in {}{chart}", table.display()));
    Ok(Outcome::Finished)
}

/// The jobs: the last key varies faster than those before it, and the seed fastest of all.
fn jobs(args: &SweepArgs, base: &Table, is_run: bool) -> Result<Vec<Job>> {
    let mut keys = BTreeSet::new();
    for Vary { key, .. } in &args.vary {
        if !keys.insert(key) {
            bail!("--vary {key} is given twice: give all its values at once");
        }
        match key.split('.').find(|part| !part.is_empty()) {
            Some("out") => bail!("--vary {key}: each job has a folder of its own in that of --out"),
            Some("seed") if !is_run => {
                bail!(
                    "--vary {key}: --seeds N makes packs with the seed of the scene and the ones after it"
                )
            }
            _ => {}
        }
    }
    let mut combinations: Vec<Vec<String>> = vec![Vec::new()];
    for vary in &args.vary {
        let with_each = |before: Vec<String>| {
            let values = vary.values.iter();
            values.map(move |value| [before.as_slice(), std::slice::from_ref(value)].concat())
        };
        combinations = combinations.into_iter().flat_map(with_each).collect();
    }
    let first = base.get("seed").map_or(Some(1), Value::as_integer);
    let first = first.context("seed must be a whole number")?;
    let mut names = BTreeSet::new();
    let mut jobs = Vec::new();
    for values in combinations {
        for k in 0..i64::from(args.seeds) {
            let mut scene = base.clone();
            scene.remove("out");
            let mut parts = Vec::new();
            for (vary, value) in args.vary.iter().zip(&values) {
                set(&mut scene, &vary.key, value)?;
                parts.push(format!("{}={value}", vary.key));
            }
            let seed = (!is_run).then_some(first + k);
            if let Some(seed) = seed {
                scene.insert("seed".to_owned(), Value::Integer(seed));
                parts.push(format!("seed={seed}"));
            }
            let plain = |c: char| c.is_ascii_alphanumeric() || "=,.-+".contains(c);
            let name: String = match parts.is_empty() {
                true => "job".to_owned(),
                false => parts
                    .join(",")
                    .chars()
                    .map(|c| if plain(c) { c } else { '_' })
                    .collect(),
            };
            if !names.insert(name.clone()) {
                bail!("two jobs would have the folder {name}: give each value once");
            }
            let text = toml::to_string(&scene)?;
            let stages = match is_run {
                true => Stage::from_toml(&text, None).with_context(|| name.clone())?,
                false => Vec::new(),
            };
            jobs.push(Job {
                values: values.clone(),
                seed,
                last: stages.last().map(|stage| stage.name.clone()),
                text,
                scene: args.out.join(format!("{name}.toml")),
                folder: args.out.join(&name),
                name,
            });
        }
    }
    Ok(jobs)
}

/// Sets a key, whose tables come before it with points between them.
fn set(scene: &mut Table, key: &str, value: &str) -> Result<()> {
    // A number, a switch, a list or a quoted text as in a scene file; all else is a text.
    let parsed = format!("x = {value}").parse::<Table>().ok();
    let value = parsed
        .and_then(|mut table| table.remove("x"))
        .unwrap_or_else(|| Value::String(value.to_owned()));
    let mut at = scene;
    let (tables, last) = key.rsplit_once('.').unwrap_or(("", key));
    for part in tables.split('.').filter(|part| !part.is_empty()) {
        let inner = at.entry(part).or_insert_with(|| Value::Table(Table::new()));
        let inner = inner.as_table_mut();
        at = inner.with_context(|| format!("{part} in --vary {key} is no table of the scene"))?;
    }
    at.insert(last.to_owned(), value);
    Ok(())
}

impl Job {
    /// Makes it, goes on with it, or leaves it as it is if it is finished.
    fn finish(&self, args: &SweepArgs, is_run: bool) -> Result<Outcome> {
        let has_checkpoint =
            folder::has_checkpoint(&self.folder) || folder::holds_run(&self.folder);
        let holds_stages = self.last.is_some() && self.folder.join(run::SCENE).is_file();
        let has_checkpoint = has_checkpoint || holds_stages;
        let has_results = has_checkpoint || self.folder.join(folder::SUMMARY).is_file();
        if !self.is_own() && (has_results || self.scene.exists()) {
            bail!(
                "the folder {} is of another scene than this job, whose scene is not in {}: remove both, or give another \
                 folder with --out",
                self.folder.display(),
                self.scene.display()
            );
        }
        if self.summary().is_some() {
            return Ok(Outcome::Finished);
        }
        output::write_file(&self.scene, |w| {
            std::io::Write::write_all(w, self.text.as_bytes())
        })?;
        let how = RunArgs {
            threads: args.threads,
            stop: args.stop.clone(),
            ..RunArgs::default()
        };
        if has_checkpoint {
            return job::resume(&ResumeArgs {
                folder: self.folder.clone(),
                duration: None,
                report: false,
                run: how,
            });
        }
        if is_run {
            return stages::run(&SceneArgs {
                scene: self.scene.clone(),
                out: Some(self.folder.clone()),
                force: true,
                check: false,
                yes: false,
                run: how,
            });
        }
        let mut pack = PackArgs::default();
        (pack.scene, pack.out) = (Some(self.scene.clone()), Some(self.folder.clone()));
        (pack.force, pack.run) = (true, how);
        job::pack(&pack)
    }

    /// Names of the gauges, sinks and sources of its run, or of the last of its stages.
    fn flow_names(&self) -> Result<Vec<String>, femdem::Error> {
        match Stage::from_toml(&self.text, None)?.pop() {
            Some(last) => Ok(last.scenario.flow_names()),
            None => Ok(Scenario::from_toml(&self.text)?.flow_names()),
        }
    }

    /// Whether what is in its folder is of its scene: the file beside the folder has its text.
    fn is_own(&self) -> bool {
        fs::read_to_string(&self.scene).is_ok_and(|text| text == self.text)
    }

    /// The results, if it is finished.
    fn summary(&self) -> Option<Json> {
        if !self.is_own() {
            return None;
        }
        let last = self.last.as_ref();
        let folder = last.map_or(self.folder.clone(), |last| self.folder.join(last));
        let text = fs::read_to_string(folder.join(folder::SUMMARY)).ok()?;
        serde_json::from_str(&text).ok()
    }

    /// Some numbers of its results, if it is finished.
    fn numbers(&self, keys: &[String]) -> Option<Vec<Option<f64>>> {
        let summary = self.summary()?;
        let number = |key: &String| {
            let found = find(&summary, key)?;
            found
                .as_f64()
                .or(found.as_bool().map(|yes| f64::from(u8::from(yes))))
        };
        Some(keys.iter().map(number).collect())
    }
}

/// The value at a path of keys with points between them, which may be within a key too.
fn find<'a>(value: &'a Json, path: &str) -> Option<&'a Json> {
    value.as_object()?.iter().find_map(|(key, inner)| {
        let rest = path.strip_prefix(key.as_str())?;
        match rest.strip_prefix('.') {
            Some(rest) => find(inner, rest),
            None => rest.is_empty().then_some(inner),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_by_their_paths() {
        let text = r#"{"flow": {"out.let": {"mass": 2}, "out": {"mass": 1}}, "flower": 3}"#;
        let json: Json = serde_json::from_str(text).unwrap();
        let number = |path: &str| find(&json, path).and_then(Json::as_f64);
        assert_eq!(number("flow.out.let.mass"), Some(2.0));
        assert_eq!(number("flow.out.mass"), Some(1.0));
        assert_eq!(
            (number("flower"), number("flow.in.mass")),
            (Some(3.0), None)
        );
        let columns = table::columns(Some(&["outlet".to_owned()]));
        assert!(columns.contains(&"flow.outlet.mean_rate".to_owned()));
    }

    fn vary(text: &str) -> Vary {
        text.parse().unwrap()
    }

    #[test]
    fn keys_have_lists_of_values() {
        assert_eq!(vary("friction = 0.2, 0.4").values, ["0.2", "0.4"]);
        let sizes = vary("sizes=20mm:1,30mm:1;40mm");
        assert_eq!((sizes.key.as_str(), sizes.values.len()), ("sizes", 2));
        for bad in ["friction", "=1", "friction=0.2,,0.4"] {
            assert!(bad.parse::<Vary>().is_err(), "{bad}");
        }
    }

    #[test]
    fn jobs_are_all_combinations_with_all_seeds() {
        let args = SweepArgs {
            scene: PathBuf::new(),
            vary: vec![
                vary("friction=0.2,0.4"),
                vary("contact.damping=0.3,0.6"),
                vary("shape=P5"),
            ],
            seeds: 3,
            out: PathBuf::from("o"),
            chart: None,
            threads: None,
            stop: None,
        };
        let base: Table = "seed = 7\ncount = 5".parse().unwrap();
        let made = jobs(&args, &base, false).unwrap();
        assert_eq!(made.len(), 12);
        assert_eq!(
            made[4].name,
            "friction=0.2,contact.damping=0.6,shape=P5,seed=8"
        );
        let scene = Scene::from_toml(&made[4].text).unwrap();
        assert_eq!(
            (scene.friction, scene.damping, scene.seed, scene.count),
            (0.2, 0.6, 8, 5)
        );
        assert_eq!(scene.shape, ["P5"]);
        // Another spelling of the folder is the same scene.
        let spelt = SweepArgs {
            out: PathBuf::from("./o"),
            ..args
        };
        let again = jobs(&spelt, &base, false).unwrap();
        assert_eq!(again[4].text, made[4].text);
        assert_eq!(again[4].folder, PathBuf::from("./o").join(&made[4].name));
        let twice = SweepArgs {
            vary: vec![vary("friction=0.2,0.2")],
            ..spelt
        };
        assert!(jobs(&twice, &base, false).is_err());
        for (keys, instead) in [
            (vec!["seed=1,2"], "--seeds"),
            (vec!["out=a,b"], "--out"),
            (vec!["friction=0.2", "friction=0.4"], "given twice"),
        ] {
            let refused = SweepArgs {
                vary: keys.into_iter().map(vary).collect(),
                out: PathBuf::from("o"),
                stop: None,
                scene: PathBuf::new(),
                chart: None,
                ..twice
            };
            let message = jobs(&refused, &base, false).err().unwrap().to_string();
            assert!(message.contains(instead), "{message}");
        }
    }

    /// What is in a folder counts only beside the scene of the job, and texts of the table keep their quotes.
    #[test]
    fn results_of_other_scenes_are_refused_and_not_in_the_table() {
        let folder = tempfile::tempdir().unwrap();
        let args = SweepArgs {
            scene: PathBuf::new(),
            vary: vec![vary("shape=[\"P5\", \"A10\"];P5")],
            seeds: 1,
            out: folder.path().to_path_buf(),
            chart: None,
            threads: None,
            stop: None,
        };
        let made = jobs(&args, &Table::new(), false).unwrap();
        fs::create_dir(&made[0].folder).unwrap();
        fs::write(made[0].folder.join(folder::SUMMARY), "{\"steps\": 42}").unwrap();
        let table = || {
            table::write(&args, &made, &table::columns(None), false).unwrap();
            fs::read_to_string(folder.path().join(table::TABLE)).unwrap()
        };
        for other in [None, Some("count = 3\n")] {
            if let Some(other) = other {
                fs::write(&made[0].scene, other).unwrap();
            }
            let message = made[0].finish(&args, false).err().unwrap().to_string();
            assert!(
                message.contains(&made[0].folder.display().to_string()),
                "{message}"
            );
            assert!(message.contains("remove both"), "{message}");
            assert_eq!(table().lines().count(), 1);
        }
        fs::write(&made[0].scene, &made[0].text).unwrap();
        assert!(made[0].finish(&args, false).is_ok());
        let table = table();
        assert!(
            table.contains("\njob,\"[\"\"P5\"\", \"\"A10\"\"]\",1,"),
            "{table}"
        );
    }
}
