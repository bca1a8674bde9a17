//! Box, and cube with rounded edges.

use super::family::family;
use crate::{MeshError, Point3, Polyhedron, Vector3, convex_hull};

family! {
    /// A box with edges in the ratio 1 : `width` : `height` along x, y and z.
    Cuboid = "box", "rectangular box", size: "the length of the edges along x" {
        /// Edge along y over that along x.
        width: f64 = 0.7, in 0.01, 100.0;
        /// Edge along z over that along x.
        height: f64 = 0.5, in 0.01, 100.0;
    }
}

family! {
    /// A cube whose edges and corners are rounded: a smaller cube with a sphere rolled around it.
    ///
    /// The roundings are polygonal with vertices on the true surface, so the body lies inside it:
    /// with r the radius and n the segments by up to r / n^2.
    RoundedCube = "rounded_cube", "cube with rounded edges and corners",
    size: "the distance of opposite faces" {
        /// Radius of the rounding over the distance of opposite faces.
        radius: f64 = 0.1, in 0.005, 0.45;
        /// Facets across the rounding of an edge.
        segments: u32 = 4, in 1, 16;
    }
}

/// All eight choices of signs.
fn octants() -> impl Iterator<Item = Vector3> {
    let signs = [-1.0, 1.0];
    signs.into_iter().flat_map(move |x| {
        signs
            .into_iter()
            .flat_map(move |y| signs.map(|z| Vector3::new(x, y, z)))
    })
}

impl Cuboid {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let half = Vector3::new(0.5, 0.5 * self.width, 0.5 * self.height);
        let corners: Vec<Point3> = octants()
            .map(|signs| Point3::from(signs.component_mul(&half)))
            .collect();
        convex_hull(&corners)
    }
}

impl RoundedCube {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let n = self.segments;
        // Along the sides of the octant's triangle the angles are equal.
        let arc = |i: u32| (f64::from(i) / f64::from(n) * std::f64::consts::FRAC_PI_2).sin();
        let mut directions = Vec::new();
        for i in 0..=n {
            for j in 0..=n - i {
                let k = n - i - j;
                directions.push(Vector3::new(arc(i), arc(j), arc(k)).normalize());
            }
        }
        let core = Vector3::repeat(0.5 - self.radius);
        let points: Vec<Point3> = octants()
            .flat_map(|signs| {
                let corner = |d: &Vector3| (core + d * self.radius).component_mul(&signs);
                directions
                    .iter()
                    .map(|d| Point3::from(corner(d)))
                    .collect::<Vec<_>>()
            })
            .collect();
        convex_hull(&points)
    }
}
