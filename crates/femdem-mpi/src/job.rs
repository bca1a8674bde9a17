//! A run over ranks: the first one keeps the books and writes the files, but for the others' parts of checkpoints.

use crate::cost::Cost;
use crate::folder::{self, of_first};
use anyhow::{Result, ensure};
use femdem::Usage;
use femdem::program::Claim;
use femdem::run::{Part, Run, Scenario};
use femdem::solve::Halo;
use femdem_mpi::MpiHalo;
use std::path::{Path, PathBuf};

/// Steps after which the first rank says whether it is time for a checkpoint.
const STEPS_BETWEEN_QUESTIONS: u64 = 16;

/// A run of which each rank has a part.
pub(crate) struct Job {
    part: Part,
    folder: PathBuf,
    /// On the first rank.
    run: Option<Run>,
    cost: Cost,
    /// On the first rank.
    _claim: Option<Claim>,
}

impl Job {
    /// A run of a scene from its beginning. The first rank builds it.
    pub fn begin(scene: &Path, out: Option<PathBuf>, halo: &mut MpiHalo) -> Result<Self> {
        let mut scenario = Scenario::read(scene)?;
        if let Some(out) = out {
            scenario.out = out;
        }
        let folder = scenario.out.clone();
        let made = of_first(halo, || {
            let mut run = Run::new(scenario)?;
            let claim = folder::make(&folder, &run.scenario().to_toml()?)?;
            run.steps_elsewhere()?;
            // What is due at the beginning.
            run.advance(&folder, 0)?;
            Ok((run, claim))
        })?;
        let (mut run, claim) = made.unzip();
        let part = Part::share_out(run.as_mut(), halo)?;
        Self::at_start(part, folder, (run, claim), Usage::default(), halo)
    }

    /// The run in a folder, from its last checkpoint.
    pub fn resume(folder: &Path, halo: &mut MpiHalo) -> Result<Self> {
        let claim = of_first(halo, || folder::claim(folder))?;
        let (part, read) = Part::resume(folder, halo)?;
        let (run, before) = read.unzip();
        let has_ended = run.as_ref().is_some_and(|run| run.ending().is_some());
        ensure!(!has_ended, "the run in {} has ended", folder.display());
        let before = before.unwrap_or_default();
        Self::at_start(part, folder.to_owned(), (run, claim), before, halo)
    }

    fn at_start(
        part: Part,
        folder: PathBuf,
        (run, claim): (Option<Run>, Option<Claim>),
        before: Usage,
        halo: &mut MpiHalo,
    ) -> Result<Self> {
        let mut job = Self {
            part,
            folder,
            run,
            cost: Cost::after(before),
            _claim: claim,
        };
        // At once, so that a folder that cannot be written is noticed before the work.
        job.save(halo)?;
        Ok(job)
    }

    /// Steps to the end of the run, or so many steps, with a checkpoint after at most `every` seconds and at the end.
    pub fn go_on(mut self, every: f64, steps: Option<u64>, halo: &mut MpiHalo) -> Result<()> {
        let so_far = self.part.steps();
        let last = steps.map_or(u64::MAX, |steps| so_far.saturating_add(steps));
        let mut due = self.next_due(halo)?;
        let mut ended = false;
        while !ended && self.part.steps() < last {
            let may_end = self.part.step(halo)?;
            let time = self.part.world().time();
            let is_seen = may_end || time >= due;
            if is_seen {
                ended = self.catch_up(halo)?;
                due = self.next_due(halo)?;
            }
            let is_asked = is_seen || self.part.steps().is_multiple_of(STEPS_BETWEEN_QUESTIONS);
            if is_asked && !ended && self.cost.is_save_due(every, halo)? {
                self.save(halo)?;
            }
            let part = &self.part;
            self.cost.tell(halo, || match part.is_relaxing() {
                true => format!("{} steps, the bodies are relaxed", part.steps()),
                false => format!("{time:.6} of {} s", part.scenario().duration),
            });
        }
        self.finish(halo)
    }

    /// When the first rank must see the world next, s.
    fn next_due(&self, halo: &mut MpiHalo) -> Result<f64> {
        let mut due = [self.run.as_ref().map_or(f64::INFINITY, Run::next_due)];
        halo.least(&mut due)?;
        Ok(due[0])
    }

    /// Shows the bodies to the first rank, which writes what is due. Returns whether the run has ended.
    fn catch_up(&mut self, halo: &mut MpiHalo) -> Result<bool> {
        Ok(self.part.go_on(self.run.as_mut(), &self.folder, halo)?)
    }

    /// The cost so far: in a relaxation that of the bodies which the first rank has.
    fn usage(&self, halo: &mut MpiHalo) -> Result<Usage> {
        let all = self.run.as_ref().filter(|_| self.part.is_relaxing());
        let world = all.map_or(self.part.world(), |run| &run.simulation().world);
        self.cost.usage(world.counters(), halo)
    }

    fn save(&mut self, halo: &mut MpiHalo) -> Result<()> {
        let usage = self.usage(halo)?;
        if let Some(run) = &mut self.run {
            run.flush(&self.folder)?;
        }
        let run = self.run.as_mut();
        Ok(self.part.save(run, &self.folder, &usage, halo)?)
    }

    fn finish(mut self, halo: &mut MpiHalo) -> Result<()> {
        let usage = self.usage(halo)?;
        // In a relaxation the first rank has all bodies.
        let all = self.run.as_ref().filter(|_| self.part.is_relaxing());
        let world = all.map_or(self.part.world(), |run| &run.simulation().world);
        let motion = match self.part.is_relaxing() {
            true if halo.rank() > 0 => 0,
            true => world.checksum_of_motion()?,
            false => world.checksum_of_motion_on(halo)?,
        };
        if halo.rank() == 0 {
            println!(
                "{} ranks, {} steps, {:.6} s; {:.1} s on the clock, {:.1} s of processors; motion {motion:016x}",
                halo.size(),
                world.steps(),
                world.time(),
                usage.wall_seconds,
                usage.cpu_seconds.unwrap_or_default(),
            );
        }
        if let Some(run) = &mut self.run {
            if run.ending().is_some() {
                let summary = run.finish(&self.folder, &usage)?;
                println!("{summary}");
            } else {
                println!("go on with: femdem-mpi resume {}", self.folder.display());
            }
        }
        self.save(halo)
    }
}
