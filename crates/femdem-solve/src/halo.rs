//! What the ranks of a shared world need of each other.

use crate::error::SolveError;

/// The way from a rank to the others, as MPI gives it.
///
/// Ranks are processes, or threads, that hold a part of the bodies each and call the same methods of their worlds in the same
/// order. An error that one of them gets ends the work of all: the others wait for it in vain unless the halo ends them.
///
/// ```
/// use femdem_solve::{Alone, Halo};
///
/// let mut values = [3.0, -1.0];
/// Alone.least(&mut values)?;
/// assert_eq!((Alone.rank(), Alone.size(), values), (0, 1, [3.0, -1.0]));
/// # Ok::<(), femdem_solve::SolveError>(())
/// ```
pub trait Halo {
    /// This rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn size(&self) -> usize;

    /// Replaces each value by the least of those of all ranks. None is NaN.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] if another rank cannot be reached.
    fn least(&mut self, values: &mut [f64]) -> Result<(), SolveError>;

    /// Replaces each count by its sum over all ranks.
    ///
    /// # Errors
    /// As [`least`](Self::least).
    fn sum(&mut self, counts: &mut [u64]) -> Result<(), SolveError>;

    /// Sends a message to each of some ranks, ascending, and returns those that the same ranks send, in their order. If one rank
    /// names another, that one names it too.
    ///
    /// # Errors
    /// As [`least`](Self::least).
    fn swap(&mut self, with: &[usize], messages: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, SolveError>;

    /// Sends messages to any ranks, each once at most, and returns all that were sent to this one, with their senders,
    /// ascending. All ranks call it.
    ///
    /// # Errors
    /// As [`least`](Self::least).
    fn send(
        &mut self,
        messages: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, SolveError>;
}

/// The only rank.
#[derive(Debug, Clone, Copy, Default)]
pub struct Alone;

impl Halo for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn least(&mut self, _: &mut [f64]) -> Result<(), SolveError> {
        Ok(())
    }

    fn sum(&mut self, _: &mut [u64]) -> Result<(), SolveError> {
        Ok(())
    }

    fn swap(&mut self, _: &[usize], messages: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, SolveError> {
        Ok(messages)
    }

    fn send(
        &mut self,
        messages: Vec<(usize, Vec<u8>)>,
    ) -> Result<Vec<(usize, Vec<u8>)>, SolveError> {
        Ok(messages)
    }
}
