//! Small strain: the stresses and forces of a body near its reference state.

use super::DeformableModel;
use crate::element::{Element, T4, T10, Table};
use crate::error::{FemError, check};
use crate::material::{Deformation, Material, Tangent};
use femdem_mesh::nalgebra::SVector;
use femdem_mesh::{Matrix3, Vector3};

impl DeformableModel {
    /// Stiffness of each region's material in the reference state.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] for elements other than [`Element::T4`] and [`Element::T10`], whose points do not act by
    /// themselves, and [`FemError::Element`] for a law without a tangent.
    pub(crate) fn stiffness_at_rest(&self) -> Result<Vec<Tangent>, FemError> {
        check(
            "number of the element",
            f64::from(self.element as u8),
            matches!(self.element, Element::T4 | Element::T10),
            "that of T4 or of T10: the others average the change of volume",
        )?;
        let unstrained = Deformation::at_rest(Matrix3::identity());
        let law = |(r, region): (usize, &super::MaterialRegion)| {
            let history = vec![0.0; region.material.history_len()];
            let law = region.material.tangent(&unstrained, &history);
            let first = || self.region_of.iter().position(|&own| own as usize == r);
            law.ok_or_else(|| {
                self.failure(first().unwrap_or(0), &unstrained.gradient)
                    .into()
            })
        };
        self.regions.iter().enumerate().map(law).collect()
    }

    /// Stresses of all integration points, element by element, at small displacements `u` (m), sigma = C : grad u (Pa), by the
    /// stiffness at rest. Subtracts the nodal forces that balance them, integral of sigma grad N dV, from `forces` (N).
    pub(crate) fn small_stresses(
        &self,
        laws: &[Tangent],
        u: &[Vector3],
        forces: &mut [Vector3],
    ) -> Vec<Matrix3> {
        match self.element {
            Element::T10 | Element::T10Fbar => self.small_of(&T10, laws, u, forces),
            Element::T4 | Element::T4NodalPressure => self.small_of(&T4, laws, u, forces),
        }
    }

    fn small_of<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        laws: &[Tangent],
        u: &[Vector3],
        forces: &mut [Vector3],
    ) -> Vec<Matrix3> {
        let mut stresses = Vec::with_capacity(Q * self.volumes.len());
        let (elements, _) = self.connectivity.as_chunks::<N>();
        for (e, nodes) in elements.iter().enumerate() {
            let (law, inverse) = (&laws[self.region_of[e] as usize], &self.inverses[e]);
            let mut own = [Vector3::zeros(); N];
            let gradients = table.gradients(&nodes.map(|i| u[i as usize]), inverse);
            for (q, gradient) in gradients.iter().enumerate() {
                // Rows of a tangent are those of the transposed column order of a matrix.
                let flat = SVector::<f64, 9>::from_column_slice(gradient.transpose().as_slice());
                let stress = Matrix3::from_row_slice((law * flat).as_slice());
                table.add_stress(q, &stress, -self.volumes[e] / Q as f64, inverse, &mut own);
                stresses.push(stress);
            }
            for (&node, force) in nodes.iter().zip(&own) {
                forces[node as usize] += force;
            }
        }
        stresses
    }
}
