//! The stress of a node.

use super::inputs::NodalDecision;
use super::strength::Strength;
use crate::error::{FemError, check};
use femdem_mesh::tet::CrackedMesh;
use femdem_mesh::{Matrix3, Vector3};

/// The stress at a node and how much of the strength it uses up.
pub(super) struct NodeStress<'a> {
    pub ratio: f64,
    pub cauchy: Matrix3,
    pub strength: &'a Strength,
}

/// Volume of a tetrahedron, m^3.
pub(super) fn volume(corners: [u32; 4], positions: &[Vector3]) -> Result<f64, FemError> {
    let [a, b, c, d] = corners.map(|node| positions[node as usize]);
    let volume = (b - a).dot(&(c - a).cross(&(d - a))) / 6.0;
    let allowed = "positive: the body has turned a tetrahedron inside out";
    check("volume of a tetrahedron", volume, volume > 0.0, allowed)?;
    Ok(volume)
}

impl<'a> NodalDecision<'a> {
    /// The mean over the tetrahedra of each region around a node; that of the region nearest to failure is returned. `None`
    /// for a node without tetrahedra.
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
        Ok(worst)
    }
}
