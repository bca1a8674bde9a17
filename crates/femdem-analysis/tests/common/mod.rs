//! Shapes, poses and random numbers shared by the tests.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, reason = "only tests use this file")]

pub mod forces;
pub mod pores;

use femdem_analysis::PosedBody;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Quaternion, Translation3};
use femdem_mesh::{Point3, Polyhedron, Pose, Rotation, Vector3};

/// A catalogue solid by its id, of the given circumscribed diameter.
pub fn solid(id: &str, diameter: f64) -> Polyhedron {
    id.parse::<CatalogueShape>()
        .unwrap()
        .polyhedron(diameter)
        .unwrap()
}

/// A cube of the given side.
pub fn cube(side: f64) -> Polyhedron {
    solid("P5", side * 3_f64.sqrt())
}

pub fn body(shape: u32, pose: Pose) -> PosedBody {
    PosedBody { shape, pose }
}

/// Unturned bodies of shape 0.
pub fn at(places: impl IntoIterator<Item = Vector3>) -> Vec<PosedBody> {
    places
        .into_iter()
        .map(|p| body(0, Pose::translation(p.x, p.y, p.z)))
        .collect()
}

/// The same bodies after a rigid motion of the whole.
pub fn moved(bodies: &[PosedBody], motion: &Pose) -> Vec<PosedBody> {
    bodies
        .iter()
        .map(|b| body(b.shape, motion * b.pose))
        .collect()
}

/// A right prism of height 1 in z over a polygon given counter-clockwise in x and y.
pub fn prism(outline: &[[f64; 2]]) -> Polyhedron {
    let n = outline.len() as u32;
    let level = |z: f64| outline.iter().map(move |p| Point3::new(p[0], p[1], z));
    let mut faces = vec![(0..n).rev().collect::<Vec<u32>>(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]));
    Polyhedron::new(level(0.0).chain(level(1.0)).collect(), faces).unwrap()
}

/// A comb of three prongs, and the four boxes it is made of.
pub fn comb() -> (Polyhedron, Vec<Polyhedron>) {
    let outline = [
        [0., 0.],
        [5., 0.],
        [5., 3.],
        [4., 3.],
        [4., 1.],
        [3., 1.],
        [3., 2.],
        [2., 2.],
        [2., 1.],
        [1., 1.],
        [1., 3.],
        [0., 3.],
    ];
    let rectangle =
        |x: [f64; 2], y: [f64; 2]| prism(&[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]);
    let boxes = vec![
        rectangle([0., 5.], [0., 1.]),
        rectangle([0., 1.], [1., 3.]),
        rectangle([2., 3.], [1., 2.]),
        rectangle([4., 5.], [1., 3.]),
    ];
    (prism(&outline), boxes)
}

/// xorshift64*: another stream than the library's own.
pub struct Random(pub u64);

impl Random {
    /// Uniform in `[low, high)`.
    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        low + (high - low) * (bits as f64 / (1_u64 << 53) as f64)
    }

    pub fn point(&mut self, min: &Point3, max: &Point3) -> Point3 {
        Point3::from([0, 1, 2].map(|k| self.uniform(min[k], max[k])))
    }

    pub fn rotation(&mut self) -> Rotation {
        loop {
            let q = Quaternion::new(
                self.uniform(-1.0, 1.0),
                self.uniform(-1.0, 1.0),
                self.uniform(-1.0, 1.0),
                self.uniform(-1.0, 1.0),
            );
            if (0.1..1.0).contains(&q.norm()) {
                return Rotation::from_quaternion(q);
            }
        }
    }

    /// Random rotation, translation within a cube of half side `reach`.
    pub fn pose(&mut self, reach: f64) -> Pose {
        let half = Point3::from([reach; 3]);
        let place = self.point(&-half, &half);
        Pose::from_parts(Translation3::from(place.coords), self.rotation())
    }
}

/// Bodies of shapes 0, 1, ... in turn, turned at random, at the nodes of a cubic lattice of `n` nodes a
/// side and the given spacing, from the origin on.
pub fn turned_lattice(random: &mut Random, shapes: u32, n: u32, spacing: f64) -> Vec<PosedBody> {
    let node = |i: u32| f64::from(i) * spacing;
    (0..n * n * n)
        .map(|i| {
            let place = Translation3::new(node(i % n), node(i / n % n), node(i / (n * n)));
            body(i % shapes, Pose::from_parts(place, random.rotation()))
        })
        .collect()
}

/// Whether a world point lies in a posed convex body, by its face planes.
pub fn holds(shape: &Polyhedron, pose: &Pose, point: &Point3) -> bool {
    let local = pose.inverse_transform_point(point);
    (0..shape.face_count()).all(|i| shape.face_normal(i).dot(&local.coords) <= shape.face_offset(i))
}
