//! The checkpoint of a run.

use std::path::Path;

use femdem_solve::checkpoint;
use serde::{Deserialize, Serialize};

use super::Run;
use crate::{Error, Usage};

/// Name of the checkpoint in the folder of a run.
pub const RUN_CHECKPOINT: &str = "run.ckpt";

/// What the checkpoint says that it holds.
const KIND: &str = "run";

/// A run and its cost so far, as read.
#[derive(Deserialize)]
struct Saved {
    run: Run,
    usage: Usage,
}

/// The same, for writing.
#[derive(Serialize)]
struct Saving<'a> {
    run: &'a Run,
    usage: &'a Usage,
}

impl Run {
    /// Writes [`RUN_CHECKPOINT`] into a folder; an earlier one stays until it is complete. Call [`flush`](Self::flush) first.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be written.
    pub fn save(&self, folder: &Path, usage: &Usage) -> Result<(), Error> {
        let path = folder.join(RUN_CHECKPOINT);
        Ok(checkpoint::write_file(
            &path,
            KIND,
            &Saving { run: self, usage },
        )?)
    }

    /// Reads [`RUN_CHECKPOINT`] from a folder: the run, and its cost so far.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the file, if it cannot be read or holds no run.
    pub fn read(folder: &Path) -> Result<(Self, Usage), Error> {
        let saved: Saved = checkpoint::read_file(&folder.join(RUN_CHECKPOINT), KIND)?;
        Ok((saved.run, saved.usage))
    }
}
