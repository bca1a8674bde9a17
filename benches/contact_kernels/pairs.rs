//! Pairs of bodies that touch, and the bodies in the forms that the kernels take.

use femdem::contact::general::{GeneralCache, GeneralScratch};
use femdem::contact::kernel::{PairCache, Scratch};
use femdem::contact::{ConvexShape, FieldMesh, Frame, GeneralKernel, PairKernel};
use femdem::mesh::{Polyhedron, Rotation, Vector3};
use femdem_benches::SetUpError;
use parry3d_f64::math::{Matrix, Pose, Rotation as ParryRotation, Vector};
use parry3d_f64::query;
use parry3d_f64::shape::ConvexPolyhedron;
use std::hint::black_box;

use super::Kernel;

pub const PENALTY: f64 = 1e7;

pub type Pair = [Frame; 2];

/// A convex body for all kernels.
pub struct Convex {
    pub shape: ConvexShape,
    pub fan: FieldMesh,
    pub parry: ConvexPolyhedron,
}

impl Convex {
    pub fn new(polyhedron: &Polyhedron) -> Result<Self, SetUpError> {
        let shape = ConvexShape::new(polyhedron)?;
        let points: Vec<Vector> = shape.vertices().iter().map(vector).collect();
        Ok(Self {
            fan: shape.fan()?,
            parry: ConvexPolyhedron::from_convex_hull(&points).ok_or("no hull")?,
            shape,
        })
    }
}

fn vector(v: &Vector3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn pose(frame: &Frame) -> Pose {
    let columns = [0, 1, 2].map(|k| vector(&frame.rotation.column(k).into_owned()));
    let matrix = Matrix::from_cols(columns[0], columns[1], columns[2]);
    Pose::from_parts(vector(&frame.position), ParryRotation::from_mat3(&matrix))
}

/// The convex kernel with and without its cache, the general kernel on fans, and parry.
pub fn convex_kernels<'a>(
    body: &'a Convex,
    pairs: &'a [Pair],
) -> Result<Vec<Kernel<'a>>, SetUpError> {
    let kernel = PairKernel::new(PENALTY)?;
    let count = pairs.len();
    let shape = &body.shape;
    let mut scratch = Scratch::default();
    let mut caches = vec![PairCache::default(); count];
    let warm = move || {
        for ([a, b], cache) in pairs.iter().zip(&mut caches) {
            black_box(kernel.evaluate_cached(shape, a, shape, b, cache, 0.0, &mut scratch));
        }
    };
    let mut scratch = Scratch::default();
    let cold = move || {
        for [a, b] in pairs {
            black_box(kernel.evaluate(shape, a, shape, b, &mut scratch));
        }
    };
    let poses: Vec<[Pose; 2]> = pairs.iter().map(|p| [pose(&p[0]), pose(&p[1])]).collect();
    let parry = move || {
        for [a, b] in &poses {
            black_box(query::contact(a, &body.parry, b, &body.parry, 0.0).ok());
        }
    };
    let mut kernels = vec![
        Kernel::new("convex, warm", count, warm),
        Kernel::new("convex, cold", count, cold),
        Kernel::new("parry contact", count, parry),
    ];
    kernels.extend(general_kernels(&body.fan, pairs)?);
    Ok(kernels)
}

/// The general kernel, with its cache and without.
pub fn general_kernels<'a>(
    mesh: &'a FieldMesh,
    pairs: &'a [Pair],
) -> Result<Vec<Kernel<'a>>, SetUpError> {
    let mut kernels = Vec::new();
    let kernel = GeneralKernel::new(PENALTY)?;
    let mut scratch = GeneralScratch::default();
    let mut caches = vec![GeneralCache::default(); pairs.len()];
    kernels.push(Kernel::new("general, warm", pairs.len(), move || {
        for ([a, b], cache) in pairs.iter().zip(&mut caches) {
            black_box(kernel.evaluate_cached(mesh, a, mesh, b, cache, 0.0, &mut scratch));
        }
    }));
    let kernel = GeneralKernel::new(PENALTY)?;
    let mut scratch = GeneralScratch::default();
    kernels.push(Kernel::new("general, cold", pairs.len(), move || {
        for [a, b] in pairs {
            black_box(kernel.evaluate(mesh, a, mesh, b, &mut scratch));
        }
    }));
    Ok(kernels)
}

/// Pairs of a tetrahedron of A and one of B that the general kernel evaluates with a cache, and those that
/// overlap, per pair.
pub fn counts(mesh: &FieldMesh, pairs: &[Pair]) -> Result<[f64; 2], SetUpError> {
    let kernel = GeneralKernel::new(PENALTY)?;
    let mut scratch = GeneralScratch::default();
    let mut sums = [0, 0];
    for [a, b] in pairs {
        kernel.evaluate(mesh, a, mesh, b, &mut scratch);
        let counts = scratch.counts();
        sums = [sums[0] + counts[0], sums[1] + counts[1]];
    }
    Ok(sums.map(|n| n as f64 / pairs.len().max(1) as f64))
}

/// A value in 0..1 that depends on `i` alone.
pub fn noise(i: u32) -> f64 {
    let x = u64::from(i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((x ^ (x >> 32)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Depth of the overlaps over the size of the bodies: as in a settled pack.
const DEPTH: f64 = 0.003;

/// Pairs of one body, B brought near A in random orientations and directions until they touch,
/// and then a little farther.
pub fn approached(touch: impl Fn(&Pair) -> bool, radius: f64, count: u32) -> Vec<Pair> {
    let vector = |i: u32| Vector3::new(noise(i) - 0.5, noise(i + 1) - 0.5, noise(i + 2) - 0.5);
    let place = |i: u32| {
        let rotation = |j: u32| {
            let turn = Rotation::from_scaled_axis(vector(j) * 12.0);
            turn.to_rotation_matrix().into_inner()
        };
        let (rotation_a, rotation_b) = (rotation(9 * i), rotation(9 * i + 3));
        let direction = vector(9 * i + 6).normalize();
        let at = |distance: f64| {
            [
                (Vector3::zeros(), rotation_a),
                (direction * distance, rotation_b),
            ]
            .map(|(position, rotation)| Frame { position, rotation })
        };
        let (mut near, mut far) = (0.0, 2.0 * radius);
        for _ in 0..40 {
            let middle = 0.5 * (near + far);
            if touch(&at(middle)) {
                near = middle;
            } else {
                far = middle;
            }
        }
        at(near - DEPTH * 2.0 * radius)
    };
    (0..count).map(place).collect()
}
