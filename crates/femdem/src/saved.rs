//! The checkpoint of a job: one file, or over ranks one for each, of which the first rank's names the others.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use femdem_solve::checkpoint::{self, Seal};
use femdem_solve::{Halo, SolveError, World};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::gather::{of_all, or_error_of_another};
use crate::{Error, Usage};

/// Folder beside the checkpoint with the parts of other ranks than the first.
const PARTS: &str = "parts";

/// The checkpoint of a kind of job.
pub(crate) struct Checkpoint {
    /// Name of the file in the folder of a job.
    pub file: &'static str,
    /// What it says that it holds.
    pub job: &'static str,
    /// The same of the part of another rank than the first.
    pub part: &'static str,
}

/// A job and its cost so far, as read. Its world is the part of the first rank, if ranks shared it.
#[derive(Deserialize)]
pub(crate) struct Saved<J> {
    pub job: J,
    pub usage: Usage,
    pub parts: PartFiles,
}

/// The same, for writing.
#[derive(Serialize)]
struct Saving<'a, J> {
    job: &'a J,
    usage: &'a Usage,
    parts: &'a PartFiles,
}

/// The parts of other ranks than the first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PartFiles {
    /// Differs from that of the checkpoint before, whose files stay until this one is complete.
    pub number: u64,
    /// Of the ranks from 1.
    seals: Vec<Seal>,
}

impl Checkpoint {
    pub fn read<J: DeserializeOwned>(&self, folder: &Path) -> Result<Saved<J>, SolveError> {
        checkpoint::read_file(&folder.join(self.file), self.job)
    }

    /// Writes the file of a job whose other ranks have written their parts; an earlier one stays until it is complete.
    pub fn write<J: Serialize>(
        &self,
        folder: &Path,
        job: &J,
        usage: &Usage,
        parts: &PartFiles,
    ) -> Result<(), Error> {
        parts.are_there(folder)?;
        let path = folder.join(self.file);
        checkpoint::write_file(&path, self.job, &Saving { job, usage, parts })?;
        parts.forget_others(folder);
        Ok(())
    }

    /// Begins a checkpoint in a folder that all ranks have, `last` being the number of the last one: each rank but the first writes
    /// its part, or all get the error of one. It is complete when the first rank [writes](Self::write) its file.
    pub fn write_parts(
        &self,
        folder: &Path,
        last: u64,
        world: &World,
        halo: &mut dyn Halo,
    ) -> Result<PartFiles, Error> {
        let mut files = PartFiles {
            number: last + 1,
            seals: Vec::new(),
        };
        let rank = halo.rank();
        let others = (rank > 0).then(|| files.write(folder, rank, self.part, world));
        let written = or_error_of_another(others.transpose(), halo);
        if written.is_err() && rank > 0 {
            files.forget(folder, rank);
        }
        files.seals = of_all(written?.into_iter().collect(), halo)?;
        Ok(files)
    }

    /// Ends a checkpoint whose file the first rank has written, or has not: then all get its error. `last` becomes its number if a file
    /// may name it.
    pub fn end<J: DeserializeOwned>(
        &self,
        folder: &Path,
        last: &mut u64,
        files: &PartFiles,
        written: Option<Result<(), Error>>,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        // An error may come after the file is in place. If not, the number is taken again, and the parts are written over.
        let may_be_named = |written: &Result<(), Error>| {
            written.is_ok() || self.may_name::<J>(folder, files.number)
        };
        let mut named = [u64::from(written.as_ref().is_some_and(may_be_named))];
        halo.sum(&mut named)?;
        if named[0] > 0 {
            *last = files.number;
        }
        or_error_of_another(written.unwrap_or(Ok(())), halo)
    }

    /// Whether a folder has a file that names the parts of a number, or cannot be read.
    fn may_name<J: DeserializeOwned>(&self, folder: &Path, number: u64) -> bool {
        let is_there = folder.join(self.file).try_exists().unwrap_or(true);
        is_there
            && self
                .read::<J>(folder)
                .map_or(true, |saved| saved.parts.number == number)
    }

    /// The parts of the ranks from 1.
    pub fn parts<'a>(
        &'a self,
        folder: &'a Path,
        files: &'a PartFiles,
    ) -> impl Iterator<Item = Result<World, SolveError>> + 'a {
        let ranks = 1..=files.seals.len();
        ranks.map(|rank| files.read(folder, rank, self.part))
    }

    /// Those of them that a rank reads when some go on, whose first one has the first part.
    pub fn parts_for(
        &self,
        folder: &Path,
        files: &PartFiles,
        halo: &dyn Halo,
    ) -> Result<Vec<World>, SolveError> {
        let ranks = 0..=files.seals.len();
        let own = ranks.skip(halo.rank()).step_by(halo.size());
        let own = own.filter(|rank| *rank > 0);
        own.map(|rank| files.read(folder, rank, self.part))
            .collect()
    }
}

impl PartFiles {
    fn path(&self, folder: &Path, rank: usize) -> PathBuf {
        folder
            .join(PARTS)
            .join(format!("{}-{rank}.ckpt", self.number))
    }

    /// Writes the part of a rank.
    fn write(&self, folder: &Path, rank: usize, kind: &str, world: &World) -> Result<Seal, Error> {
        let parts = folder.join(PARTS);
        fs::create_dir_all(&parts).map_err(|source| SolveError::Io {
            action: "cannot create",
            path: parts,
            source,
        })?;
        Ok(checkpoint::write_sealed(
            &self.path(folder, rank),
            kind,
            world,
        )?)
    }

    /// Removes the part of a rank, of a checkpoint that was not completed.
    fn forget(&self, folder: &Path, rank: usize) {
        // Best effort: no checkpoint names it.
        fs::remove_file(self.path(folder, rank)).ok();
    }

    /// Reads the part of a rank.
    fn read(&self, folder: &Path, rank: usize, kind: &str) -> Result<World, SolveError> {
        let path = self.path(folder, rank);
        let mut world: World = checkpoint::read_sealed(&path, kind, &self.seals[rank - 1])?;
        world.restore()?;
        Ok(world)
    }

    /// Checks, before a checkpoint names them, that the parts lie in the folder, with their lengths.
    fn are_there(&self, folder: &Path) -> Result<(), SolveError> {
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
