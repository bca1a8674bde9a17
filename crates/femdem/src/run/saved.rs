//! The checkpoint of a run: one file, or over ranks one for each, of which the first rank's names the others.

use std::fs::{self, File};
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

    /// Checks, before a checkpoint names them, that the parts lie in the folder, with their lengths.
    pub fn are_there(&self, folder: &Path) -> Result<(), SolveError> {
        for (rank, seal) in (1..).zip(&self.seals) {
            let path = self.path(folder, rank);
            // Opened, so that a folder of a network is looked up anew.
            let found = File::open(&path).and_then(|file| file.metadata());
            let length = match found {
                Ok(found) => found.len(),
                Err(source) => {
                    return Err(SolveError::Io {
                        action: "the first rank, which must see the folder of all, cannot find",
                        path,
                        source,
                    });
                }
            };
            if length != seal.file_length() {
                let why = format!(
                    "rank {rank} has written {} bytes, but the first rank finds {length}: all ranks must see one folder",
                    seal.file_length()
                );
                return Err(SolveError::BadCheckpoint { path, why });
            }
        }
        Ok(())
    }

    /// Removes the files of other checkpoints.
    fn forget_others(&self, folder: &Path) {
        let own: Vec<PathBuf> = (1..=self.seals.len())
            .map(|rank| self.path(folder, rank))
            .collect();
        forget_parts(folder, &own);
    }
}

/// Removes the parts of checkpoints in a folder but for some, and what was left of writing them.
pub(crate) fn forget_parts(folder: &Path, but: &[PathBuf]) {
    let parts = folder.join(PARTS);
    // Best effort: no checkpoint names them. A folder elsewhere is another's.
    if !fs::symlink_metadata(&parts).is_ok_and(|found| found.is_dir()) {
        return;
    }
    let files = fs::read_dir(&parts).into_iter().flatten().flatten();
    for file in files {
        let is_part = file.file_type().is_ok_and(|found| found.is_file())
            && file.file_name().to_str().is_some_and(is_name_of_part);
        if is_part && !but.contains(&file.path()) {
            fs::remove_file(file.path()).ok();
        }
    }
    if but.is_empty() {
        // Stays if it holds anything else.
        fs::remove_dir(&parts).ok();
    }
}

/// Whether a file is named as [`PartFiles::path`] names a part, or as one that is being written.
fn is_name_of_part(name: &str) -> bool {
    let name = name.strip_suffix(".tmp").unwrap_or(name);
    let numbers = name.strip_suffix(".ckpt").and_then(|n| n.split_once('-'));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
    numbers.is_some_and(|(number, rank)| is_number(number) && is_number(rank))
}

impl Saved {
    /// Whether a folder has a checkpoint that names the parts of a number, or cannot be read.
    pub fn may_name(folder: &Path, number: u64) -> bool {
        let is_there = folder.join(RUN_CHECKPOINT).try_exists().unwrap_or(true);
        is_there && Self::read(folder).map_or(true, |saved| saved.parts.number == number)
    }

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
        parts.are_there(folder)?;
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
