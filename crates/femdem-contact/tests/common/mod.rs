//! Shared by the kernel tests: poses, and an energy oracle that shares no code with the kernel.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "every test file uses its own part, and helpers of tests fail the test"
)]

pub mod meshes;
pub mod pack;
pub mod soft;
pub mod tets;

use femdem_contact::{ConvexShape, Frame};
use femdem_mesh::Polyhedron;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// All 18 solids of circumscribed diameter 1, with their names.
pub fn solids() -> Vec<(String, Polyhedron, ConvexShape)> {
    CatalogueShape::all()
        .map(|s| {
            let p = s.polyhedron(1.0).unwrap();
            let c = ConvexShape::new(&p).unwrap();
            (s.id(), p, c)
        })
        .collect()
}

/// A small linear congruential generator: the tests only need variety.
pub struct Stream(pub u64);

impl Stream {
    pub fn unit(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5)
    }

    pub fn rotation(&mut self) -> Matrix3<f64> {
        let q = femdem_mesh::nalgebra::Quaternion::new(
            self.unit() - 0.5,
            self.unit() - 0.5,
            self.unit() - 0.5,
            self.unit() - 0.5,
        );
        UnitQuaternion::from_quaternion(q)
            .to_rotation_matrix()
            .into_inner()
    }
}

/// A frame turned by `angle` about `axis` through its own origin.
pub fn turned(frame: &Frame, axis: &Vector3<f64>, angle: f64) -> Frame {
    let turn = UnitQuaternion::from_scaled_axis(axis * angle).to_rotation_matrix();
    Frame {
        position: frame.position,
        rotation: turn.into_inner() * frame.rotation,
    }
}

/// World planes (normal, offset) of a posed polyhedron.
fn planes(p: &Polyhedron, frame: &Frame) -> Vec<(Vector3<f64>, f64)> {
    (0..p.face_count())
        .map(|i| {
            let n = frame.rotation * p.face_normal(i);
            (n, p.face_offset(i) + n.dot(&frame.position))
        })
        .collect()
}

type Tet = [Vector3<f64>; 4];

/// The tets of the centroid fan: apex first, so the gauge field is 1 at vertex 0 and 0 at
/// the others.
fn fan(p: &Polyhedron, frame: &Frame) -> Vec<Tet> {
    let at = |i: u32| frame.point(&p.vertices()[i as usize].coords);
    p.faces()
        .flat_map(|f| {
            (1..f.len() - 1).map(move |k| [frame.position, at(f[0]), at(f[k]), at(f[k + 1])])
        })
        .collect()
}

fn volume(t: &Tet) -> f64 {
    (t[1] - t[0])
        .dot(&(t[2] - t[0]).cross(&(t[3] - t[0])))
        .abs()
        / 6.0
}

/// Integral over (tet below the planes) of the linear function with vertex values `w`.
pub fn clipped_integral(t: &Tet, w: [f64; 4], planes: &[(Vector3<f64>, f64)]) -> (f64, f64) {
    let Some(((n, c), rest)) = planes.split_first() else {
        let v = volume(t);
        return (v, v * w.iter().sum::<f64>() / 4.0);
    };
    let d: Vec<f64> = t.iter().map(|x| c - n.dot(x)).collect();
    let inside: Vec<usize> = (0..4).filter(|&i| d[i] >= 0.0).collect();
    let outside: Vec<usize> = (0..4).filter(|&i| d[i] < 0.0).collect();
    let cut = |i: usize, o: usize| {
        let s = d[i] / (d[i] - d[o]);
        (t[i] + (t[o] - t[i]) * s, w[i] + (w[o] - w[i]) * s)
    };
    let own = |i: usize| (t[i], w[i]);
    let pieces: Vec<[(Vector3<f64>, f64); 4]> = match (inside.as_slice(), outside.as_slice()) {
        ([], _) => vec![],
        (_, []) => vec![[own(0), own(1), own(2), own(3)]],
        ([i], [a, b, c]) => vec![[own(*i), cut(*i, *a), cut(*i, *b), cut(*i, *c)]],
        ([i, j], [a, b]) => {
            let (ia, ib, ja, jb) = (cut(*i, *a), cut(*i, *b), cut(*j, *a), cut(*j, *b));
            vec![
                [own(*i), ia, ib, jb],
                [own(*i), ia, ja, jb],
                [own(*i), own(*j), ja, jb],
            ]
        }
        ([i, j, k], [o]) => {
            let (a, b, c) = (cut(*i, *o), cut(*j, *o), cut(*k, *o));
            vec![
                [own(*i), own(*j), own(*k), a],
                [own(*j), own(*k), a, b],
                [own(*k), a, b, c],
            ]
        }
        _ => unreachable!(),
    };
    pieces
        .iter()
        .map(|p| clipped_integral(&p.map(|x| x.0), p.map(|x| x.1), rest))
        .fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1))
}

/// Overlap volume and integral of phi_A + phi_B over it, by clipping the fan tets of each
/// body by the planes of the other: shares nothing with the kernel.
pub fn oracle(a: &Polyhedron, fa: &Frame, b: &Polyhedron, fb: &Frame) -> (f64, f64) {
    let one = |p: &Polyhedron, fp: &Frame, q: &Polyhedron, fq: &Frame| {
        let planes = planes(q, fq);
        fan(p, fp)
            .iter()
            .map(|t| clipped_integral(t, [1.0, 0.0, 0.0, 0.0], &planes))
            .fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1))
    };
    let (va, ia) = one(a, fa, b, fb);
    let (_, ib) = one(b, fb, a, fa);
    (va, ia + ib)
}

/// Integral of phi_B over the part of B behind the half-space n.x >= c, and its volume.
pub fn wall_oracle(b: &Polyhedron, fb: &Frame, planes: &[(Vector3<f64>, f64)]) -> (f64, f64) {
    let total = |planes: &[(Vector3<f64>, f64)]| {
        fan(b, fb)
            .iter()
            .map(|t| clipped_integral(t, [1.0, 0.0, 0.0, 0.0], planes))
            .fold((0.0, 0.0), |s, x| (s.0 + x.0, s.1 + x.1))
    };
    // Free side n.x >= c is {-n.x <= -c}; the part outside is the rest.
    let free: Vec<_> = planes.iter().map(|(n, c)| (-n, -c)).collect();
    let (all, inside) = (total(&[]), total(&free));
    (all.0 - inside.0, all.1 - inside.1)
}
