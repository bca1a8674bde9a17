//! One number for the whole state, for bitwise comparison of runs.

use super::World;
use crate::checkpoint;
use crate::error::SolveError;

impl World {
    /// A hash of everything the next step depends on: poses, velocities, friction history,
    /// caches, step control, energy flows.
    ///
    /// # Errors
    /// [`SolveError::Encoding`] if the state cannot be encoded.
    pub fn state_hash(&self) -> Result<u64, SolveError> {
        checkpoint::hash(self)
    }
}
