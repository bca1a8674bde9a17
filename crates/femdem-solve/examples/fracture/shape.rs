//! Irregular grains of a size, each of a shape of its own.

use femdem_mesh::shapes::{Shape, Sphere};
use femdem_mesh::tet::{MeshOptions, Method, mesh};
use femdem_mesh::{Point3, Rotation, TetMesh, Vector3};
use std::error::Error;
use std::f64::consts::{PI, TAU};

/// Axes of the ellipsoid that a grain is but for its waves, over the longest.
const AXES: [f64; 3] = [1.0, 0.8, 0.64];

/// Waves on a grain: how many, how high over its radius, and 2π over their length for a ball of diameter 1.
const WAVES: u64 = 8;
const HEIGHT: f64 = 0.05;
const NUMBER: f64 = 6.0;

/// Directions of the first look for the smallest width.
const DIRECTIONS: u32 = 2000;

/// A ball of diameter 1, of elements of about an edge: an icosahedron, subdivided so often, whose layers are made round.
pub fn ball(level: u32, edge: f64) -> Result<TetMesh, Box<dyn Error>> {
    let body = Shape::from(Sphere { level }).polyhedron(1.0)?;
    let options = MeshOptions {
        method: Some(Method::CentroidFan),
        edge_length: Some(edge),
        ..MeshOptions::default()
    };
    let (mesh, _) = mesh(&body, &options)?;
    let round = |p: &Point3| {
        let faces = 0..body.face_count();
        let layers = faces.map(|f| body.face_normal(f).dot(&p.coords) / body.face_offset(f));
        let layer = layers.fold(0.0, f64::max);
        if layer > 0.0 {
            Point3::from(p.coords * (0.5 * layer / p.coords.norm()))
        } else {
            *p
        }
    };
    let points = mesh.points().iter().map(round).collect();
    Ok(TetMesh::new(points, mesh.tets().to_vec())?)
}

/// A grain of the elements of a ball: stretched and bulged in a way of its own, its smallest width 1 and along z.
pub fn grain(ball: &TetMesh, number: u64) -> Result<TetMesh, Box<dyn Error>> {
    let mut random = Random(number);
    let first = random.direction();
    let second = first.cross(&random.direction()).normalize();
    let axes = [first, second, first.cross(&second)];
    let wave = |_| (random.direction() * NUMBER, TAU * random.uniform());
    let waves: Vec<(Vector3, f64)> = (0..WAVES).map(wave).collect();
    let moved = |p: &Point3| {
        let x = &p.coords;
        let own = waves.iter().map(|(k, phase)| (k.dot(x) + phase).sin());
        let stretched: Vector3 = axes.iter().zip(AXES).map(|(a, s)| a * (s * a.dot(x))).sum();
        stretched * (1.0 + HEIGHT * own.sum::<f64>())
    };
    let points: Vec<Vector3> = ball.points().iter().map(moved).collect();
    let axis = thinnest(&points);
    let upright = Rotation::rotation_between(&axis, &Vector3::z()).unwrap_or_default();
    let scale = 1.0 / width(&points, &axis);
    let placed = points.iter().map(|x| Point3::from(upright * x * scale));
    Ok(TetMesh::new(placed.collect(), ball.tets().to_vec())?)
}

/// How far points reach along an axis.
fn width(points: &[Vector3], axis: &Vector3) -> f64 {
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    for p in points {
        let z = p.dot(axis);
        low = low.min(z);
        high = high.max(z);
    }
    high - low
}

/// The direction along which points reach the least: the best of directions on a spiral, improved in ever smaller steps.
fn thinnest(points: &[Vector3]) -> Vector3 {
    let golden = PI * (3.0 - 5_f64.sqrt());
    let spiral = (0..DIRECTIONS).map(|k| {
        let z = (f64::from(k) + 0.5) / f64::from(DIRECTIONS);
        let (r, angle) = ((1.0 - z * z).sqrt(), golden * f64::from(k));
        Vector3::new(r * angle.cos(), r * angle.sin(), z)
    });
    let (mut best, mut least) = (Vector3::z(), f64::MAX);
    let mut try_axis = |axis: Vector3| {
        let width = width(points, &axis);
        if width < least {
            (best, least) = (axis, width);
        }
        best
    };
    let mut from = Vector3::z();
    for axis in spiral {
        from = try_axis(axis);
    }
    let mut step = 0.05;
    while step > 1e-6 {
        let mut to = from;
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            for way in [-step, step] {
                to = try_axis((from + axis * way).normalize());
            }
        }
        if to == from {
            step *= 0.5;
        }
        from = to;
    }
    from
}

/// SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014).
struct Random(u64);

impl Random {
    /// From 0 to 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A unit vector.
    fn direction(&mut self) -> Vector3 {
        let z = 2.0 * self.uniform() - 1.0;
        let angle = TAU * self.uniform();
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * angle.cos(), r * angle.sin(), z)
    }
}
