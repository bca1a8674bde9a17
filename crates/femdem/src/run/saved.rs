//! The checkpoint of a run: one file, or over ranks one for each, of which the first rank's names the others.

use std::fs;
use std::path::{Path, PathBuf};

use femdem_solve::checkpoint::{self, Seal};
use femdem_solve::{SolveError, World};
use serde::{Deserialize, Serialize};

use super::Run;
use crate::{Error, Usage};

/// Name of the checkpoint in the folder of a run.
pub const RUN_CHECKPOINT: &str = "run.ckpt";

/// Folder beside it with the parts of other ranks than the first.
const PARTS: &str = "parts";

/// What the checkpoint says that it holds, and a part of another rank.
const KIND: &str = "run";
const PART: &str = "part of a run";

/// A run and its cost so far, as read. Its world is the part of the first rank, if ranks shared it.
#[derive(Deserialize)]
pub(super) struct Saved {
    pub run: Run,
    pub usage: Usage,
    pub parts: PartFiles,
}

/// The same, for writing.
#[derive(Serialize)]
struct Saving<'a> {
    run: &'a Run,
    usage: &'a Usage,
    parts: &'a PartFiles,
}

/// The parts of other ranks than the first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct PartFiles {
    /// Differs from that of the checkpoint before, whose files stay until this one is complete.
    pub number: u64,
    /// Of the ranks from 1.
    pub seals: Vec<Seal>,
}

impl PartFiles {
    fn path(&self, folder: &Path, rank: usize) -> PathBuf {
        folder
            .join(PARTS)
            .join(format!("{}-{rank}.ckpt", self.number))
    }

    /// Writes the part of a rank.
    pub fn write(&self, folder: &Path, rank: usize, world: &World) -> Result<Seal, Error> {
        let parts = folder.join(PARTS);
        fs::create_dir_all(&parts).map_err(|source| SolveError::Io {
            action: "cannot create",
            path: parts,
            source,
        })?;
        Ok(checkpoint::write_sealed(
            &self.path(folder, rank),
            PART,
            world,
        )?)
    }

    /// Removes the part of a rank, of a checkpoint that was not completed.
    pub fn forget(&self, folder: &Path, rank: usize) {
        // Best effort: no checkpoint names it.
        fs::remove_file(self.path(folder, rank)).ok();
    }

    /// Reads the part of a rank.
    pub fn read(&self, folder: &Path, rank: usize) -> Result<World, SolveError> {
        let path = self.path(folder, rank);
        let mut world: World = checkpoint::read_sealed(&path, PART, &self.seals[rank - 1])?;
        world.restore()?;
        Ok(world)
    }

    /// Removes the files of other checkpoints.
    fn forget_others(&self, folder: &Path) {
        let parts = folder.join(PARTS);
        let own: Vec<PathBuf> = (1..=self.seals.len())
            .map(|rank| self.path(folder, rank))
            .collect();
        // Best effort: no checkpoint names them.
        let files = fs::read_dir(&parts).into_iter().flatten().flatten();
        for path in files.map(|file| file.path()) {
            if !own.contains(&path) {
                fs::remove_file(path).ok();
            }
        }
        if own.is_empty() {
            fs::remove_dir(&parts).ok();
        }
    }
}

impl Saved {
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(RUN_CHECKPOINT);
        Ok(checkpoint::read_file(&path, KIND)?)
    }
}

impl Run {
    /// Writes [`RUN_CHECKPOINT`] into a folder; an earlier one stays until it is complete. Call [`flush`](Self::flush) first.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be written.
    pub fn save(&self, folder: &Path, usage: &Usage) -> Result<(), Error> {
        self.save_with(&PartFiles::default(), folder, usage)
    }

    /// The same of a run whose other ranks have written their parts.
    pub(super) fn save_with(
        &self,
        parts: &PartFiles,
        folder: &Path,
        usage: &Usage,
    ) -> Result<(), Error> {
        let run = self;
        let path = folder.join(RUN_CHECKPOINT);
        checkpoint::write_file(&path, KIND, &Saving { run, usage, parts })?;
        parts.forget_others(folder);
        Ok(())
    }

    /// Reads [`RUN_CHECKPOINT`] from a folder, with the parts that it names if ranks have written it: the run, and its cost so far.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be read or holds no run.
    pub fn read(folder: &Path) -> Result<(Self, Usage), Error> {
        let Saved {
            mut run,
            usage,
            parts,
        } = Saved::read(folder)?;
        let world = &mut run.simulation_mut().world;
        if world.is_shared() {
            let first = std::mem::replace(world, World::new(*world.parameters())?);
            let others = (1..=parts.seals.len()).map(|rank| parts.read(folder, rank));
            *world = World::of_parts(std::iter::once(Ok(first)).chain(others))?;
        }
        Ok((run, usage))
    }
}
