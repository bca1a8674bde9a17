//! The contact wrench from the skins: every triangle of one skin cut by the tetrahedra of the other
//! body.
//!
//! The force on B is p (sum over A's triangles of n int phi_B dS - sum over B's of n int phi_A dS), both over
//! the parts inside the other body. By the divergence theorem it equals the sum over pieces of volume in
//! [`GeneralKernel`](super::GeneralKernel), with which it shares no arithmetic. It gives no energy, and
//! counts a triangle twice that coincides with inner faces of the other mesh. Deformable bodies need it for
//! their nodal forces.

use super::cells::Cell;
use super::mesh::FieldMesh;
use crate::error::{ContactError, check_pressure};
use crate::shape::Frame;
use femdem_mesh::bvh::Aabb;
use femdem_mesh::{Matrix3, Point3, Vector3};

/// Corners of a triangle cut by four planes, at most.
const MOST: usize = 8;

/// The wrench of a pair, all patches together, in world axes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SkinWrench {
    /// Force on B, N; that on A is opposite.
    pub force: Vector3,
    /// Torque on B about its origin, N m.
    pub torque_b: Vector3,
    /// Vector area of A's skin in B less that of B's in A, halved, m^2.
    pub area: Vector3,
    /// Numbers of pairs of a triangle and a tetrahedron that were tested, and of those that meet.
    pub candidates: usize,
    /// See `candidates`.
    pub hits: usize,
}

/// The skin path with the form Sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinPath {
    penalty: f64,
}

/// Integrals of the field over the skin inside the other body, in that body's axes.
#[derive(Debug, Clone, Copy, Default)]
struct SideSums {
    force: Vector3,
    torque: Vector3,
    area: Vector3,
    candidates: usize,
    hits: usize,
}

impl SkinPath {
    /// The skin path with penalty `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the penalty is between 1e-100 and 1e100 Pa.
    pub fn new(penalty: f64) -> Result<Self, ContactError> {
        check_pressure("penalty", penalty)?;
        Ok(Self { penalty })
    }

    /// The wrench of A and B.
    pub fn evaluate(
        &self,
        a: &FieldMesh,
        frame_a: &Frame,
        b: &FieldMesh,
        frame_b: &Frame,
    ) -> SkinWrench {
        let p = self.penalty;
        let between = frame_b.position - frame_a.position;
        let rotation = frame_a.rotation.tr_mul(&frame_b.rotation);
        let in_a = frame_a.rotation.tr_mul(&between);
        let in_b = -frame_b.rotation.tr_mul(&between);
        let of_b = side(a, b, &rotation, &in_a);
        let of_a = side(b, a, &rotation.transpose(), &in_b);
        // The torque of B's skin is about A's origin, that of A's skin about B's.
        let force_b = frame_a.rotation * of_b.force;
        let force_a = frame_b.rotation * of_a.force;
        let torque_of_b = frame_a.rotation * of_b.torque - between.cross(&force_b);
        SkinWrench {
            force: (force_a - force_b) * p,
            torque_b: (frame_b.rotation * of_a.torque - torque_of_b) * p,
            area: (frame_b.rotation * of_a.area - frame_a.rotation * of_b.area) * 0.5,
            candidates: of_a.candidates + of_b.candidates,
            hits: of_a.hits + of_b.hits,
        }
    }
}

/// The skin of one body, posed by `rotation` and `offset` in the field body's axes.
fn side(field: &FieldMesh, skin: &FieldMesh, rotation: &Matrix3, offset: &Vector3) -> SideSums {
    let mut sums = SideSums::default();
    let bounds = field.cells.tree.bounds();
    for (corners, _) in &skin.skin {
        let triangle = corners.map(|x| rotation * x + offset);
        let around = Aabb::of_points(triangle.map(Point3::from));
        if !bounds.overlaps(&around) {
            continue;
        }
        let doubled = (triangle[1] - triangle[0]).cross(&(triangle[2] - triangle[0]));
        field.cells.tree.query(&around, |i| {
            if !field.cells.boxes[i as usize].overlaps(&around) {
                return;
            }
            sums.candidates += 1;
            let cell = &field.cells.list[i as usize];
            if let Some(cut) = cut(cell, &triangle) {
                sums.hits += 1;
                sums.add(&cut, &triangle, &doubled);
            }
        });
    }
    sums
}

impl SideSums {
    fn add(&mut self, cut: &Moments, [x, y, z]: &[Vector3; 3], doubled: &Vector3) {
        let first = x * cut.field + (y - x) * cut.first[0] + (z - x) * cut.first[1];
        self.force += doubled * cut.field;
        self.torque += first.cross(doubled);
        self.area += doubled * cut.area;
    }
}

/// Integrals over the part of a triangle in a tetrahedron, in coordinates (s, t) in which the
/// corners are (0, 0), (1, 0), (0, 1): of 1, of the field, and of it times s and t.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Moments {
    area: f64,
    field: f64,
    first: [f64; 2],
}

/// The part of a triangle in a tetrahedron, integrated.
fn cut(cell: &Cell, triangle: &[Vector3; 3]) -> Option<Moments> {
    let mut crossing = [[0.0; 3]; 4];
    let mut cuts = 0;
    for k in 0..4 {
        let n = &cell.normals[k];
        let on = &cell.corners[(k + 1) % 4];
        let d = [0, 1, 2].map(|c| n.dot(&(on - triangle[c])));
        let inside = d.iter().filter(|d| **d > 0.0).count();
        if inside == 0 {
            return None;
        }
        if inside < 3 {
            crossing[cuts] = [d[0], d[1] - d[0], d[2] - d[0]];
            cuts += 1;
        }
    }
    let mut polygon = [[0.0; 2]; MOST];
    let mut spare = polygon;
    polygon[1][0] = 1.0;
    polygon[2][1] = 1.0;
    let mut count = 3;
    for line in &crossing[..cuts] {
        count = clip(&polygon[..count], line, &mut spare);
        if count < 3 {
            return None;
        }
        std::mem::swap(&mut polygon, &mut spare);
    }
    let values = triangle.map(|x| cell.field(&x));
    let field = [values[0], values[1] - values[0], values[2] - values[0]];
    Some(integrate(&polygon[..count], &field))
}

/// a + b s + c t.
fn at([a, b, c]: &[f64; 3], [s, t]: &[f64; 2]) -> f64 {
    a + b * s + c * t
}

/// Keeps what lies on the positive side of a line; returns the number of corners.
fn clip(polygon: &[[f64; 2]], line: &[f64; 3], out: &mut [[f64; 2]; MOST]) -> usize {
    let mut count = 0;
    let mut put = |p: [f64; 2]| {
        if count < MOST {
            out[count] = p;
            count += 1;
        }
    };
    let Some(mut p) = polygon.last() else {
        return 0;
    };
    let mut dp = at(line, p);
    for q in polygon {
        let dq = at(line, q);
        if (dq >= 0.0) != (dp >= 0.0) {
            let u = dp / (dp - dq);
            put([p[0] + (q[0] - p[0]) * u, p[1] + (q[1] - p[1]) * u]);
        }
        if dq >= 0.0 {
            put(*q);
        }
        (p, dp) = (q, dq);
    }
    count
}

fn integrate(polygon: &[[f64; 2]], field: &[f64; 3]) -> Moments {
    let mut sums = Moments::default();
    let Some((p, rest)) = polygon.split_first() else {
        return sums;
    };
    let fp = at(field, p);
    for edge in rest.windows(2) {
        let [q, r] = [&edge[0], &edge[1]];
        let (fq, fr) = (at(field, q), at(field, r));
        let area = 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
        let total = fp + fq + fr;
        sums.area += area;
        sums.field += area / 3.0 * total;
        for k in 0..2 {
            let sum = p[k] + q[k] + r[k];
            sums.first[k] += area / 12.0 * (sum * total + p[k] * fp + q[k] * fq + r[k] * fr);
        }
    }
    sums
}
