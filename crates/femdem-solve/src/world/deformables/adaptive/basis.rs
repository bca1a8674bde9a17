//! The static solver of a model, and what a unit force on it uses of the strength.

use super::super::Model;
use crate::error::SolveError;
use femdem_fem::DeformableModel;
use femdem_fem::ElementStress;
use femdem_fem::fracture::Strength;
use femdem_fem::free_body::{FreeBody, Solved};
use femdem_mesh::{Matrix3, Vector3};
use std::sync::Arc;

/// Most points of the skin at which unit forces are tried.
const MOST_POINTS: usize = 64;

/// A model with the factors of its stiffness.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    free: Arc<FreeBody>,
    /// Largest ratio of stress to strength under a force of 1 N on one of [`MOST_POINTS`] nodes of the skin, 1/N.
    pub unit: f64,
}

impl Basis {
    /// # Errors
    /// [`SolveError::Fem`] if the stiffness cannot be factorised.
    pub fn new(model: &Model, strength: &Strength) -> Result<Self, SolveError> {
        let free = Arc::new(FreeBody::new(Arc::new(model.model.clone()))?);
        let skin = skin(&model.model);
        let mut forces = vec![Vector3::zeros(); model.model.nodes().len()];
        let every = skin.len().div_ceil(MOST_POINTS).max(1);
        let mut unit = 0.0_f64;
        for &node in skin.iter().step_by(every) {
            // Ratios are convex and grow in proportion: that of F is at most the sum of |F_k| times those of the axes.
            let mut squares = 0.0;
            for axis in 0..3 {
                forces[node as usize][axis] = 1.0;
                let solved = free.solve(&forces)?;
                forces[node as usize] = Vector3::zeros();
                let either = |s: &Matrix3| strength.ratio(s).max(strength.ratio(&-s));
                let most = solved.corners().iter().map(either).fold(0.0, f64::max);
                squares += most * most;
            }
            unit = unit.max(squares.sqrt());
        }
        Ok(Self { free, unit })
    }

    /// Displacements and stresses under forces on nodes (N), in the coordinates of the model.
    pub fn solve(&self, forces: &[Vector3]) -> Result<Solved, SolveError> {
        Ok(self.free.solve(forces)?)
    }

    /// Inscribed diameter, m.
    pub fn reach(&self) -> f64 {
        self.free.inscribed_diameter()
    }
}

/// Nodes of the skin, ascending.
fn skin(model: &DeformableModel) -> Vec<u32> {
    let mut skin: Vec<u32> = model.mesh().skin().iter().flatten().copied().collect();
    skin.sort_unstable();
    skin.dedup();
    skin
}

/// The largest ratio of the stresses at nodes to their strength: a body fails at 1.
pub(super) fn worst(strength: &Strength, stresses: &[Matrix3], factors: &[f64]) -> f64 {
    let ratios = stresses.iter().zip(factors);
    let ratios = ratios.map(|(stress, factor)| strength.ratio(stress) / factor);
    ratios.fold(0.0, f64::max)
}

/// The stresses at the nodes of T4 elements: means over their elements, weighted by volume.
pub(super) fn nodal_means(model: &DeformableModel, stresses: &[ElementStress]) -> Vec<Matrix3> {
    let count = model.nodes().len();
    let (mut sums, mut around) = (vec![Matrix3::zeros(); count], vec![0.0; count]);
    let elements = model.mesh().tets().iter().zip(model.volumes());
    for ((tet, reference), stress) in elements.zip(stresses) {
        let volume = reference * stress.volume_ratio;
        for &node in tet {
            sums[node as usize] += stress.cauchy * volume;
            around[node as usize] += volume;
        }
    }
    let means = sums.into_iter().zip(around);
    means.map(|(sum, volume)| sum / volume).collect()
}
