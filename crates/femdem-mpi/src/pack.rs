//! A pack over ranks: the first one writes the files.

use crate::cost::Cost;
use crate::folder::{self, of_first};
use anyhow::{Result, ensure};
use femdem::pack::Packing;
use femdem::program::Claim;
use femdem::results::{self, SavedPack};
use femdem::solve::Halo;
use femdem::{Scene, Usage};
use femdem_mpi::MpiHalo;
use std::path::{Path, PathBuf};

/// Steps between two looks at the clock.
const PORTION: u64 = 100;

/// A pack of which each rank has a part.
pub(crate) struct Pack {
    /// The part of this rank.
    packing: Packing,
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
        Self::share(packing, scene.out.clone(), Usage::default(), claim, halo)
    }

    /// The pack in a folder, from its last checkpoint.
    pub fn resume(folder: &Path, halo: &mut MpiHalo) -> Result<Self> {
        let claim = of_first(halo, || folder::claim(folder))?;
        let SavedPack { packing, usage } = SavedPack::read(folder)?;
        ensure!(
            !packing.is_done(),
            "the pack in {} is done",
            folder.display()
        );
        Self::share(packing, folder.to_owned(), usage, claim, halo)
    }

    fn share(
        mut packing: Packing,
        folder: PathBuf,
        before: Usage,
        claim: Option<Claim>,
        halo: &mut MpiHalo,
    ) -> Result<Self> {
        suits(&packing)?;
        if halo.rank() == 0 {
            // At once, so that a folder that cannot be written is noticed before the work.
            results::save(&folder, &packing, &before)?;
        }
        packing.share_out(halo)?;
        Ok(Self {
            packing,
            folder,
            cost: Cost::after(before),
            _claim: claim,
        })
    }

    /// Steps to the end, or so many steps, with a checkpoint after at most `every` seconds and at the end.
    pub fn go_on(mut self, every: f64, steps: Option<u64>, halo: &mut MpiHalo) -> Result<()> {
        let so_far = self.packing.world().steps();
        let last = steps.map_or(u64::MAX, |steps| so_far.saturating_add(steps));
        loop {
            let left = last - self.packing.world().steps();
            let now = self.packing.advance_on(left.min(PORTION), halo)?;
            if self.packing.is_done() || now.steps >= last {
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

    /// Writes a checkpoint, and returns the whole pack on the first rank.
    fn save(&self, halo: &mut MpiHalo) -> Result<Option<(Packing, Usage)>> {
        let usage = self.cost.usage(self.packing.world().counters(), halo)?;
        let Some(whole) = self.packing.gather(halo)? else {
            return Ok(None);
        };
        results::save(&self.folder, &whole, &usage)?;
        Ok(Some((whole, usage)))
    }

    fn finish(self, halo: &mut MpiHalo) -> Result<()> {
        let Some((whole, usage)) = self.save(halo)? else {
            return Ok(());
        };
        let motion = whole.world().checksum_of_motion()?;
        if whole.is_done() {
            println!("{}", results::write(&self.folder, &whole, &usage)?);
        } else {
            println!("go on with: femdem-mpi resume {}", self.folder.display());
        }
        println!(
            "{} ranks, {} steps; {:.1} s on the clock, {:.1} s of processors; motion {motion:016x}",
            halo.size(),
            whole.world().steps(),
            usage.wall_seconds,
            usage.cpu_seconds.unwrap_or_default(),
        );
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
