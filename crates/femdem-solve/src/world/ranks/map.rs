//! Where bodies are among the ranks, in space that may repeat itself.

use super::cuts::Cuts;
use femdem_contact::PeriodicCell;
use femdem_mesh::Vector3;
use std::collections::BTreeSet;

/// The boxes of the ranks, and the cell whose images they share.
#[derive(Clone, Copy)]
pub(super) struct Map<'a> {
    pub cuts: &'a Cuts,
    pub cell: Option<&'a PeriodicCell>,
}

/// The image of a place in the cell, m.
pub(super) fn in_cell(cell: Option<&PeriodicCell>, x: &Vector3) -> Vector3 {
    cell.map_or(*x, |cell| cell.wrapped(x))
}

impl Map<'_> {
    /// The rank whose box a place is in.
    pub fn owner(&self, x: &Vector3) -> usize {
        self.cuts.owner(&in_cell(self.cell, x))
    }

    /// The ranks whose boxes are within `reach` (m) of an image of a place along each axis, ascending.
    pub fn near(&self, x: &Vector3, reach: f64) -> Vec<usize> {
        let Some(cell) = self.cell else {
            return self.cuts.near(x, reach);
        };
        let x = cell.wrapped(x);
        let ways = cell.images(&x, reach);
        let ranks = ways
            .iter()
            .flat_map(|way| self.cuts.near(&(x + way), reach));
        ranks.collect::<BTreeSet<usize>>().into_iter().collect()
    }
}
