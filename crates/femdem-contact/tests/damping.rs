//! The normal dashpot never pulls and never adds energy, for any contact and any motion.

use crate::common::Stream;
use crate::common::pack::{placed, shape};
use femdem_contact::{ContactBatch, ContactLaw, ContactParameters, Frame, Motion, Wall};
use femdem_mesh::nalgebra::Vector3;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, max_global_rejects: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damping_takes_energy_and_never_pulls(
        ids in (0..18_usize, 0..18_usize),
        zeta in 0.0..0.707_f64,
        share in 0.01..0.4_f64,
        speed in -4.0..2.0_f64,
        floor in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let names = ["P1", "P2", "P3", "P4", "P5", "A1", "A2", "A3", "A4", "A5", "A6", "A7", "A8", "A9", "A10", "A11", "A12", "A13"];
        let law = ContactLaw::new(ContactParameters { damping_ratio: zeta, friction: 0.0, ..ContactParameters::default() });
        let mut batch = ContactBatch::new(law.unwrap());
        let mut stream = Stream(seed);
        let direction = if floor { Vector3::z() } else { stream.vector().normalize() };
        let (mut bodies, mut reach): (Vec<Motion>, f64) = (Vec::new(), 0.0);
        for (k, id) in [ids.0, ids.1].into_iter().enumerate() {
            if floor && k == 0 {
                continue;
            }
            let solid = shape(names[id], 1.0);
            let rotation = stream.rotation();
            let sign = if k == 0 { 1.0 } else { -1.0 };
            reach += solid.support(&(rotation.tr_mul(&direction) * sign));
            let position = direction * if k == 0 { 0.0 } else { reach * (1.0 - share) };
            let mut body = placed(&solid, position, rotation);
            body.velocity = stream.vector() * 10.0_f64.powf(speed);
            body.angular_velocity = stream.vector() * 10.0_f64.powf(speed);
            bodies.push(body);
            let index = batch.add_shape(solid);
            batch.add_body(index).unwrap();
        }
        let mut walls = Vec::new();
        if floor {
            batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
            walls.push(Motion::fixed(Frame::identity()));
        }
        batch.update(&bodies, &walls, 1e-3).unwrap();
        prop_assume!(!batch.rigid_contacts().is_empty());
        let (mut power, mut size) = (0.0, 0.0);
        for (load, body) in batch.loads().iter().zip(&bodies) {
            power += load.damping.power(&body.velocity, &body.angular_velocity);
            size += load.damping.force.norm() * body.velocity.norm()
                + load.damping.torque.norm() * body.angular_velocity.norm();
        }
        prop_assert!(power <= 1e-10 * size, "it feeds {power:e} W in");
        for c in batch.rigid_contacts() {
            prop_assert!(c.normal_force >= 0.0, "it pulls");
            let into_b = c.force_on_b().dot(&c.normal);
            prop_assert!(into_b >= 0.0);
            if zeta == 0.0 {
                prop_assert_eq!(c.normal_force, c.elastic_force);
            }
        }
    }
}

/// A cube that moves towards and away from the floor: the dashpot's share of the elastic force is 2 zeta v
/// sqrt(m/(2U)), and at most cancels the force. The time step is 0, so the velocity lag needs no correction.
#[test]
fn the_dashpot_of_a_face_contact() {
    let (zeta, speed, depth) = (0.3, 0.2, 1e-2);
    let law = ContactLaw::new(ContactParameters {
        damping_ratio: zeta,
        friction: 0.0,
        ..ContactParameters::default()
    });
    let mut batch = ContactBatch::new(law.unwrap());
    let cube = shape("P5", 3.0_f64.sqrt());
    let index = batch.add_shape(cube.clone());
    batch.add_body(index).unwrap();
    batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
    let mut body = placed(
        &cube,
        Vector3::z() * (0.5 - depth),
        femdem_mesh::nalgebra::Matrix3::identity(),
    );
    for (v, closing) in [(-speed, 1.0), (speed, -1.0)] {
        body.velocity = Vector3::z() * v;
        batch
            .update(&[body], &[Motion::fixed(Frame::identity())], 0.0)
            .unwrap();
        let c = batch.rigid_contacts()[0];
        // U = 2 p A delta^2/(2 h) for a face of A = 1 m^2, h = 1/2 m from the centroid.
        let elastic = 2.0 * 1e6 * depth * depth / (2.0 * 0.5);
        close(c.energy, elastic, 0.02);
        let want = closing * 2.0 * zeta * speed / (2.0 * c.energy * body.inverse_mass).sqrt();
        close(c.normal_force / c.elastic_force - 1.0, want.max(-1.0), 1e-9);
    }
}

fn close(got: f64, want: f64, share: f64) {
    assert!((got / want - 1.0).abs() < share, "{got} instead of {want}");
}
