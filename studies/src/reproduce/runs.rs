//! The folder of runs: existing runs are used, missing ones are made.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, bail, ensure};

use super::job::Job;
use super::run::Run;
use crate::validate::machine::Place;
use crate::validate::program::{Program, Workshop};

/// Packs of fewer bodies than this are run side by side on one thread each.
const LARGE: u32 = 3000;

/// The file in a run's folder that names the program and the machine. A run that was made by hand may have one,
/// too.
const ORIGIN: &str = "origin.txt";

/// The folder of runs and the program that makes them.
pub(super) struct Runs<'a> {
    workshop: &'a Workshop,
    program: Program,
    folder: PathBuf,
    threads: usize,
    place: Place,
    /// Whether missing runs are left out instead of made.
    as_found: bool,
    /// Lines of the default scene.
    usual: Vec<String>,
}

/// The folder of a job's run, in a folder of runs.
pub(super) fn folder_of(runs: &Path, job: &Job) -> PathBuf {
    runs.join(job.key())
}

/// The command that makes a run in its folder.
pub(super) fn command(runs: &Path, job: &Job, threads: usize) -> String {
    let threads = if job.bodies < LARGE { 1 } else { threads };
    format!(
        "femdem pack {} --threads {threads} --quiet --force --out {}",
        job.options,
        folder_of(runs, job).display()
    )
}

impl<'a> Runs<'a> {
    /// # Errors
    /// When the program cannot be built, or the folder cannot be made.
    pub(super) fn open(
        workshop: &'a Workshop,
        folder: &Path,
        threads: usize,
        as_found: bool,
    ) -> Result<Self> {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}", folder.display()))?;
        let program = workshop.build("femdem", &[])?;
        let mut usual = settings(&program.output("pack", "--print-scene")?);
        usual.extend(ONCE_WRITTEN.map(str::to_owned));
        Ok(Self {
            workshop,
            program,
            folder: folder.to_owned(),
            threads,
            place: Place::find(workshop.root())?,
            as_found,
            usual,
        })
    }

    pub(super) fn workshop(&self) -> &Workshop {
        self.workshop
    }

    /// The folder of all runs.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(super) fn program(&self) -> &Program {
        &self.program
    }

    pub(super) fn is_as_found(&self) -> bool {
        self.as_found
    }

    /// The runs of jobs by their keys: found, or made now. Runs that are missing and not to be made are left
    /// out.
    ///
    /// # Errors
    /// When the program fails, or a folder does not contain what its name says.
    pub(super) fn all(&self, jobs: &[Job]) -> Result<BTreeMap<String, Run>> {
        let mut found = BTreeMap::new();
        let mut missing = Vec::new();
        for job in jobs {
            match self.find(job)? {
                Some(run) => drop(found.insert(job.key(), run)),
                None if missing.contains(job) => {}
                None => missing.push(job.clone()),
            }
        }
        if self.as_found {
            return Ok(found);
        }
        let (large, small): (Vec<_>, Vec<_>) =
            missing.into_iter().partition(|job| job.bodies >= LARGE);
        self.each(&small, |job| self.make(job, 1))?;
        for job in &large {
            self.make(job, self.threads)?;
        }
        for job in small.iter().chain(&large) {
            let run = self.find(job)?;
            let run =
                run.with_context(|| format!("femdem pack {} left no summary", job.options))?;
            found.insert(job.key(), run);
        }
        Ok(found)
    }

    /// Processes all items in parallel; returns the results in their order.
    ///
    /// # Errors
    /// The first failure.
    pub(super) fn each<T: Sync, R: Send>(
        &self,
        items: &[T],
        work: impl Fn(&T) -> Result<R> + Sync,
    ) -> Result<Vec<R>> {
        let next = AtomicUsize::new(0);
        let worker = || {
            let mut done = Vec::new();
            while let Some((index, item)) = {
                let index = next.fetch_add(1, Ordering::Relaxed);
                items.get(index).map(|item| (index, item))
            } {
                done.push((index, work(item)?));
            }
            Ok(done)
        };
        let parts = std::thread::scope(|scope| {
            let workers: Vec<_> = (0..self.threads).map(|_| scope.spawn(worker)).collect();
            let ends = workers.into_iter().map(|worker| match worker.join() {
                Ok(end) => end,
                Err(_) => bail!("a thread that waits for the program has panicked"),
            });
            ends.collect::<Result<Vec<_>>>()
        })?;
        let mut done: Vec<(usize, R)> = parts.into_iter().flatten().collect();
        done.sort_by_key(|(index, _)| *index);
        Ok(done.into_iter().map(|(_, result)| result).collect())
    }

    /// Runs the program, or continues from the checkpoint of a run that was cut off. A run that cannot be
    /// resumed, such as that of another version, is started again.
    fn make(&self, job: &Job, threads: usize) -> Result<()> {
        let folder = folder_of(&self.folder, job);
        let threads = format!("--threads {threads}");
        let is_resumed = folder.join("pack.ckpt").is_file()
            && self.is_of(job, &folder)?
            && self.program.resume(&threads, &folder).is_ok();
        if !is_resumed {
            let options = format!("{} {threads} --force", job.options);
            self.program.pack(&options, &folder)?;
        }
        self.sign(&folder)
    }

    /// Names the machine in the folder of a run that was made now.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub(super) fn sign(&self, folder: &Path) -> Result<()> {
        let path = folder.join(ORIGIN);
        fs::write(&path, &self.place.processor)
            .with_context(|| format!("cannot write {}", path.display()))
    }

    /// A finished run of a job.
    fn find(&self, job: &Job) -> Result<Option<Run>> {
        let folder = folder_of(&self.folder, job);
        if !folder.join("summary.json").is_file() {
            return Ok(None);
        }
        ensure!(
            self.is_of(job, &folder)?,
            "{} holds a run with other options than `femdem pack {}`: remove it",
            folder.display(),
            job.options
        );
        let origin = fs::read_to_string(folder.join(ORIGIN)).ok();
        let origin = origin.map(|text| text.trim().to_owned());
        let run = Run::read(&folder, origin)?;
        Ok((run.count()? == f64::from(job.bodies)).then_some(run))
    }

    /// Whether the scene in a folder is that of a job. A key missing in one of them has its default: runs of
    /// earlier versions of the program do not have newer keys.
    fn is_of(&self, job: &Job, folder: &Path) -> Result<bool> {
        let path = folder.join("scene.toml");
        let Ok(text) = fs::read_to_string(&path) else {
            return Ok(false);
        };
        let asked = self
            .program
            .output("pack", &format!("{} --print-scene", job.options))?;
        let unusual = |text: &str| -> Vec<String> {
            let lines = settings(text).into_iter();
            lines.filter(|line| !self.usual.contains(line)).collect()
        };
        Ok(unusual(&text) == unusual(&asked))
    }
}

/// Lines that were written into all scenes of boxes before they became optional.
const ONCE_WRITTEN: [&str; 3] = ["container = \"box\"", "outlet = 3.0", "cone = 30.0"];

/// The lines of a scene that change its result.
fn settings(scene: &str) -> Vec<String> {
    let idle = ["#", "out ", "threads ", "checkpoint-every "];
    let counts = |line: &&str| !line.is_empty() && !idle.iter().any(|key| line.starts_with(key));
    scene
        .lines()
        .map(str::trim)
        .filter(counts)
        .map(str::to_owned)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_threads_are_no_settings() {
        let scene = "# A scene\nshape = \"A10\"\nout = \"x\"\nthreads = 2\n\ncheckpoint-every = 60.0\nseed = 1\n";
        assert_eq!(settings(scene), ["shape = \"A10\"", "seed = 1"]);
    }

    #[test]
    fn commands_lead_to_the_folder_that_is_looked_in() {
        let job = |bodies| Job {
            options: "--shape A10".to_owned(),
            bodies,
        };
        let large = command(Path::new("r"), &job(LARGE), 3);
        assert!(
            large.starts_with("femdem pack --shape A10 --threads 3 "),
            "{large}"
        );
        let out = format!("--out {}", folder_of(Path::new("r"), &job(LARGE)).display());
        assert!(large.ends_with(&out), "{large}");
        assert!(command(Path::new("r"), &job(10), 3).contains("--threads 1 "));
    }
}
