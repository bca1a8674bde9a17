//! The checkpoint of a packing job.

use std::path::Path;

use femdem_pack::Packing;
use femdem_solve::checkpoint;
use serde::{Deserialize, Serialize};

use super::Usage;
use crate::Error;

/// Name of the checkpoint in the folder of a pack.
pub const PACK_CHECKPOINT: &str = "pack.ckpt";

/// What the checkpoint says that it holds.
const KIND: &str = "pack";

/// A job and its cost so far, as read.
#[derive(Deserialize)]
pub struct SavedPack {
    /// The job.
    pub packing: Packing,
    /// Its cost so far.
    pub usage: Usage,
}

/// The same, for writing.
#[derive(Serialize)]
struct Saving<'a> {
    packing: &'a Packing,
    usage: &'a Usage,
}

impl SavedPack {
    /// Reads [`PACK_CHECKPOINT`] from a folder.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be read or holds no pack.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        Ok(checkpoint::read_file(&folder.join(PACK_CHECKPOINT), KIND)?)
    }
}

/// Writes [`PACK_CHECKPOINT`] into a folder; an earlier one stays until it is complete.
///
/// # Errors
///
/// [`Error::Solve`] with the file, if it cannot be written.
pub fn save(folder: &Path, packing: &Packing, usage: &Usage) -> Result<(), Error> {
    let path = folder.join(PACK_CHECKPOINT);
    Ok(checkpoint::write_file(
        &path,
        KIND,
        &Saving { packing, usage },
    )?)
}
