//! The checkpoint of a packing job.

use std::path::Path;

use femdem_pack::{Packing, Progress};
use femdem_solve::Halo;

use super::Usage;
use crate::Error;
use crate::gather::{of_all, or_error_of_another};
use crate::saved::{Checkpoint, PartFiles, Saved};

/// Name of the checkpoint in the folder of a pack.
pub const PACK_CHECKPOINT: &str = "pack.ckpt";

const PACK: Checkpoint = Checkpoint {
    file: PACK_CHECKPOINT,
    job: "pack",
    part: "part of a pack",
};

/// A job and its cost so far, as read.
pub struct SavedPack {
    /// The job.
    pub packing: Packing,
    /// Its cost so far.
    pub usage: Usage,
}

impl SavedPack {
    /// Reads [`PACK_CHECKPOINT`] from a folder, with the parts that it names if ranks have written it.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be read or holds no pack.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let Saved {
            job: mut packing,
            usage,
            parts,
        } = PACK.read::<Packing>(folder)?;
        if packing.world().is_shared() {
            packing = Packing::of_parts(packing, PACK.parts(folder, &parts))?;
        }
        Ok(Self { packing, usage })
    }
}

/// Writes [`PACK_CHECKPOINT`] into a folder; an earlier one stays until it is complete.
///
/// # Errors
///
/// [`Error::Solve`] with the file, if it cannot be written.
pub fn save(folder: &Path, packing: &Packing, usage: &Usage) -> Result<(), Error> {
    PACK.write(folder, packing, usage, &PartFiles::default())
}

/// The part of a job that one of several ranks advances.
pub struct PackPart {
    packing: Packing,
    /// Number of the last checkpoint.
    checkpoint: u64,
}

impl PackPart {
    /// Shares out a job that all ranks have made alike.
    ///
    /// # Errors
    ///
    /// As [`Packing::share_out`].
    pub fn share_out(mut packing: Packing, halo: &mut dyn Halo) -> Result<Self, Error> {
        packing.share_out(halo)?;
        Ok(Self {
            packing,
            checkpoint: 0,
        })
    }

    /// Goes on from the checkpoint in a folder, which any ranks have written, or one process. Each rank reads some of the parts. The
    /// first one gets the cost so far.
    ///
    /// # Errors
    ///
    /// As [`SavedPack::read`] and [`Packing::share_from_first`]; an error of one rank is that of all.
    pub fn resume(folder: &Path, halo: &mut dyn Halo) -> Result<(Self, Option<Usage>), Error> {
        let read = (halo.rank() == 0).then(|| PACK.read::<Packing>(folder));
        let read = or_error_of_another(read.transpose().map_err(Error::from), halo)?;
        let (mut first, mut usage, mut files) = (None, None, Vec::new());
        if let Some(saved) = read {
            (first, usage) = (Some(saved.job), Some(saved.usage));
            files.push(saved.parts);
        }
        // The first rank has read them, or all have its error.
        let files = &of_all(files, halo)?[0];
        let parts = PACK.parts_for(folder, files, halo).map_err(Error::from);
        let parts = or_error_of_another(parts, halo)?;
        let part = Self {
            packing: Packing::share_from_first(first, parts, halo)?,
            checkpoint: files.number,
        };
        Ok((part, usage))
    }

    /// The part of this rank.
    #[must_use]
    pub fn packing(&self) -> &Packing {
        &self.packing
    }

    /// Advances the job, as [`Packing::advance_on`].
    ///
    /// # Errors
    ///
    /// As [`Packing::advance_on`].
    pub fn advance(&mut self, steps: u64, halo: &mut dyn Halo) -> Result<Progress, Error> {
        Ok(self.packing.advance_on(steps, halo)?)
    }

    /// Writes a checkpoint into a folder that all ranks have: each writes its part, and the first one [`PACK_CHECKPOINT`], which names the parts
    /// and is put in place last; an earlier checkpoint stays until then.
    ///
    /// # Errors
    ///
    /// As [`save`]; an error of one rank is that of all.
    pub fn save(&mut self, folder: &Path, usage: &Usage, halo: &mut dyn Halo) -> Result<(), Error> {
        let packing = &self.packing;
        let files = PACK.write_parts(folder, self.checkpoint, packing.world(), halo)?;
        let is_first = halo.rank() == 0;
        let written = is_first.then(|| PACK.write(folder, packing, usage, &files));
        PACK.end::<Packing>(folder, &mut self.checkpoint, &files, written, halo)
    }
}
