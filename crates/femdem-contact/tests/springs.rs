//! Interface for implicit steps: springs without dashpots, contacts that are about to close, and replaced
//! forces.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::pack::{placed, shape};
use femdem_contact::{
    ContactBatch, ContactError, ContactForce, ContactLaw, ContactParameters, Motion, RigidContact,
    Snapshot,
};
use femdem_mesh::nalgebra::{Matrix3, Rotation3, Vector3};

/// Two cubes, B above A, that are `gap` apart and approach each other, sliding.
fn cubes(gap: f64, damping: f64) -> (ContactBatch, Vec<Motion>) {
    let law = ContactLaw::new(ContactParameters {
        damping_ratio: damping,
        tangential_damping: damping,
        ..ContactParameters::default()
    });
    let mut batch = ContactBatch::new(law.unwrap());
    let cube = shape("P5", 0.1);
    let id = batch.add_shape((*cube).clone());
    let edge = 0.1 / 3.0_f64.sqrt();
    let bodies = [0.0, edge + gap].map(|z| {
        batch.add_body(id).unwrap();
        placed(&cube, Vector3::z() * z, Matrix3::identity())
    });
    let mut bodies = bodies.to_vec();
    bodies[1].velocity = Vector3::new(0.1, 0.0, -0.5);
    (batch, bodies)
}

/// The bodies after `dt`.
fn ahead(bodies: &[Motion], dt: f64) -> Vec<Motion> {
    let mut bodies = bodies.to_vec();
    for body in &mut bodies {
        body.frame.position += body.velocity * dt;
        body.travelled += body.velocity.norm() * dt;
    }
    bodies
}

fn look(batch: &mut ContactBatch, bodies: &[Motion], dt: f64) -> Vec<RigidContact> {
    let later = ahead(bodies, dt);
    let view = |bodies| Snapshot {
        bodies,
        walls: &[],
        dt,
    };
    batch.update_springs(view(bodies), view(&later)).unwrap();
    batch.evaluated().copied().collect()
}

/// The forces are those of a law without dashpots; the viscosities are returned all the same.
#[test]
fn springs_come_without_dashpots() {
    let (mut damped, bodies) = cubes(-1e-3, 0.6);
    let (mut plain, _) = cubes(-1e-3, 0.0);
    // In contact already.
    damped.update(&bodies, &[], 0.0).unwrap();
    plain.update(&bodies, &[], 0.0).unwrap();
    assert!(
        damped.rigid_contacts()[0].normal_force > 1.001 * plain.rigid_contacts()[0].normal_force
    );
    let found = look(&mut damped, &bodies, 1e-4)[0];
    let expected = *plain.rigid_contacts()[0];
    assert!(!found.foreseen);
    assert!((found.normal_force / expected.normal_force - 1.0).abs() < 1e-12);
    assert!((found.friction - expected.friction).norm() < 1e-12 * expected.normal_force);
    let dashpots = found.dashpots();
    assert!(dashpots.normal > 0.0 && dashpots.tangential > 0.0 && dashpots.rocking[0] >= 0.0);
}

/// A gap that closes within the step is detected, a larger one is not.
#[test]
fn contacts_are_foreseen() {
    let (mut batch, bodies) = cubes(1e-3, 0.6);
    assert!(look(&mut batch, &bodies, 1e-3).is_empty());
    let found = look(&mut batch, &bodies, 3e-3);
    assert_eq!(found.len(), 1);
    assert!(found[0].foreseen);
    assert!((found[0].penetration() - 0.5e-3).abs() < 0.5e-3);
}

/// A cube B that tips about its edge, which lies in the top of A, at an angle to that face and at a given
/// rate.
fn tipping(bodies: &[Motion], angle: f64, rate: f64) -> Vec<Motion> {
    let half = 0.05 / 3.0_f64.sqrt();
    let cube = shape("P5", 0.1);
    let edge = Vector3::new(-half, 0.0, half - 1e-5);
    let turn = *Rotation3::from_axis_angle(&-Vector3::y_axis(), angle).matrix();
    let arm = turn * Vector3::new(half, 0.0, half);
    let mut body = placed(&cube, edge + arm, turn);
    body.angular_velocity = -Vector3::y() * rate;
    body.velocity = body.angular_velocity.cross(&arm);
    vec![bodies[0], body]
}

/// A face that comes down while its edge touches already is foreseen with its later force. If the body turns
/// slowly, the contact is the present one.
#[test]
fn a_face_that_comes_down_is_foreseen() {
    let dt = 1e-3;
    let tip = |rate: f64| {
        let (mut batch, bodies) = cubes(0.0, 0.6);
        let now = tipping(&bodies, 0.02, rate);
        let mut later = tipping(&bodies, 0.02 + rate * dt, rate);
        later[1].travelled = rate.abs() * dt * 0.1;
        batch.update(&now, &[], 0.0).unwrap();
        let view = |bodies| Snapshot {
            bodies,
            walls: &[],
            dt,
        };
        batch.update_springs(view(&now), view(&later)).unwrap();
        let found = *batch.rigid_contacts()[0];
        let force = |bodies: &[Motion]| {
            let (mut other, _) = cubes(0.0, 0.6);
            other.update(bodies, &[], 0.0).unwrap();
            other.rigid_contacts()[0].elastic_force
        };
        (found, force(&now), force(&later))
    };
    let (fast, now, later) = tip(-21.0);
    assert!(later > 100.0 * now, "{now} N, then {later} N");
    assert!(fast.foreseen);
    assert!((fast.elastic_force / later - 1.0).abs() < 1e-9, "{fast:?}");
    let (slow, now, _) = tip(-1e-3);
    assert!(!slow.foreseen);
    assert!((slow.elastic_force / now - 1.0).abs() < 1e-9, "{slow:?}");
}

/// Loads are the sums of the replaced forces; a wrong number of them is refused.
#[test]
fn forces_are_handed_back() {
    let (mut batch, bodies) = cubes(-1e-3, 0.6);
    let normal = look(&mut batch, &bodies, 1e-4)[0].normal;
    let force = ContactForce {
        normal: 7.0,
        friction: Vector3::new(1.0, 2.0, 0.0),
        torsion: 0.3,
        rocking: Vector3::new(0.1, -0.2, 0.0),
        slides: true,
    };
    batch.set_forces(&[force]).unwrap();
    let expected = force.friction + normal * force.normal;
    let loads = batch.loads();
    assert!((loads[1].total.force - expected).norm() < 1e-9, "{loads:?}");
    assert!((loads[0].total.force + expected).norm() < 1e-9, "{loads:?}");
    let error = batch.set_forces(&[force; 2]).unwrap_err();
    assert!(
        matches!(
            error,
            ContactError::StateCount {
                what: "contact",
                given: 2,
                expected: 1
            }
        ),
        "{error}"
    );
    assert!((batch.loads()[1].total.force - expected).norm() < 1e-9);
}
