//! The stress of a node.

use super::inputs::NodalDecision;
use super::star::{Division, Star, volume};
use super::strength::Strength;
use crate::error::FemError;
use femdem_mesh::Matrix3;
use femdem_mesh::tet::CrackedMesh;

/// The stress at a node.
pub(super) struct NodeStress<'a> {
    /// How much of the strength it uses up, or the force between two halves of the star.
    pub ratio: f64,
    pub cauchy: Matrix3,
    pub strength: &'a Strength,
}

impl<'a> NodalDecision<'a> {
    /// The mean over the tetrahedra of each region around a node; that of the region nearest to failure is returned, with the ratio
    /// of the force across if that is more. `None` for a node without tetrahedra.
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
                    ratio,
                    cauchy,
                    strength,
                });
            }
        }
        if let Some(worst) = &mut worst {
            let across = self.across(cracked, node, worst)? / factor;
            worst.ratio = worst.ratio.max(across);
        }
        Ok(worst)
    }

    /// How much of the strength the force between two halves of the star of a node uses up: of the strongest region there.
    fn across(
        &self,
        cracked: &CrackedMesh,
        node: u32,
        stress: &NodeStress,
    ) -> Result<f64, FemError> {
        let star = Star::new(cracked, node, self.positions, self.stresses)?;
        let planes = stress.strength.planes(&stress.cauchy);
        let divisions = planes.normals().iter();
        let divisions = divisions.filter_map(|normal| star.divide(normal, false));
        let regions = cracked
            .around(node)
            .iter()
            .map(|&t| self.regions[t as usize]);
        let ratio = |division: Division| {
            let of = |region: u32| self.strengths[region as usize].ratio_across(&division.traction);
            regions.clone().map(of).fold(f64::INFINITY, f64::min)
        };
        Ok(divisions.map(ratio).fold(f64::NEG_INFINITY, f64::max))
    }
}
