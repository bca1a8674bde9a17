//! Buffers of the pair kernel of deformable bodies.

use super::skins::SkinScratch;
use super::sums::PairSums;
use crate::tets::current::Current;
use crate::tets::piece::Piece;
use crate::tets::posed::{Posed, PosedList};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Buffers that the kernel reuses from call to call.
#[derive(Debug, Default)]
pub struct DeformableScratch {
    pub(crate) tets: [PosedList<Current>; 2],
    /// The same with planes, for pieces.
    pub(crate) planes: [PosedList<Posed>; 2],
    /// Those of the mesh, in sums of a body with itself.
    pub(crate) wholes: [PosedList<Posed>; 2],
    pub(crate) piece: Piece,
    pub(crate) sums: PairSums,
    pub(crate) skins: SkinScratch,
    pub(crate) candidates: usize,
}

impl DeformableScratch {
    /// Numbers of pairs of tetrahedra that the last evaluation tested, and of those in which the skin of one
    /// lies in the other.
    pub fn counts(&self) -> [usize; 2] {
        [self.candidates, self.sums.pieces]
    }
}

/// Buffers that are handed to threads and come back, so that they need not grow anew in every update.
#[derive(Debug, Default)]
pub(crate) struct Scratches(Mutex<Vec<DeformableScratch>>);

/// They carry no values: those of a copy are new.
impl Clone for Scratches {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Scratches {
    pub fn lend(&self) -> Lent<'_> {
        let back = self.kept().pop();
        Lent {
            scratch: back.unwrap_or_default(),
            owner: self,
        }
    }

    fn kept(&self) -> MutexGuard<'_, Vec<DeformableScratch>> {
        // Whatever a thread that panicked left behind is overwritten before it is read.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Buffers in use.
pub(crate) struct Lent<'a> {
    pub scratch: DeformableScratch,
    owner: &'a Scratches,
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        let scratch = std::mem::take(&mut self.scratch);
        self.owner.kept().push(scratch);
    }
}
