//! Force and torque of the general kernel are minus the gradient of its energy.

use crate::common::Stream;
use crate::common::tets;
use crate::common::tets::{body, cube, differences, dolos, l_block, total, tube};
use femdem_contact::general::GeneralScratch;
use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use std::cell::RefCell;

const PENALTY: f64 = 3.0;

/// Both wrenches against differences: the largest error, and the force; `None` without contact.
fn errors(
    kernel: &GeneralKernel,
    a: &FieldMesh,
    fa: &Frame,
    b: &FieldMesh,
    fb: &Frame,
    h: f64,
) -> Option<(f64, f64)> {
    let scratch = RefCell::new(GeneralScratch::default());
    let both =
        |fa: &Frame, fb: &Frame| total(kernel.evaluate(a, fa, b, fb, &mut scratch.borrow_mut()));
    let got = both(fa, fb);
    let [force, torque_b] = differences(|f| both(fa, f).energy, fb, h);
    let [minus, torque_a] = differences(|f| both(f, fb).energy, fa, h);
    let error = (got.force - force)
        .norm()
        .max((got.force + minus).norm())
        .max((got.torque_b - torque_b).norm())
        .max((got.torque_a - torque_a).norm());
    (got.energy > 0.0).then(|| (error, got.force.norm()))
}

fn bodies(field: Field) -> Vec<(&'static str, FieldMesh)> {
    let of = |name, mesh: TetMesh| (name, body(&mesh, field));
    let convex = vec![of("cube", cube(1)), of("fine cube", cube(3))];
    if field == Field::Gauge {
        return convex;
    }
    let mut all = convex;
    all.extend([of("L", l_block()), of("tube", tube()), of("dolos", dolos())]);
    all
}

#[test]
fn wrenches_are_gradients_in_random_poses() {
    let mut stream = Stream(17);
    for field in [Field::Body, Field::Gauge] {
        let bodies = bodies(field);
        let kernel = GeneralKernel::new(PENALTY).unwrap();
        let mut touching = 0;
        for (i, (name, a)) in bodies.iter().enumerate() {
            for (other, b) in bodies[i..].iter().take(2) {
                for _ in 0..2 {
                    let mut fa = Frame::identity();
                    fa.position = stream.vector();
                    fa.rotation = stream.rotation();
                    let mut fb = fa;
                    fb.rotation = stream.rotation();
                    let d = stream.vector().normalize();
                    fb.position += d * (0.4 + 0.6 * stream.unit());
                    let Some((error, force)) = errors(&kernel, a, &fa, b, &fb, 1e-5) else {
                        continue;
                    };
                    touching += 1;
                    assert!(
                        error < 1e-7 * force + 1e-12,
                        "{field:?} {name} on {other}: {error:e} of {force}"
                    );
                }
            }
        }
        assert!(touching > 5, "{field:?}: {touching}");
    }
}

/// Poses of B about A in which faces, edges and corners of two unit cubes (about their centroids)
/// coincide. Where an energy has a kink, the force is the mean of both sides, as a central
/// difference is.
fn coincidences() -> Vec<(&'static str, Vector3<f64>, Matrix3<f64>)> {
    let straight = Matrix3::identity();
    let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
    let r = 0.5_f64.sqrt();
    let eighth = Matrix3::new(r, -r, 0.0, r, r, 0.0, 0.0, 0.0, 1.0);
    let tilted = eighth * Matrix3::new(1.0, 0.0, 0.0, 0.0, r, -r, 0.0, r, r);
    vec![
        ("aligned stack", Vector3::new(0.0, 0.0, 0.97), straight),
        ("quarter turn", Vector3::new(0.0, 0.0, 0.97), quarter),
        ("shifted stack", Vector3::new(0.25, 0.0, 0.97), straight),
        ("by the lattice", Vector3::new(0.25, 0.5, 0.75), straight),
        ("turned face", Vector3::new(0.1, 0.2, 0.97), eighth),
        ("edge in face", Vector3::new(0.0, 0.0, 1.15), tilted),
        ("edge along edge", Vector3::new(0.97, 0.97, 0.0), straight),
        ("corner in corner", Vector3::new(0.97, 0.97, 0.97), straight),
        ("face touching face", Vector3::new(0.0, 0.0, 1.0), straight),
        ("edge touching edge", Vector3::new(0.0, 1.0, 1.0), straight),
        (
            "corner touching corner",
            Vector3::new(1.0, 1.0, 1.0),
            straight,
        ),
        ("identical", Vector3::zeros(), straight),
        ("same place, turned", Vector3::zeros(), tilted),
    ]
}

#[test]
fn wrenches_are_gradients_where_faces_edges_and_corners_coincide() {
    for (field, n) in [(Field::Gauge, 1), (Field::Body, 2), (Field::Body, 1)] {
        let (a, b) = (body(&cube(n), field), body(&cube(2), Field::Body));
        let kernel = GeneralKernel::new(PENALTY).unwrap();
        for (what, place, rotation) in coincidences() {
            let mut fa = Frame::identity();
            fa.position = Vector3::new(0.3, -7.0, 2.0);
            let fb = Frame {
                position: fa.position + place,
                rotation,
            };
            // Stiffnesses jump where contacts begin: an error of the step times the penalty.
            if let Some((error, _)) = errors(&kernel, &a, &fa, &b, &fb, 1e-7) {
                assert!(error < 1e-6 * PENALTY, "{field:?} {n} {what}: {error:e}");
            }
        }
    }
}

/// One cube wholly inside a larger one: the force is that of the larger one's field alone.
#[test]
fn wrenches_are_gradients_inside_another_body() {
    let mut stream = Stream(23);
    for field in [Field::Body, Field::Gauge] {
        let a = body(&cube(2), field);
        let b = body(&tets::cubes(&[[0; 3]], 0.2), field);
        let kernel = GeneralKernel::new(PENALTY).unwrap();
        for _ in 0..4 {
            let fa = Frame::identity();
            let fb = Frame {
                position: stream.vector() * 0.5,
                rotation: stream.rotation(),
            };
            let (error, force) = errors(&kernel, &a, &fa, &b, &fb, 1e-5).unwrap();
            assert!(
                error < 1e-6 * force + 1e-11,
                "{field:?}: {error:e} of {force:e}"
            );
        }
    }
}
