//! Sphere and ellipsoid as subdivided icosahedra.

use super::family::family;
use crate::{MeshError, Point3, Polyhedron};
use std::collections::BTreeMap;

family! {
    /// A sphere as an icosahedron whose triangles are split in four `level` times, with all vertices
    /// on the sphere.
    ///
    /// The program `femdem` takes rigid bodies of this family that are named without a level, `sphere`, as exact balls,
    /// and those with one, as `sphere:level=3`, as polyhedra.
    ///
    /// The polyhedron lies inside the sphere. Its volume falls short of the sphere's, and its faces
    /// reach at most so far below the sphere (as parts of the volume and of the radius):
    ///
    /// | level | faces | volume | distance |
    /// |---|---|---|---|
    /// | 0 | 20 | 39.5 % | 20.6 % |
    /// | 1 | 80 | 12.7 % | 6.5 % |
    /// | 2 | 320 | 3.4 % | 1.8 % |
    /// | 3 | 1,280 | 0.86 % | 0.46 % |
    /// | 4 | 5,120 | 0.22 % | 0.12 % |
    /// | 5 | 20,480 | 0.054 % | 0.029 % |
    Sphere = "sphere", "sphere; given a level, a subdivided icosahedron", size: "the diameter of the sphere" {
        /// How often the triangles of the icosahedron are split in four.
        level: u32 = 3, in 0, 5;
    }
}

family! {
    /// An ellipsoid with semi-axes in the ratio 1 : `width` : `height` along x, y and z: a
    /// [`Sphere`], stretched.
    ///
    /// The error of the volume is that of the sphere; that of the distance is at most the sphere's,
    /// taken as part of the longest semi-axis.
    Ellipsoid = "ellipsoid", "ellipsoid with its axes along x, y, z", size: "the length of the axis along x" {
        /// Length of the axis along y over that along x.
        width: f64 = 0.8, in 0.05, 20.0;
        /// Length of the axis along z over that along x.
        height: f64 = 0.6, in 0.05, 20.0;
        /// How often the triangles of the icosahedron are split in four.
        level: u32 = 3, in 0, 5;
    }
}

impl Sphere {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let (vertices, faces) = icosphere(self.level);
        Polyhedron::new(vertices.iter().map(|v| v * 0.5).collect(), faces)
    }
}

impl Ellipsoid {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let (vertices, faces) = icosphere(self.level);
        let stretched = vertices
            .iter()
            .map(|v| Point3::new(v.x, self.width * v.y, self.height * v.z) * 0.5)
            .collect();
        Polyhedron::new(stretched, faces)
    }
}

/// Vertices on the unit sphere and triangles of the icosahedron, split `level` times.
///
/// The icosahedron has the coordinate planes as planes of symmetry, and so have its subdivisions.
pub(super) fn icosphere(level: u32) -> (Vec<Point3>, Vec<Vec<u32>>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let (short, long) = {
        let norm = golden.hypot(1.0);
        (1.0 / norm, golden / norm)
    };
    let mut vertices = Vec::new();
    for (a, b) in [
        (short, long),
        (-short, long),
        (short, -long),
        (-short, -long),
    ] {
        vertices.push(Point3::new(0.0, a, b));
        vertices.push(Point3::new(a, b, 0.0));
        vertices.push(Point3::new(b, 0.0, a));
    }
    let mut triangles = triangles_of_icosahedron(&vertices);
    for _ in 0..level {
        triangles = split(&mut vertices, &triangles);
    }
    (vertices, triangles.iter().map(|t| t.to_vec()).collect())
}

/// Triples of vertices an edge apart, counter-clockwise seen from outside.
fn triangles_of_icosahedron(vertices: &[Point3]) -> Vec<[u32; 3]> {
    let n = vertices.len() as u32;
    let at = |i: u32| vertices[i as usize].coords;
    // The edge of the unit icosahedron is 1.05, the next distance 1.70.
    let near = |i: u32, j: u32| (at(i) - at(j)).norm() < 1.3;
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in i + 1..n {
            for k in (j + 1..n).filter(|&k| near(i, j) && near(j, k) && near(i, k)) {
                let outward = at(i).dot(&at(j).cross(&at(k))) > 0.0;
                triangles.push(if outward { [i, j, k] } else { [i, k, j] });
            }
        }
    }
    triangles
}

/// Splits triangles in four at the middles of their sides, pushed out to the unit sphere.
fn split(vertices: &mut Vec<Point3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            let sum = vertices[a as usize].coords + vertices[b as usize].coords;
            vertices.push(Point3::from(sum.normalize()));
            vertices.len() as u32 - 1
        })
    };
    let mut split = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        split.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    split
}
