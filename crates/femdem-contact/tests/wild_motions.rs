//! Motions out of the range of the numbers: an update gives finite loads or an error that names a body or a wall,
//! and never panics.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::pack::{placed, shape};
use crate::common::tets;
use femdem_contact::{
    BodyShape, ContactBatch, ContactError, ContactLaw, ContactParameters, Field, Frame, Load,
    Motion, Snapshot, Wall, Wrench,
};
use femdem_mesh::nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

/// Two convex bodies, a mesh and a third convex body, over a floor and within a mantle.
fn batch() -> ContactBatch {
    let law = ContactLaw::new(ContactParameters {
        penalty: 1e6,
        rolling_friction: 0.1,
        ..ContactParameters::default()
    });
    let mut batch = ContactBatch::new(law.unwrap());
    let shapes: [BodyShape; 4] = [
        shape("P5", 1.0).into(),
        shape("A10", 1.2).into(),
        tets::body(&tets::l_block(), Field::Body).into(),
        shape("P1", 0.9).into(),
    ];
    for shape in shapes {
        let id = batch.add_shape(shape);
        batch.add_body(id).unwrap();
    }
    batch.add_wall(Wall::half_space("floor", Vector3::z(), -0.4).unwrap());
    batch.add_wall(Wall::cylinder("mantle", 1.6, 12).unwrap());
    batch
}

/// Bodies and walls at rest where they touch.
fn still() -> (Vec<Motion>, Vec<Motion>) {
    let solid = shape("P5", 1.0);
    let at = |x, y, z| placed(&solid, Vector3::new(x, y, z), Matrix3::identity());
    let bodies = vec![
        at(0.0, 0.0, 0.0),
        at(0.6, 0.1, 0.2),
        at(-0.6, 0.3, 0.3),
        at(0.1, 0.2, 0.6),
    ];
    (bodies, vec![Motion::fixed(Frame::identity()); 2])
}

fn finite(wrench: &Wrench) -> bool {
    wrench
        .force
        .iter()
        .chain(&wrench.torque)
        .all(|x| x.is_finite())
}

fn sound(load: &Load) -> bool {
    finite(&load.total)
        && finite(&load.friction)
        && finite(&load.damping)
        && finite(&load.viscous)
        && load.normal_sum.is_finite()
}

/// Checks what an update of the batch left, and returns the body that an error names.
fn check(batch: &ContactBatch, result: Result<(), ContactError>) -> Option<usize> {
    match result {
        Ok(()) => {
            assert!(batch.loads().iter().all(sound), "{:?}", batch.loads());
            assert!(
                batch.wall_loads().iter().all(sound),
                "{:?}",
                batch.wall_loads()
            );
            let totals = batch.totals();
            assert!((totals.energy + totals.spring_energy).is_finite());
            None
        }
        Err(error @ ContactError::LoadNotFinite { body, .. }) => {
            assert!(
                error.to_string().contains(&format!("body {body} ")),
                "{error}"
            );
            Some(body)
        }
        Err(ContactError::Wall { name, .. }) => {
            assert!(["floor", "mantle"].contains(&name.as_str()));
            None
        }
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_speed_that_overflows_names_the_lowest_body_of_the_contact() {
    let (mut bodies, walls) = still();
    let mut batch = batch();
    batch.update(&bodies, &walls, 1e-4).unwrap();
    assert!(batch.rigid_contacts_of(1).any(|c| c.normal_force > 0.0));
    bodies[1].velocity = Vector3::new(-1e308, 1e308, -1e308);
    let result = batch.update(&bodies, &walls, 1e-4);
    assert_eq!(check(&batch, result), Some(0));
    // Alone among the awake, the second body is the one to be named.
    let mut batch = self::batch();
    for body in [0, 2, 3] {
        batch.set_awake(body, false);
    }
    let result = batch.update(&bodies, &walls, 1e-4);
    assert_eq!(check(&batch, result), Some(1));
}

fn wild() -> impl Strategy<Value = f64> {
    let size = prop_oneof![
        3 => Just(0.0),
        2 => -1.0..1.0_f64,
        1 => Just(1e-300),
        1 => Just(1e100),
        1 => Just(1e160),
        1 => Just(1e300),
        1 => Just(f64::MAX),
    ];
    (size, any::<bool>()).prop_map(|(x, minus)| if minus { -x } else { x })
}

/// What is changed of one motion: position, velocity, angular velocity, rotation, inverse mass, travel.
fn spoil() -> impl Strategy<Value = (usize, u8, [f64; 3])> {
    (0_usize..6, 0_u8..6, [wild(), wild(), wild()])
}

fn apply(motion: &mut Motion, what: u8, values: [f64; 3]) {
    let vector = Vector3::from(values);
    match what {
        0 => motion.frame.position += vector,
        1 => motion.velocity += vector,
        2 => motion.angular_velocity += vector,
        3 => motion.frame.rotation.set_column(0, &vector),
        4 => {
            motion.inverse_mass = vector.x.abs();
            motion.inverse_inertia_max = vector.y.abs();
            motion.inverse_inertia = Matrix3::identity() * vector.y.abs();
        }
        _ => motion.travelled += vector.x.abs(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn loads_are_finite_or_refused(
        steps in prop::collection::vec(prop::collection::vec(spoil(), 1..4), 1..4),
        dt in prop_oneof![Just(0.0), Just(1e-4), Just(1e300)],
        springs in any::<bool>(),
    ) {
        let (mut bodies, mut walls) = still();
        let mut batch = batch();
        for spoilt in steps {
            for (at, what, values) in spoilt {
                let motion = match at.checked_sub(4) {
                    Some(wall) => &mut walls[wall],
                    None => &mut bodies[at],
                };
                let kept = *motion;
                apply(motion, what, values);
                // What is not finite itself is refused before.
                if format!("{motion:?}").contains("inf") || format!("{motion:?}").contains("NaN") {
                    *motion = kept;
                }
            }
            let view = Snapshot { bodies: &bodies, walls: &walls, dt };
            let result = if springs {
                batch.update_springs(view, view)
            } else {
                batch.update(&bodies, &walls, dt)
            };
            let failed = result.is_err();
            check(&batch, result);
            if failed {
                break;
            }
        }
    }
}
