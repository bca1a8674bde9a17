//! The stresses of a free body.

use crate::model::{DeformableModel, ElementStress};
use femdem_mesh::{Matrix3, Vector3};

/// Displacements and stresses of a free body.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    displacements: Vec<Vector3>,
    elements: Vec<Matrix3>,
    corners: Vec<Matrix3>,
    mean: Matrix3,
    residual: f64,
}

/// Linear functions through the four points of an element, at its corners: 1 at the own point and 0 at the others. With
/// barycentric coordinates p = (5 + 3 sqrt 5)/20 of a point's own corner and q = (5 - sqrt 5)/20 of the others they are
/// (L - q)/(p - q): (1 - q)/(p - q) at the own corner and -q/(p - q) at the others.
const OWN: f64 = 1.927_050_983_124_842_3;
const OTHER: f64 = -0.309_016_994_374_947_4;

impl Solved {
    /// From displacements (m) and the stresses (Pa) of all integration points.
    pub(super) fn new(
        model: &DeformableModel,
        displacements: Vec<Vector3>,
        points: Vec<Matrix3>,
        residual: f64,
    ) -> Self {
        let per_element = model.element().point_count();
        let count = model.mesh().points().len();
        let (mut corners, mut around) = (vec![Matrix3::zeros(); count], vec![0.0; count]);
        let (mut sum, mut whole) = (Matrix3::zeros(), 0.0);
        let mut elements = Vec::with_capacity(model.volumes().len());
        let own = points.chunks_exact(per_element);
        for ((tet, volume), points) in model.mesh().tets().iter().zip(model.volumes()).zip(own) {
            let total: Matrix3 = points.iter().sum();
            for (k, &node) in tet.iter().enumerate() {
                let stress = match points.get(k) {
                    Some(own) if per_element == 4 => total * OTHER + own * (OWN - OTHER),
                    _ => total,
                };
                corners[node as usize] += stress * *volume;
                around[node as usize] += volume;
            }
            let mean = total / per_element as f64;
            sum += mean * *volume;
            whole += volume;
            elements.push(mean);
        }
        for (stress, volume) in corners.iter_mut().zip(&around) {
            *stress /= *volume;
        }
        Self {
            displacements,
            elements,
            corners,
            mean: sum / whole,
            residual,
        }
    }

    /// Displacements of the nodes, m, without translation and rotation of the whole.
    #[must_use]
    pub fn displacements(&self) -> &[Vector3] {
        &self.displacements
    }

    /// Mean stress of every element. The volume ratio is 1, as at small strain.
    pub fn elements(&self) -> impl ExactSizeIterator<Item = ElementStress> {
        self.elements.iter().map(|cauchy| ElementStress {
            cauchy: *cauchy,
            volume_ratio: 1.0,
        })
    }

    /// Stress (Pa, tension positive) at every point of the mesh.
    #[must_use]
    pub fn corners(&self) -> &[Matrix3] {
        &self.corners
    }

    /// Mean stress of the body, Pa, tension positive: sum of f (x) (x - c) over V, with the nodal forces.
    #[must_use]
    pub fn mean(&self) -> &Matrix3 {
        &self.mean
    }

    /// Norm of the nodal forces left over, supports included, over that of the loads.
    #[must_use]
    pub fn residual(&self) -> f64 {
        self.residual
    }
}
