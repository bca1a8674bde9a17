//! A run over ranks: the first one keeps the books and writes the files.

use crate::cost::{Cost, make_folder};
use anyhow::{Result, ensure};
use femdem::Usage;
use femdem::run::{Run, Scenario};
use femdem::solve::{Halo, World, WorldParameters};
use femdem_mpi::MpiHalo;
use std::path::{Path, PathBuf};

/// A run of which each rank has a part.
pub(crate) struct Job {
    /// The part of this rank.
    world: World,
    scenario: Scenario,
    folder: PathBuf,
    /// On the first rank.
    run: Option<Run>,
    cost: Cost,
}

impl Job {
    /// A run of a scene from its beginning. All ranks build it, and keep their parts.
    pub fn begin(scene: &Path, out: Option<PathBuf>, halo: &mut MpiHalo) -> Result<Self> {
        let mut scenario = Scenario::read(scene)?;
        if let Some(out) = out {
            scenario.out = out;
        }
        let folder = scenario.out.clone();
        let run = Run::new(scenario)?;
        if halo.rank() == 0 {
            make_folder(&folder, &run.scenario().to_toml()?)?;
        }
        Self::share(run, folder, Usage::default(), halo)
    }

    /// The run in a folder, from its last checkpoint.
    pub fn resume(folder: &Path, halo: &mut MpiHalo) -> Result<Self> {
        let (run, before) = Run::read(folder)?;
        ensure!(
            run.ending().is_none(),
            "the run in {} has ended",
            folder.display()
        );
        Self::share(run, folder.to_owned(), before, halo)
    }

    fn share(mut run: Run, folder: PathBuf, before: Usage, halo: &mut MpiHalo) -> Result<Self> {
        run.steps_elsewhere()?;
        if halo.rank() == 0 {
            // What is due at the beginning.
            run.advance(&folder, 0)?;
            run.flush(&folder)?;
            // At once, so that a folder that cannot be written is noticed before the work.
            run.save(&folder, &before)?;
        }
        let empty = World::new(WorldParameters::default())?;
        let mut world = run.give_world(empty);
        world.share_out_with(&run.scenario().to_toml()?, halo)?;
        Ok(Self {
            world,
            scenario: run.scenario().clone(),
            folder,
            run: (halo.rank() == 0).then_some(run),
            cost: Cost::after(before),
        })
    }

    /// Steps to the end of the run, or so many steps, with a checkpoint after at most `every` seconds and at the end.
    pub fn go_on(mut self, every: f64, steps: Option<u64>, halo: &mut MpiHalo) -> Result<()> {
        let last = steps.map_or(u64::MAX, |steps| self.world.steps().saturating_add(steps));
        let mut due = self.next_due(halo)?;
        let mut ends = false;
        while !ends && self.world.steps() < last {
            self.world.step_on(halo)?;
            let time = self.world.time();
            let allowed = self.scenario.sleeps_at(time);
            if self.world.parameters().sleeping.enabled != allowed {
                self.world.set_sleeping(allowed);
            }
            ends = time >= self.scenario.duration;
            if time >= due {
                self.catch_up(halo)?;
                due = self.next_due(halo)?;
                if self.cost.is_save_due(every, halo)? {
                    self.save(halo)?;
                }
            }
            let duration = self.scenario.duration;
            self.cost
                .tell(halo, || format!("{time:.6} of {duration} s"));
        }
        if !ends {
            self.catch_up(halo)?;
        }
        self.finish(halo)
    }

    /// When the first rank must see the world next, s.
    fn next_due(&self, halo: &mut MpiHalo) -> Result<f64> {
        let mut due = [self.run.as_ref().map_or(f64::INFINITY, Run::next_due)];
        halo.least(&mut due)?;
        Ok(due[0])
    }

    /// Shows the first rank all bodies, which writes what is due.
    fn catch_up(&mut self, halo: &mut MpiHalo) -> Result<()> {
        let whole = self.world.gather(halo)?;
        if let Some((run, whole)) = self.run.as_mut().zip(whole) {
            run.go_on_with(whole, &self.folder)?;
        }
        Ok(())
    }

    fn save(&mut self, halo: &mut MpiHalo) -> Result<()> {
        let usage = self.cost.usage(self.world.counters(), halo)?;
        if let Some(run) = &mut self.run {
            run.flush(&self.folder)?;
            run.save(&self.folder, &usage)?;
        }
        Ok(())
    }

    fn finish(mut self, halo: &mut MpiHalo) -> Result<()> {
        let usage = self.cost.usage(self.world.counters(), halo)?;
        let Some(mut run) = self.run.take() else {
            return Ok(());
        };
        let motion = run.simulation().world.checksum_of_motion()?;
        let world = &run.simulation().world;
        println!(
            "{} ranks, {} steps, {:.6} s; {:.1} s on the clock, {:.1} s of processors; motion {motion:016x}",
            halo.size(),
            world.steps(),
            world.time(),
            usage.wall_seconds,
            usage.cpu_seconds.unwrap_or_default(),
        );
        if run.ending().is_some() {
            let summary = run.finish(&self.folder, &usage)?;
            println!("{summary}");
        } else {
            run.flush(&self.folder)?;
            println!("go on with: femdem-mpi resume {}", self.folder.display());
        }
        Ok(run.save(&self.folder, &usage)?)
    }
}
