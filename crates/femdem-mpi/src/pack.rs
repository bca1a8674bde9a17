//! A pack over ranks: the first one writes the files, but for the others' parts of checkpoints.

use crate::cost::Cost;
use crate::folder::{self, of_first};
use anyhow::{Result, ensure};
use femdem::pack::Packing;
use femdem::program::Claim;
use femdem::results::{self, PackPart};
use femdem::solve::{Halo, World};
use femdem::{Scene, Usage};
use femdem_mpi::MpiHalo;
use std::path::{Path, PathBuf};

/// Steps between two looks at the clock.
const PORTION: u64 = 100;

/// A pack of which each rank has a part.
pub(crate) struct Pack {
    part: PackPart,
    folder: PathBuf,
    cost: Cost,
    /// On the first rank.
    _claim: Option<Claim>,
}

impl Pack {
    /// A pack from its beginning. All ranks begin it, and keep their parts.
    pub fn begin(scene: &Scene, halo: &mut MpiHalo) -> Result<Self> {
        let (packing, notes) = scene.packing()?;
        suits(&packing)?;
        let claim = of_first(halo, || {
            for note in notes.iter().filter(|note| note.is_news()) {
                println!("{note}");
            }
            folder::make(&scene.out, &scene.to_toml()?)
        })?;
        let part = PackPart::share_out(packing, halo)?;
        Self::at_start(part, scene.out.clone(), Usage::default(), claim, halo)
    }

    /// The pack in a folder, from its last checkpoint.
    pub fn resume(folder: &Path, halo: &mut MpiHalo) -> Result<Self> {
        let claim = of_first(halo, || folder::claim(folder))?;
        let (part, before) = PackPart::resume(folder, halo)?;
        let packing = part.packing();
        ensure!(
            !packing.is_done(),
            "the pack in {} is done",
            folder.display()
        );
        suits(packing)?;
        let before = before.unwrap_or_default();
        Self::at_start(part, folder.to_owned(), before, claim, halo)
    }

    fn at_start(
        part: PackPart,
        folder: PathBuf,
        before: Usage,
        claim: Option<Claim>,
        halo: &mut MpiHalo,
    ) -> Result<Self> {
        let mut pack = Self {
            part,
            folder,
            cost: Cost::after(before),
            _claim: claim,
        };
        // At once, so that a folder that cannot be written is noticed before the work.
        pack.save(halo)?;
        Ok(pack)
    }

    /// Steps to the end, or so many steps, with a checkpoint after at most `every` seconds and at the end.
    pub fn go_on(mut self, every: f64, steps: Option<u64>, halo: &mut MpiHalo) -> Result<()> {
        let so_far = self.world().steps();
        let last = steps.map_or(u64::MAX, |steps| so_far.saturating_add(steps));
        loop {
            let left = last - self.world().steps();
            let now = self.part.advance(left.min(PORTION), halo)?;
            if self.part.packing().is_done() || now.steps >= last {
                return self.finish(halo);
            }
            if self.cost.is_save_due(every, halo)? {
                self.save(halo)?;
            }
            self.cost.tell(halo, || {
                format!(
                    "{}: {} of {} bodies, {:.3} m high, {:.2} s simulated",
                    now.stage, now.placed, now.count, now.top, now.time
                )
            });
        }
    }

    fn world(&self) -> &World {
        self.part.packing().world()
    }

    /// Writes a checkpoint, and returns the cost so far.
    fn save(&mut self, halo: &mut MpiHalo) -> Result<Usage> {
        let usage = self.cost.usage(self.world().counters(), halo)?;
        self.part.save(&self.folder, &usage, halo)?;
        Ok(usage)
    }

    fn finish(mut self, halo: &mut MpiHalo) -> Result<()> {
        let usage = self.save(halo)?;
        let motion = self.world().checksum_of_motion_on(halo)?;
        let packing = self.part.packing();
        if packing.is_done() {
            if let Some(whole) = packing.gather(halo)? {
                println!("{}", results::write(&self.folder, &whole, &usage)?);
            }
        } else if halo.rank() == 0 {
            println!("go on with: femdem-mpi resume {}", self.folder.display());
        }
        if halo.rank() == 0 {
            println!(
                "{} ranks, {} steps; {:.1} s on the clock, {:.1} s of processors; motion {motion:016x}",
                halo.size(),
                self.world().steps(),
                usage.wall_seconds,
                usage.cpu_seconds.unwrap_or_default(),
            );
        }
        Ok(())
    }
}

/// Refuses packs of which one rank would do all the work.
fn suits(packing: &Packing) -> Result<()> {
    ensure!(
        packing.spec().time_step.implicit.is_none(),
        "implicit steps are taken by one rank alone, and this pack has no others: use `femdem pack`, or --explicit"
    );
    Ok(())
}
