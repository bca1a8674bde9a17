//! What a decision looks at.

use super::strength::Strength;
use crate::error::{FemError, check};
use crate::model::ElementStress;
use femdem_mesh::Vector3;
use femdem_mesh::tet::CrackedMesh;

/// All that the decision looks at, at one moment.
#[derive(Clone, Copy, Debug)]
pub struct NodalDecision<'a> {
    /// Strength of each region.
    pub strengths: &'a [Strength],
    /// Region of each tetrahedron. A node between regions fails where the mean over its tetrahedra of one of them does, or the force at
    /// the front of a crack exceeds the strength of all.
    pub regions: &'a [u32],
    /// By what strength is multiplied, for each point of the mesh, as from [`Weibull::factors`](super::Weibull::factors); infinite
    /// where no crack may start.
    pub factors: &'a [f64],
    /// Current positions of the nodes of the cracked mesh, m.
    pub positions: &'a [Vector3],
    /// Current stresses of the tetrahedra.
    pub stresses: &'a [ElementStress],
}

impl NodalDecision<'_> {
    /// Lengths of the lists, and factors.
    pub(super) fn check(&self, cracked: &CrackedMesh) -> Result<(), FemError> {
        let (tets, points) = (cracked.tets().len(), cracked.points());
        // Nodes that cracks added come after all points.
        let original = points
            .iter()
            .zip(0..)
            .take_while(|(point, node)| *point == node)
            .count();
        for (what, given, wanted) in [
            ("regions of tetrahedra", self.regions.len(), tets),
            ("stresses of tetrahedra", self.stresses.len(), tets),
            ("positions of nodes", self.positions.len(), points.len()),
            ("factors of points", self.factors.len(), original),
        ] {
            if given != wanted {
                return Err(FemError::WrongLength {
                    what,
                    given,
                    wanted,
                });
            }
        }
        match self.factors.iter().find(|f| f.is_nan() || **f <= 0.0) {
            Some(&factor) => check("factor of strength", factor, false, "positive"),
            None => Ok(()),
        }
    }
}
