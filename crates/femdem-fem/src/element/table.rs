//! Shape functions: their derivatives at the integration points.

use femdem_mesh::tet::MID_EDGES;
use femdem_mesh::{Matrix3, Vector3};

/// Derivatives of `N` shape functions by the barycentric coordinates of corners 1 to 3, at `Q`
/// points of equal weight.
#[derive(Debug)]
pub(crate) struct Table<const N: usize, const Q: usize> {
    derivatives: [[[f64; 3]; N]; Q],
}

/// Linear tetrahedron.
pub(crate) static T4: Table<4, 1> = Table {
    derivatives: [[by_corner(0), by_corner(1), by_corner(2), by_corner(3)]],
};

/// Quadratic tetrahedron with the rule of four points of degree 2 (P. Keast, Comput. Methods Appl.
/// Mech. Engrg. 55 (1986) 339-348).
pub(crate) static T10: Table<10, 4> = Table {
    derivatives: [at_point(0), at_point(1), at_point(2), at_point(3)],
};

/// Barycentric coordinate of a point's own corner, (5 + 3 sqrt 5)/20, and of the others.
const NEAR: f64 = 0.585_410_196_624_968_5;
const FAR: f64 = 0.138_196_601_125_010_5;

/// Derivative of the barycentric coordinate of a corner.
const fn by_corner(corner: usize) -> [f64; 3] {
    match corner {
        0 => [-1.0, -1.0, -1.0],
        1 => [1.0, 0.0, 0.0],
        2 => [0.0, 1.0, 0.0],
        _ => [0.0, 0.0, 1.0],
    }
}

/// N = L (2 L - 1) at corners, 4 L_i L_j in the middles of edges.
const fn at_point(point: usize) -> [[f64; 3]; 10] {
    let mut derivatives = [[0.0; 3]; 10];
    let mut node = 0;
    while node < 10 {
        let mut axis = 0;
        while axis < 3 {
            derivatives[node][axis] = if node < 4 {
                (4.0 * barycentric(point, node) - 1.0) * by_corner(node)[axis]
            } else {
                let [i, j] = MID_EDGES[node - 4];
                4.0 * (barycentric(point, i) * by_corner(j)[axis]
                    + barycentric(point, j) * by_corner(i)[axis])
            };
            axis += 1;
        }
        node += 1;
    }
    derivatives
}

const fn barycentric(point: usize, corner: usize) -> f64 {
    if point == corner { NEAR } else { FAR }
}

impl<const N: usize, const Q: usize> Table<N, Q> {
    /// The gradient of a nodal field at every point: sum of values (x) grad N. `inverse` has the
    /// gradients of the barycentric coordinates of corners 1 to 3 as its rows.
    #[inline]
    pub fn gradients(&self, values: &[Vector3; N], inverse: &Matrix3) -> [Matrix3; Q] {
        // The derivatives sum to zero; differences preserve the digits of bodies far from the origin.
        let from_first: [Vector3; N] = std::array::from_fn(|a| values[a] - values[0]);
        self.derivatives.each_ref().map(|derivatives| {
            let mut local = Matrix3::zeros();
            for (value, d) in from_first.iter().zip(derivatives).skip(1) {
                for (axis, d) in d.iter().enumerate() {
                    for i in 0..3 {
                        local[(i, axis)] += value[i] * d;
                    }
                }
            }
            local * inverse
        })
    }

    /// Adds to `forces` the nodal forces of the stress `piola` at point `q`, times `weight`: weight * piola *
    /// grad N.
    #[inline]
    pub fn add_stress(
        &self,
        q: usize,
        piola: &Matrix3,
        weight: f64,
        inverse: &Matrix3,
        forces: &mut [Vector3; N],
    ) {
        let local = piola * inverse.transpose() * weight;
        let mut sum = Vector3::zeros();
        for (force, d) in forces.iter_mut().zip(&self.derivatives[q]).skip(1) {
            let part = local.column(0) * d[0] + local.column(1) * d[1] + local.column(2) * d[2];
            *force += part;
            sum += part;
        }
        // The forces of an element sum to zero up to rounding.
        forces[0] -= sum;
    }

    /// grad N of every node at point `q`.
    pub fn shape_gradients(&self, q: usize, inverse: &Matrix3) -> [Vector3; N] {
        self.derivatives[q].map(|d| inverse.tr_mul(&Vector3::from(d)))
    }
}
