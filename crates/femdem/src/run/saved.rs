//! The checkpoint of a run.

use std::path::Path;

use femdem_solve::World;

use super::Run;
use crate::saved::{Checkpoint, PartFiles, Saved};
use crate::{Error, Usage};

/// Name of the checkpoint in the folder of a run.
pub const RUN_CHECKPOINT: &str = "run.ckpt";

pub(super) const RUN: Checkpoint = Checkpoint {
    file: RUN_CHECKPOINT,
    job: "run",
    part: "part of a run",
};

impl Run {
    /// Writes [`RUN_CHECKPOINT`] into a folder; an earlier one stays until it is complete. Call [`flush`](Self::flush) first.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be written.
    pub fn save(&self, folder: &Path, usage: &Usage) -> Result<(), Error> {
        RUN.write(folder, self, usage, &PartFiles::default())
    }

    /// Reads [`RUN_CHECKPOINT`] from a folder, with the parts that it names if ranks have written it: the run, and its cost so far.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be read or holds no run.
    pub fn read(folder: &Path) -> Result<(Self, Usage), Error> {
        let Saved {
            job: mut run,
            usage,
            parts,
        } = RUN.read::<Self>(folder)?;
        let world = &mut run.simulation_mut().world;
        if world.is_shared() {
            let first = std::mem::replace(world, World::new(*world.parameters())?);
            let others = RUN.parts(folder, &parts);
            *world = World::of_parts(std::iter::once(Ok(first)).chain(others))?;
        }
        Ok((run, usage))
    }
}
