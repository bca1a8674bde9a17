//! The stress of a node.

use super::inputs::NodalDecision;
use super::star::{Division, Star, is_on_cut, volume};
use super::strength::Strength;
use crate::error::FemError;
use femdem_mesh::Matrix3;
use femdem_mesh::tet::CrackedMesh;

/// The stress at a node.
pub(super) struct NodeStress<'a> {
    /// How much of the strength it uses up: the mean stress, and that or, on a cut facet, the force between two halves of the star,
    /// whichever is more.
    pub mean: f64,
    /// See `mean`.
    pub ratio: f64,
    pub cauchy: Matrix3,
    pub strength: &'a Strength,
}

impl<'a> NodalDecision<'a> {
    /// The mean over the tetrahedra of each region around a node; that of the region nearest to failure is returned, with the ratio
    /// of the force at the front of a crack if that is more. `None` for a node without tetrahedra.
    pub(super) fn node(
        &self,
        cracked: &CrackedMesh,
        node: u32,
    ) -> Result<Option<NodeStress<'a>>, FemError> {
        let around = cracked.around(node);
        let factor = self.factors[cracked.points()[node as usize] as usize];
        let region_of = |t: u32| self.regions[t as usize];
        let mut worst: Option<NodeStress> = None;
        for (i, &first) in around.iter().enumerate() {
            let region = region_of(first);
            if around[..i].iter().any(|&t| region_of(t) == region) {
                continue;
            }
            let (mut sum, mut total) = (Matrix3::zeros(), 0.0);
            for &t in around[i..].iter().filter(|&&t| region_of(t) == region) {
                let volume = volume(cracked.tets()[t as usize], self.positions)?;
                sum += self.stresses[t as usize].cauchy * volume;
                total += volume;
            }
            let (cauchy, strength) = (sum / total, &self.strengths[region as usize]);
            let ratio = strength.ratio(&cauchy) / factor;
            if worst.as_ref().is_none_or(|worst| ratio > worst.ratio) {
                worst = Some(NodeStress {
                    mean: ratio,
                    ratio,
                    cauchy,
                    strength,
                });
            }
        }
        if let Some(worst) = &mut worst
            && is_on_cut(cracked, node)
        {
            let star = Star::new(cracked, node, self.positions, self.stresses)?;
            let planes = worst.strength.planes(&worst.cauchy);
            for normal in planes.normals() {
                if let Some(division) = star.divide(normal, false) {
                    worst.ratio = worst.ratio.max(self.across(cracked, node, &division));
                }
            }
        }
        Ok(worst)
    }

    /// How much of the strength the force between two halves of the star of a node uses up: of the strongest region there.
    pub(super) fn across(&self, cracked: &CrackedMesh, node: u32, division: &Division) -> f64 {
        let factor = self.factors[cracked.points()[node as usize] as usize];
        let of = |&t: &u32| {
            let strength = &self.strengths[self.regions[t as usize] as usize];
            strength.ratio_across(&division.traction) / factor
        };
        let around = cracked.around(node).iter();
        around.map(of).fold(f64::INFINITY, f64::min)
    }
}
