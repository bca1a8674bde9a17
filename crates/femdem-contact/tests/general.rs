//! The general kernel on centroid fans of convex bodies against the convex kernel.

mod common;

use common::{Stream, solids};
use femdem_contact::general::GeneralScratch;
use femdem_contact::kernel::Scratch;
use femdem_contact::{FieldMesh, Form, Frame, GeneralKernel, Overlap, PairKernel};
use femdem_mesh::nalgebra::Vector3;

const PENALTY: f64 = 3.0;

/// Everything in an overlap of bodies of size 1, with the scale that its errors go by.
fn numbers(o: &Overlap) -> Vec<(&'static str, Vector3<f64>, f64)> {
    let f = o.force.norm();
    let one = |x: f64| Vector3::new(x, 0.0, 0.0);
    vec![
        ("force", o.force, f),
        ("torque on A", o.torque_a(), f),
        ("torque on B", o.torque_b(), f),
        // The convex kernel takes the energy as a difference of terms of the size of p V.
        ("energy", one(o.energy), PENALTY * o.volume),
        ("volume", one(o.volume), o.volume),
        ("moment", o.moment, f),
        ("arm of A", o.arm_a, 1.0),
        ("arm of B", o.arm_b, 1.0),
        ("normal", o.normal, 1.0),
        ("area", one(o.area), o.area),
        ("stiffness", one(o.stiffness), o.stiffness),
        ("second", one(o.stiffness_second), o.stiffness),
        ("radius", one(o.torsion_radius), 1.0),
    ]
}

/// Worst relative differences, field by field.
fn compare(got: &Overlap, want: &Overlap, worst: &mut Vec<(&'static str, f64)>) {
    let pairs = numbers(got).into_iter().zip(numbers(want));
    for (k, ((name, g, _), (_, w, scale))) in pairs.enumerate() {
        let error = (g - w).norm() / scale;
        if worst.len() <= k {
            worst.push((name, 0.0));
        }
        worst[k].1 = worst[k].1.max(error);
    }
}

#[test]
fn fans_of_convex_bodies_are_the_convex_kernel() {
    let convex = PairKernel::new(PENALTY).unwrap();
    let general = GeneralKernel::new(PENALTY, Form::Sum).unwrap();
    let (mut scratch, mut buffers) = (Scratch::default(), GeneralScratch::default());
    let mut stream = Stream(3);
    let mut worst = Vec::new();
    let mut touching = 0;
    for (name, polyhedron, shape) in solids() {
        let mesh = FieldMesh::from_convex(&polyhedron).unwrap();
        assert!((mesh.inradius() - shape.inradius()).abs() < 1e-14);
        for _ in 0..8 {
            let mut fa = Frame::identity();
            fa.position = stream.vector();
            fa.rotation = stream.rotation();
            let mut fb = fa;
            fb.rotation = stream.rotation();
            let direction = stream.vector().normalize();
            let reach = shape.support(&fa.rotation.tr_mul(&direction))
                + shape.support(&-fb.rotation.tr_mul(&direction));
            fb.position += direction * (reach * (0.55 + 0.4 * stream.unit()));
            let want = convex.evaluate(&shape, &fa, &shape, &fb, &mut scratch);
            let got = general.evaluate(&mesh, &fa, &mesh, &fb, &mut buffers);
            match (want, got) {
                (Some(want), [got]) => {
                    touching += 1;
                    compare(&got.overlap, &want, &mut worst);
                }
                (None, []) => {}
                (want, got) => panic!("{name}: {want:?} but {got:?}"),
            }
        }
    }
    assert!(touching > 60, "only {touching}");
    for (name, error) in worst {
        assert!(error < 2e-12, "{name} differs by {error:e}");
    }
}
