//! Superquadrics, as used in superquadric discrete element codes.

use super::family::family;
use crate::{MeshError, Point3, Polyhedron, Vector3, convex_hull};

/// Terms of the equation below this part of the other are neglected.
///
/// Flat and ruled parts are then exact; otherwise the hull would have to distinguish faces that differ by
/// rounding.
/// faces that differ by rounding.
const NEGLIGIBLE: f64 = 1e-5;

family! {
    /// A superquadric: all (x, y, z) with
    /// (|x/a|^n2 + |y/b|^n2)^(n1/n2) + |z/c|^n1 <= 1.
    ///
    /// `n1` and `n2` are the two blockiness exponents of LIGGGHTS and of A. Podlozhnyuk, S. Pirker and
    /// C. Kloss, Comput. Part. Mech. 4 (2017) 101-118: n1 rounds the profile along z, n2 the section
    /// across z; n1 = n2 = 2 is an ellipsoid, n2 = 2 with a large n1 a cylinder, both large a box.
    /// They are not the roundness exponents e1 = 2/n1, e2 = 2/n2 of A. H. Barr, IEEE Comput. Graph.
    /// Appl. 1 (1981) 11-23.
    ///
    /// The body is the convex hull of points of the surface in the directions of a grid on a cube
    /// around it, symmetric in the coordinate planes. It lies inside the superquadric: with 12 cells
    /// its volume falls short by 0.7 % for n1 = n2 = 2, by 0.9 % for 4 and by 1.2 % for 20, and that
    /// falls with the square of the cells. Flat parts become single faces.
    Superquadric = "superquadric", "superquadric with the blockiness exponents n1, n2 of LIGGGHTS",
    size: "the length of the axis along x, twice the semi-axis a" {
        /// Blockiness along z, n1.
        n1: f64 = 4.0, in 2.0, 20.0;
        /// Blockiness across z, n2.
        n2: f64 = 4.0, in 2.0, 20.0;
        /// Semi-axis along y over that along x, b/a.
        width: f64 = 1.0, in 0.05, 20.0;
        /// Semi-axis along z over that along x, c/a.
        aspect: f64 = 1.0, in 0.05, 20.0;
        /// Cells along each edge of the cube of directions; even.
        cells: u32 = 12, in 2, 40;
    }
}

impl Superquadric {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        // An even number puts points on the axes, so that the size is met.
        let n = 2 * self.cells.div_ceil(2);
        // Equal angles, not equal steps on the cube's face.
        let step = |i: u32| {
            let middle = f64::from(i) - 0.5 * f64::from(n);
            (middle / f64::from(n) * std::f64::consts::FRAC_PI_2).tan()
        };
        let mut points = Vec::new();
        for i in 0..=n {
            for j in 0..=n {
                for k in 0..=n {
                    if [i, j, k].iter().any(|&index| index == 0 || index == n) {
                        let direction = Vector3::new(step(i), step(j), step(k));
                        points.push(Point3::from(direction / self.gauge(direction)));
                    }
                }
            }
        }
        // The hull is taken with semi-axes of 1, where it resolves all directions alike; then it is stretched.
        let body = convex_hull(&points)?;
        let semi_axes = Vector3::new(0.5, 0.5 * self.width, 0.5 * self.aspect);
        let stretched = body
            .vertices()
            .iter()
            .map(|v| Point3::from(v.coords.component_mul(&semi_axes)))
            .collect();
        Polyhedron::new(stretched, body.faces().map(<[u32]>::to_vec).collect())
    }

    /// (left side of the equation)^(1/n1), in units of the semi-axes, without negligible terms.
    fn gauge(&self, direction: Vector3) -> f64 {
        let [x, y, z] = [direction.x, direction.y, direction.z].map(f64::abs);
        let (wide, narrow) = (x.max(y), x.min(y));
        let across_share = 1.0 / (1.0 + (z / wide).powf(self.n1));
        let across = norm(wide, narrow, self.n2, across_share);
        norm(across.max(z), across.min(z), self.n1, 1.0)
    }
}

/// (large^n + small^n)^(1/n). The small term is left out if it is negligible in the larger sum in which large^n
/// has the given share.
fn norm(large: f64, small: f64, n: f64, share: f64) -> f64 {
    let term = (small / large).powf(n);
    if term * share > NEGLIGIBLE {
        large * (1.0 + term).powf(1.0 / n)
    } else {
        large
    }
}
