//! Meshes of tetrahedra about one point.

use super::TetMesh;
use super::lp::{HalfSpace, maximise};
use crate::bvh::Aabb;
use crate::{MeshError, Point3, Polyhedron, Vector3};

/// The largest sphere in the kernel must have at least this part of the bounding box's diagonal as
/// its radius.
const KERNEL_TOLERANCE: f64 = 1e-9;

pub(super) fn about_centroid(polyhedron: &Polyhedron) -> Result<TetMesh, MeshError> {
    if !polyhedron.is_convex() {
        return Err(MeshError::NotConvex);
    }
    about(polyhedron, polyhedron.mass_properties().centroid)
}

pub(super) fn about_kernel(polyhedron: &Polyhedron) -> Result<TetMesh, MeshError> {
    about(polyhedron, kernel_center(polyhedron)?.0)
}

/// One tetrahedron from `apex` to each triangle of the surface.
fn about(polyhedron: &Polyhedron, apex: Point3) -> Result<TetMesh, MeshError> {
    let mut points = polyhedron.vertices().to_vec();
    let last = points.len() as u32;
    points.push(apex);
    let triangles = polyhedron.triangles();
    let tets = triangles.iter().map(|&[a, b, c]| [last, a, b, c]).collect();
    TetMesh::new(points, tets)
}

/// Centre and radius \[m\] of the largest sphere in the kernel: the points that lie behind the
/// planes of all faces.
///
/// Maximises r subject to n . x + r <= o for all faces.
pub(super) fn kernel_center(polyhedron: &Polyhedron) -> Result<(Point3, f64), MeshError> {
    let Aabb { low, high } = Aabb::of_points(polyhedron.vertices().iter().copied());
    let middle = nalgebra::center(&low, &high);
    let extent = (high - low).norm();
    let half_space = |face: usize| {
        let normal = polyhedron.face_normal(face);
        let offset = polyhedron.face_offset(face) - normal.dot(&middle.coords);
        HalfSpace {
            coefficients: vec![normal.x, normal.y, normal.z, 1.0],
            limit: offset / extent,
        }
    };
    let half_spaces: Vec<HalfSpace> = shuffled(polyhedron.face_count())
        .into_iter()
        .map(half_space)
        .collect();
    let best = maximise(&[0.0, 0.0, 0.0, 1.0], &half_spaces);
    let sphere = best.map(|x| (Vector3::new(x[0], x[1], x[2]), x[3]));
    match sphere {
        Some((center, radius)) if radius > KERNEL_TOLERANCE => {
            Ok((middle + center * extent, radius * extent))
        }
        Some((center, radius)) => Err(MeshError::NotStarShaped {
            faces: tightest_faces(polyhedron, &(middle + center * extent)),
            radius: radius * extent,
        }),
        None => Err(MeshError::NotStarShaped {
            faces: Vec::new(),
            radius: 0.0,
        }),
    }
}

/// The four faces whose planes lie deepest under a point, in ascending order. At the optimum of
/// the linear programme these are the ones that contradict each other.
fn tightest_faces(polyhedron: &Polyhedron, point: &Point3) -> Vec<usize> {
    let slack = |face: &usize| {
        polyhedron.face_offset(*face) - polyhedron.face_normal(*face).dot(&point.coords)
    };
    let mut faces: Vec<usize> = (0..polyhedron.face_count()).collect();
    faces.sort_by(|a, b| slack(a).total_cmp(&slack(b)).then(a.cmp(b)));
    faces.truncate(4);
    faces.sort_unstable();
    faces
}

/// The numbers 0 to n - 1 in an order without pattern, the same in every run: a Fisher-Yates
/// shuffle by a linear congruential generator (Knuth's MMIX constants).
fn shuffled(n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut state = 1_u64;
    for i in (1..n).rev() {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        order.swap(i, ((state >> 33) % (i as u64 + 1)) as usize);
    }
    order
}
