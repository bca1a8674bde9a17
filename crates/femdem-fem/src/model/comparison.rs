//! A matrix that bounds the stiffness of the elements.

use super::DeformableModel;
use super::forces::check_length;
use crate::element::{ElementFailure, Table};
use femdem_mesh::Vector3;

/// A matrix without negative entries that bounds the stiffness of the elements: since |sum_a u_a (x) grad
/// N_a| <= sum_a |u_a| |grad N_a|, for all nodal fields u
///
/// u.K u <= c sum_ab |u_a| C_ab |u_b|, C_ab = sum_e s_ea s_eb, s_ea^2 = E_e sum_q w_q |grad N_a|^2,
///
/// with the wave moduli E_e, where c is the largest present stiffness of an element over its wave modulus.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Comparison {
    /// s_ea, in the order of the connectivity, (N/m)^(1/2).
    pub sizes: Vec<f64>,
    /// Nodes of an element.
    width: usize,
}

impl Comparison {
    pub fn new<const N: usize, const Q: usize>(
        model: &DeformableModel,
        table: &Table<N, Q>,
    ) -> Self {
        let mut sizes = Vec::with_capacity(model.connectivity.len());
        for (e, inverse) in model.inverses.iter().enumerate() {
            let gradients: [[Vector3; N]; Q] =
                std::array::from_fn(|q| table.shape_gradients(q, inverse));
            let weight = model.modulus(e) * model.volumes[e] / Q as f64;
            sizes.extend((0..N).map(|a| {
                let squares = gradients.iter().map(|g| g[a].norm_squared());
                (weight * squares.sum::<f64>()).sqrt()
            }));
        }
        Self { sizes, width: N }
    }

    /// sum_b C_ab x_b of all nodes.
    pub fn apply(&self, connectivity: &[u32], x: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.resize(x.len(), 0.0);
        let elements = connectivity.chunks_exact(self.width);
        for (nodes, sizes) in elements.zip(self.sizes.chunks_exact(self.width)) {
            let sum: f64 = nodes
                .iter()
                .zip(sizes)
                .map(|(&a, s)| s * x[a as usize])
                .sum();
            for (&a, s) in nodes.iter().zip(sizes) {
                out[a as usize] += s * sum;
            }
        }
    }
}

impl DeformableModel {
    /// sum_b C_ab x_b for all nodes, with a matrix without negative entries that bounds the stiffness of the
    /// elements: u.K u <= c sum_ab |u_a| C_ab |u_b| for all nodal fields u, c the present stiffening of the
    /// [`FrequencyBound`](super::FrequencyBound). x and `out` have a value for each node; C x is in N/m.
    ///
    /// # Errors
    /// [`ElementFailure::Length`] if `x` has another length.
    pub fn apply_stiffness_bound(
        &self,
        x: &[f64],
        out: &mut Vec<f64>,
    ) -> Result<(), ElementFailure> {
        check_length("x", x.len(), self.nodes.len())?;
        self.comparison.apply(&self.connectivity, x, out);
        Ok(())
    }

    /// Positive weights x of the nodes for which the largest of (C x)_a/(m_a x_a), times the stiffening a bound of
    /// the squared frequencies of the elements (L. Collatz, 1942), is least.
    pub fn frequency_weights(&self) -> &[f64] {
        &self.weights
    }
}
