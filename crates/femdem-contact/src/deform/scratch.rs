//! Buffers of the pair kernel of deformable bodies.

use super::skins::SkinScratch;
use super::sums::PairSums;
use crate::tets::current::Current;
use crate::tets::piece::Piece;
use crate::tets::posed::{Posed, PosedList};

/// Buffers that the kernel reuses from call to call.
#[derive(Debug, Default)]
pub struct DeformableScratch {
    pub(crate) tets: [PosedList<Current>; 2],
    /// The same with planes, for pieces.
    pub(crate) planes: [PosedList<Posed>; 2],
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
