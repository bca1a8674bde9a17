//! Which facets are cut.

use super::gate::Gate;
use super::inputs::NodalDecision;
use super::node::NodeStress;
use super::star::{Star, is_on_cut};
use super::strength::FractureMode;
use crate::error::FemError;
use femdem_mesh::Vector3;
use femdem_mesh::tet::{CrackedMesh, Split};

/// The ratio from which a node fails beside an open crack without lying on a cut facet, or without a tetrahedron clearly
/// on one side of the plane.
const BESIDE: f64 = 1.15;

/// A facet that a decision cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Its number in [`CrackedMesh::facets`].
    pub facet: u32,
    /// By which criterion it is cut.
    pub mode: FractureMode,
    /// Unit normal, of either sign, of the mean plane of the facets that divide the star of the node, Σ A n, in the positions
    /// given: a facet of normal n has the part |n·m| of its area in that plane of normal m, and a zigzag that does not overhang
    /// has the area of the plane.
    pub plane: Vector3,
}

/// What a decision found and did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decision {
    /// The facets it cut, in the order of the nodes that failed.
    pub cuts: Vec<Cut>,
    /// The nodes that were split; new ones lie where the old ones do.
    pub splits: Vec<Split>,
    /// Not below the largest ratio of stress to strength of a node before the cuts, and at least 0. It is that ratio, or that of the
    /// force at the front of a crack, if 0.9 or more. Below, it is a cheap bound, up to several times too large under compression; for the ratios themselves see
    /// [`NodalDecision::ratios`].
    pub highest: f64,
}

impl NodalDecision<'_> {
    /// Cuts facets where nodes fail, and splits the nodes.
    ///
    /// # Errors
    ///
    /// Nothing is cut if a list has the wrong length ([`FemError::WrongLength`]), a region has no strength
    /// ([`FemError::NoSuch`]), a stress is not finite ([`FemError::StressNotFinite`]), or a factor or the volume of a tetrahedron near
    /// failure is not positive ([`FemError::Parameter`]).
    pub fn decide(&self, cracked: &mut CrackedMesh) -> Result<Decision, FemError> {
        self.check(cracked)?;
        let Gate { watched, highest } = Gate::new(self, cracked)?;
        let mut decision = Decision {
            highest,
            ..Decision::default()
        };
        let mut failed = Vec::new();
        for node in (0..).zip(watched).filter_map(|(node, w)| w.then_some(node)) {
            if let Some(stress) = self.node(cracked, node)? {
                decision.highest = decision.highest.max(stress.ratio);
                if stress.ratio >= 1.0 {
                    failed.push((node, stress));
                }
            }
        }
        if !failed.is_empty() {
            self.open(cracked, failed, &mut decision)?;
        }
        Ok(decision)
    }

    /// The ratio of stress, or at the front of a crack of force, to strength of every node of the cracked mesh; 1 where it fails.
    ///
    /// # Errors
    ///
    /// As [`decide`](Self::decide).
    pub fn ratios(&self, cracked: &CrackedMesh) -> Result<Vec<f64>, FemError> {
        self.check(cracked)?;
        Gate::new(self, cracked)?;
        let nodes = 0..cracked.points().len() as u32;
        let ratio = |node| Ok(self.node(cracked, node)?.map_or(0.0, |stress| stress.ratio));
        nodes.map(ratio).collect()
    }

    /// Divides the stars of nodes that fail.
    fn open(
        &self,
        cracked: &mut CrackedMesh,
        failed: Vec<(u32, NodeStress)>,
        decision: &mut Decision,
    ) -> Result<(), FemError> {
        let mut failed: Vec<_> = failed
            .into_iter()
            .map(|(node, stress)| (node, stress, cracked.around(node).len()))
            .collect();
        failed.sort_by(|(i, a, _), (j, b, _)| b.ratio.total_cmp(&a.ratio).then(i.cmp(j)));
        let mut positions = self.positions.to_vec();
        let mut is_open = vec![false; self.factors.len()];
        for (&point, node) in cracked.points().iter().zip(0..) {
            is_open[point as usize] |= point != node;
        }
        for (node, stress, count) in failed {
            // A node that the cuts of others have split no longer has this stress.
            if cracked.around(node).len() != count {
                continue;
            }
            let star = Star::new(cracked, node, &positions, self.stresses)?;
            let point = |i: u32| cracked.points()[i as usize] as usize;
            let mut corners = cracked.around(node).iter();
            let mut is_beside = || {
                corners.any(|&t| {
                    cracked.tets()[t as usize]
                        .iter()
                        .any(|&i| is_open[point(i)])
                })
            };
            let is_doubtful = stress.ratio < BESIDE;
            if is_doubtful && !is_on_cut(cracked, node) && is_beside() {
                continue;
            }
            let planes = stress.strength.planes(&stress.cauchy);
            let divisions = planes
                .normals()
                .iter()
                .filter_map(|n| star.divide(n, !is_doubtful));
            // Where the mean does not fail, the plane whose force does.
            let divisions =
                divisions.filter(|d| stress.mean >= 1.0 || self.across(cracked, node, d) >= 1.0);
            let Some(best) = divisions.min_by(|a, b| a.cost.total_cmp(&b.cost)) else {
                continue;
            };
            let mode = planes.mode();
            decision.cuts.extend(best.facets.iter().map(|&facet| Cut {
                facet,
                mode,
                plane: best.normal,
            }));
            for split in cracked.cut(&best.facets)? {
                is_open[cracked.points()[split.node as usize] as usize] = true;
                positions.push(positions[split.node as usize]);
                decision.splits.push(split);
            }
        }
        Ok(())
    }
}
