//! Where the shaped energy is stiff: why no step chosen from the stiffness of faces is safe.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::tets;
use femdem_contact::general::GeneralScratch;
use femdem_contact::{Field, FieldMesh, Form, Frame, GeneralKernel};
use femdem_mesh::nalgebra::{UnitQuaternion, Vector3};

const MODULUS: f64 = 1.0;
const DEPTH: f64 = 0.05;

/// Sliding stiffness of two unit cubes, one on the other, `DEPTH` deep and tilted by about `tilt`; and the
/// normal stiffness that the kernel returns.
fn stiffness(body: &FieldMesh, form: Form, tilt: f64) -> (f64, f64) {
    let kernel = GeneralKernel::new(MODULUS, form).unwrap();
    let mut scratch = GeneralScratch::default();
    let turn = Vector3::new(0.5, 1.0, 0.0) * tilt;
    // The sides cross where the cubes overlap.
    let middle = tilt * (0.5 - 0.5 * DEPTH);
    let mut at = |x: f64| {
        let frame = Frame {
            position: Vector3::new(middle + x, 0.0, 1.0 - DEPTH),
            rotation: UnitQuaternion::from_scaled_axis(turn)
                .to_rotation_matrix()
                .into_inner(),
        };
        let patches = kernel.evaluate(body, &Frame::identity(), body, &frame, &mut scratch);
        (
            tets::total(patches).force.x,
            patches[0].overlap.foundation.stiffness,
        )
    };
    let h = 1e-3 * tilt * DEPTH;
    (-(at(h).0 - at(-h).0) / (2.0 * h), at(0.0).1)
}

/// Sliding moves the side of one cube past that of the other. The overlap volume, which shrinks by the area
/// DEPTH by 1, then grows by it, within a displacement of DEPTH times the tilt. With U / V = E DEPTH that is
/// a stiffness of 2 E DEPTH / tilt, without bound. The sum form has no such term.
#[test]
fn sides_that_coincide_are_stiff_without_bound() {
    let body = tets::body(&tets::cube(1), Field::Gauge);
    let mut last = 0.0;
    for tilt in [1e-2, 1e-3, 1e-4, 1e-5] {
        let (shaped, reported) = stiffness(&body, Form::Shaped, tilt);
        let ratio = shaped * tilt / (MODULUS * DEPTH);
        assert!((1.7..2.1).contains(&ratio), "{tilt:e}: {ratio}");
        assert!(shaped > 5.0 * last);
        assert!(reported < 4.0 * MODULUS, "{reported}");
        last = shaped;
        let (sum, _) = stiffness(&body, Form::Sum, tilt);
        assert!(sum.abs() < 1.0, "{sum}");
    }
}

/// As the volume goes to zero, so does the stiffness: the least volume is not the cause.
#[test]
fn a_vanishing_contact_is_soft() {
    let body = tets::body(&tets::cube(1), Field::Gauge);
    let kernel = GeneralKernel::new(MODULUS, Form::Shaped).unwrap();
    let mut scratch = GeneralScratch::default();
    let turn = UnitQuaternion::rotation_between(&Vector3::repeat(-1.0), &-Vector3::z()).unwrap();
    let mut frame = Frame::identity();
    frame.rotation = turn.to_rotation_matrix().into_inner();
    for depth in [1e-1, 1e-2, 1e-3] {
        frame.position.z = 0.5 + 0.75_f64.sqrt() - depth;
        let patches = kernel.evaluate(&body, &Frame::identity(), &body, &frame, &mut scratch);
        let o = &patches[0].overlap;
        // U = c depth^3: the force is 3 U / depth, and the stiffness 6 U / depth^2.
        assert!((o.force.z * depth / (3.0 * o.energy) - 1.0).abs() < 0.05);
        assert!(o.foundation.stiffness < 4.0 * MODULUS * depth);
    }
    frame.position.z = 0.5 + 0.75_f64.sqrt() - 3e-5;
    let patches = kernel.evaluate(&body, &Frame::identity(), &body, &frame, &mut scratch);
    assert!(
        patches.is_empty(),
        "below the least volume there is no contact"
    );
}
