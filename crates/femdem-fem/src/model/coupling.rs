//! Lumped masses, and the bound of an element's frequency for the masses assigned to it.

use super::DeformableModel;
use super::comparison::Comparison;
use crate::element::{T4, T10, Table, lumped};
use crate::material::Material;
use femdem_mesh::{Matrix3, Vector3};

/// Iterations of the distribution of nodal masses to elements. The bound never rises from one to the next;
/// after 40 it is within 1 % of its limit for meshes of usual shapes.
const ROUNDS: usize = 40;

impl DeformableModel {
    /// Computes masses, and the factors of the frequencies that do not depend on the materials.
    ///
    /// The frequency of the body is not higher than that of its worst element (B. M. Irons and G. Treharne,
    /// 1972), for any distribution of the nodal masses to the elements, as the theorem only needs the sum. A
    /// flat element gets a lower frequency with a part of its neighbours' masses.
    pub(super) fn lump(&mut self) {
        let shares = lumped(self.element);
        self.masses.fill(0.0);
        let per_element = self.connectivity.chunks_exact(self.element.node_count());
        for (e, nodes) in per_element.enumerate() {
            let mass = self.density(e) * self.volumes[e];
            for (&node, share) in nodes.iter().zip(shares) {
                self.masses[node as usize] += mass * share;
            }
        }
        let own = self.couplings_by(|_| shares);
        self.comparison = if self.element.is_quadratic() {
            Comparison::new(self, &T10)
        } else {
            Comparison::new(self, &T4)
        };
        self.weights = self.best_weights();
        let given = self.shared();
        let width = shares.len();
        let shared = self.couplings_by(|e| &given[width * e..width * (e + 1)]);
        let worst = |couplings: &[f64]| {
            let each = couplings.iter().enumerate();
            each.map(|(e, t)| self.modulus(e) * t).fold(0.0, f64::max)
        };
        let better = worst(&shared) < worst(&own);
        self.couplings = if better { shared } else { own };
    }

    /// t of every element, m/kg, for the given shares of the nodes in its mass.
    fn couplings_by<'a>(&self, shares: impl Fn(usize) -> &'a [f64]) -> Vec<f64> {
        let inverses = self.inverses.iter().enumerate();
        inverses
            .map(|(e, inverse)| {
                let unit = if self.element.is_quadratic() {
                    coupling(&T10, inverse, shares(e))
                } else {
                    coupling(&T4, inverse, shares(e))
                };
                unit / self.density(e)
            })
            .collect()
    }

    /// Stiffness of an element relative to the others.
    pub(super) fn modulus(&self, e: usize) -> f64 {
        let modulus = self.material(e).wave_modulus();
        let usable = modulus > 0.0 && modulus.is_finite();
        if usable { modulus } else { 1.0 }
    }

    /// The weights of the nodes that are the best for [`NodalBound`](super::comparison::NodalBound) without
    /// contact.
    fn best_weights(&self) -> Vec<f64> {
        let mut x = vec![1.0; self.masses.len()];
        let mut next = Vec::new();
        for _ in 0..ROUNDS {
            self.comparison.apply(&self.connectivity, &x, &mut next);
            let mut largest = 0.0_f64;
            for (y, m) in next.iter_mut().zip(&self.masses) {
                *y /= m;
                largest = largest.max(*y);
            }
            // Half of the old weight, so that the iteration does not oscillate.
            for (x, y) in x.iter_mut().zip(&next) {
                *x = 0.5 * (*x + y / largest);
            }
        }
        x
    }

    /// Shares of the masses of the nodes for all elements, over the elements' own masses.
    ///
    /// With the matrix C = sum_e s_e (x) s_e of [`Comparison`], the bound of the worst element is lowest when
    /// m_ea is proportional to s_ea sum_b s_eb x_b, where x is the eigenvector of M^-1 C for the largest
    /// eigenvalue. Any positive x gives a bound; under power iteration it does not rise (L. Collatz, 1942).
    fn shared(&self) -> Vec<f64> {
        let x = &self.weights;
        let mut sums = Vec::new();
        self.comparison.apply(&self.connectivity, x, &mut sums);
        let width = self.element.node_count();
        let elements = self.connectivity.chunks_exact(width);
        let mut shares = Vec::with_capacity(self.connectivity.len());
        for (e, (nodes, s)) in elements
            .zip(self.comparison.sizes.chunks_exact(width))
            .enumerate()
        {
            let sum: f64 = nodes.iter().zip(s).map(|(&a, s)| s * x[a as usize]).sum();
            let mass = self.density(e) * self.volumes[e];
            for (&a, s) in nodes.iter().zip(s) {
                let a = a as usize;
                shares.push(self.masses[a] * s * sum / (sums[a] * mass));
            }
        }
        shares
    }
}

/// A number t, 1/m^2, such that sum_q w_q |G_q|^2 <= t sum_a (m_a/rho) |u_a|^2 for the gradients G_q
/// of every nodal field u, in the nuclear norm |G| = min (sum |u_i| |B_i|) over G = sum u_i (x) B_i,
/// where the nodes have the parts `shares` of the element's mass.
///
/// A law of stiffness bound c has G : dP/dF : G <= c |G|^2, so omega^2 <= c t/rho. The
/// nuclear norm is the largest R : G over rotations R, hence with the masses taken into the
/// gradients b_qa = grad N_a sqrt(w_q/m_a) the sum is at most the largest eigenvalue of the matrix
/// over points of max_R R : sum_a b_qa (x) b_ra, the nuclear norm of that sum. For one point it is
/// sum_a 1/(shares_a h_a^2), with the heights h_a.
fn coupling<const N: usize, const Q: usize>(
    table: &Table<N, Q>,
    inverse: &Matrix3,
    shares: &[f64],
) -> f64 {
    let gradients: [[Vector3; N]; Q] = std::array::from_fn(|q| table.shape_gradients(q, inverse));
    let mut largest = 0.0_f64;
    // Row sums bound the largest eigenvalue of a matrix of non-negative entries; by the symmetry of the
    // points they hardly differ.
    for g in &gradients {
        let row = gradients.iter().map(|h| {
            let sum = (0..N).fold(Matrix3::zeros(), |sum, a| {
                sum + g[a] * h[a].transpose() / shares[a]
            });
            nuclear_norm(&sum) / Q as f64
        });
        largest = largest.max(row.sum());
    }
    largest
}

/// Sum of the singular values.
fn nuclear_norm(m: &Matrix3) -> f64 {
    m.singular_values().sum()
}
