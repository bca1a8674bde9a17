//! Which nodes can fail: those beside a tetrahedron whose own stress nearly does.

use super::inputs::NodalDecision;
use super::strength::Limits;
use crate::error::FemError;
use femdem_mesh::tet::CrackedMesh;

/// Nodes are looked at if a tetrahedron around them uses up this part of their strength. Anything up to 1 leaves out
/// no node whose mean stress fails.
const WATCHED: f64 = 0.9;

/// What the gate found.
pub(super) struct Gate {
    /// Per node whether it has to be looked at.
    pub watched: Vec<bool>,
    /// An upper bound of the ratios of the mean stress of the others.
    pub highest: f64,
}

impl Gate {
    /// One bound per tetrahedron, a closer one if that is not low, and its nodes if it is above all before it. The ratio of a mean is at most the largest
    /// of the ratios, since it is a convex function of stress.
    pub(super) fn new(state: &NodalDecision, cracked: &CrackedMesh) -> Result<Self, FemError> {
        let limits: Vec<Limits> = state.strengths.iter().map(|s| s.limits()).collect();
        let lowest = state.factors.iter().copied().fold(f64::INFINITY, f64::min);
        let mut watched = vec![false; cracked.points().len()];
        let mut highest = 0.0_f64;
        let mut quiet = 0.0;
        let all = state.stresses.iter().zip(state.regions).enumerate();
        for (t, (stress, &region)) in all {
            let Some(limits) = limits.get(region as usize) else {
                return Err(FemError::NoSuch {
                    what: "region",
                    index: region as usize,
                    count: limits.len(),
                });
            };
            let mut bound = limits.rough_bound(&stress.cauchy);
            if bound <= quiet {
                continue;
            }
            if bound >= WATCHED * lowest {
                bound = limits.bound(&stress.cauchy);
                if bound <= quiet {
                    continue;
                }
            }
            if !bound.is_finite() {
                return Err(FemError::StressNotFinite { element: t });
            }
            for &node in &cracked.tets()[t] {
                let ratio = bound / state.factors[cracked.points()[node as usize] as usize];
                if ratio >= WATCHED {
                    watched[node as usize] = true;
                } else {
                    highest = highest.max(ratio);
                }
            }
            quiet = highest.min(WATCHED) * lowest;
        }
        Ok(Self { watched, highest })
    }
}
