//! Friction of a patch under prescribed motion: a cube of unit edge on a floor, or on
//! another cube.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::pack::{placed, shape};
use crate::common::{Stream, turned};
use femdem_contact::{
    ContactBatch, ContactLaw, ContactParameters, ConvexShape, Frame, Motion, RigidContact, Wall,
};
use femdem_mesh::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::sync::Arc;

/// Depth of the overlap, over an edge of 1 m.
const DEPTH: f64 = 1e-3;

fn law(friction: f64, tangential_damping: f64) -> ContactParameters {
    ContactParameters {
        penalty: 1e6,
        friction,
        damping_ratio: 0.0,
        tangential_damping,
        ..ContactParameters::default()
    }
}

/// Cubes of unit edge, one on another, or on a floor through the origin.
struct Rig {
    batch: ContactBatch,
    walls: Vec<Motion>,
    cube: Arc<ConvexShape>,
}

impl Rig {
    fn new(parameters: ContactParameters, cubes: usize, floor: bool) -> Self {
        let mut batch = ContactBatch::new(ContactLaw::new(parameters).unwrap());
        let cube = shape("P5", 3.0_f64.sqrt());
        let id = batch.add_shape(cube.clone());
        for _ in 0..cubes {
            batch.add_body(id).unwrap();
        }
        let mut walls = Vec::new();
        if floor {
            batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0).unwrap());
            walls.push(Motion::fixed(Frame::identity()));
        }
        Self { batch, walls, cube }
    }

    /// The one contact after an update.
    fn update(&mut self, bodies: &[Motion], dt: f64) -> RigidContact {
        self.batch.update(bodies, &self.walls, dt).unwrap();
        let contacts = self.batch.rigid_contacts();
        assert_eq!(contacts.len(), 1);
        *contacts[0]
    }

    /// A cube that rests `DEPTH` deep on the floor, its centroid `x` aside.
    fn resting(&self, x: Vector3<f64>) -> Motion {
        let position = Vector3::new(x.x, x.y, 0.5 - DEPTH);
        placed(&self.cube, position, Matrix3::identity())
    }
}

/// Two cubes with a stretched, twisted patch between them rotate as one rigid body for ten thousand steps:
/// the friction rotates with them.
#[test]
fn rigid_motion_turns_friction_with_the_pair() {
    let mut rig = Rig::new(law(0.6, 0.0), 2, false);
    let mut pair =
        [0.0, 1.0 - DEPTH].map(|z| placed(&rig.cube, Vector3::z() * z, Matrix3::identity()));
    rig.update(&pair, 0.0);
    // A tangential stretch of a third of the slip limit, and a twist.
    let twist = 1e-4;
    pair[1].frame = turned(&pair[1].frame, &Vector3::z(), twist);
    pair[1].frame.position += Vector3::new(2.0e-4, 1.0e-4, 0.0);
    pair[1].angular_velocity = Vector3::z() * twist;
    pair[1].velocity = Vector3::new(2.0e-4, 1.0e-4, 0.0);
    pair[1].travelled = 1e-3;
    let start = rig.update(&pair, 1.0);
    assert!(!start.slides && start.friction.norm() > 0.1 * start.normal_force);
    assert!(start.torsion.abs() > 0.0);
    let axis = Vector3::new(1.0, 2.0, -0.7).normalize();
    let about = Vector3::new(3.0, -1.0, 0.5);
    let (dt, rate) = (1e-3, 2.0);
    let still = pair;
    let mut worst = 0.0_f64;
    for step in 1..=10_000_u32 {
        let angle = rate * dt * f64::from(step);
        let turn = UnitQuaternion::from_scaled_axis(axis * angle).to_rotation_matrix();
        for (body, from) in pair.iter_mut().zip(&still) {
            let arm = turn * (from.frame.position - about);
            body.frame.position = about + arm;
            body.frame.rotation = turn.into_inner() * from.frame.rotation;
            body.angular_velocity = axis * rate;
            body.velocity = body.angular_velocity.cross(&arm);
            body.travelled += rate * dt * 10.0;
        }
        let now = rig.update(&pair, dt);
        let off = (now.friction - turn * start.friction).norm() / start.friction.norm();
        let twisted = (now.torsion / start.torsion - 1.0).abs();
        worst = worst.max(off).max(twisted);
    }
    assert!(worst < 1e-10, "the friction is off by {worst:e}");
}

/// Work of the friction on the cube along a closed path of its centroid, and the largest
/// energy in the spring. Trapezia are exact for a linear spring.
fn closed_path(
    rig: &mut Rig,
    path: impl Fn(f64) -> Vector3<f64>,
    steps: u32,
    rounds: u32,
) -> (f64, f64) {
    let mut body = rig.resting(path(0.0));
    let mut last = rig.update(&[body], 0.0);
    let (mut work, mut stored) = (0.0, 0.0_f64);
    for step in 1..=steps * rounds {
        let to = path(f64::from(step % steps) / f64::from(steps));
        let from = body.frame.position;
        body.frame.position = Vector3::new(to.x, to.y, from.z);
        let moved = body.frame.position - from;
        body.travelled += moved.norm();
        // Steps of unit time.
        body.velocity = moved;
        let now = rig.update(&[body], 1.0);
        work += 0.5 * (now.friction + last.friction).dot(&moved);
        stored = stored.max(now.spring_energy);
        last = now;
    }
    (work, stored)
}

#[test]
fn a_closed_stick_loop_does_no_work() {
    let mut rig = Rig::new(law(0.6, 0.0), 1, true);
    let path = |s: f64| {
        let (sin, cos) = (std::f64::consts::TAU * s).sin_cos();
        Vector3::new(1.0 - cos, 0.7 * sin, 0.0) * 1e-4
    };
    let (work, stored) = closed_path(&mut rig, path, 1000, 3);
    assert!(stored > 0.0);
    assert!(
        work.abs() < 1e-12 * stored,
        "a net work of {work:e} J, {stored:e} J stored"
    );
}

/// A cube of 1 m on a floor, pushed aside while it sticks: the force per displacement is r K, with K the
/// normal stiffness dF/d(delta) of F = 2 p A delta/h, for every ratio r.
#[test]
fn tangential_stiffness_goes_by_the_ratio() {
    let normal = 2.0 * 1e6 / 0.5;
    let way = 1e-4;
    for ratio in [0.4, 0.8, 1.6] {
        let parameters = ContactParameters {
            tangential_ratio: ratio,
            ..law(0.6, 0.0)
        };
        let mut rig = Rig::new(parameters, 1, true);
        rig.update(&[rig.resting(Vector3::zeros())], 0.0);
        let contact = rig.update(&[rig.resting(Vector3::x() * way)], 1.0);
        assert!(!contact.slides);
        let got = -contact.friction.x / way;
        assert!(
            (got / (ratio * normal) - 1.0).abs() < 0.01,
            "{got} N/m at ratio {ratio}"
        );
    }
}

/// Friction over normal force of a cube pushed far aside on a floor, or on another cube.
fn mobilised(parameters: ContactParameters, floor: bool) -> f64 {
    let mut rig = Rig::new(parameters, if floor { 1 } else { 2 }, floor);
    let mut bodies = vec![rig.resting(Vector3::zeros())];
    if !floor {
        let below = Vector3::z() * (bodies[0].frame.position.z - 1.0 + DEPTH);
        bodies.insert(0, placed(&rig.cube, below, Matrix3::identity()));
    }
    rig.update(&bodies, 0.0);
    if let Some(upper) = bodies.last_mut() {
        upper.frame.position.x += 0.05;
        upper.travelled += 0.05;
    }
    let contact = rig.update(&bodies, 1.0);
    contact.friction.norm() / contact.normal_force
}

#[test]
fn walls_have_their_own_friction() {
    for (between, wall) in [(0.6, 0.0), (0.0, 0.6), (0.5, 0.2)] {
        let parameters = ContactParameters {
            wall_friction: Some(wall),
            ..law(between, 0.0)
        };
        for (floor, want) in [(true, wall), (false, between)] {
            let got = mobilised(parameters, floor);
            assert!((got - want).abs() < 1e-12, "{got} instead of {want}");
        }
    }
    assert!((mobilised(law(0.4, 0.0), true) - 0.4).abs() < 1e-12);
}

/// Sliding to and fro with amplitude A dissipates 4 mu F (A - mu F/k) in every cycle.
#[test]
fn cyclic_slip_takes_the_known_energy() {
    let friction = 0.3;
    let mut rig = Rig::new(law(friction, 0.0), 1, true);
    let contact = rig.update(&[rig.resting(Vector3::zeros())], 0.0);
    let (force, k) = (contact.normal_force, 0.8 * contact.foundation.stiffness);
    // A face of A = 1 m^2, h = 1/2 m from the centroid: F = 2 p A delta/h.
    let want = 2.0 * 1e6 * DEPTH / 0.5;
    assert!(
        (force / want - 1.0).abs() < 0.01,
        "{force} instead of {want} N"
    );
    let slip = friction * force / k;
    for amplitude in [2.0 * slip, 10.0 * slip] {
        let path = |s: f64| Vector3::x() * (amplitude * (std::f64::consts::TAU * s).sin());
        let mut rig = Rig::new(law(friction, 0.0), 1, true);
        let (first, _) = closed_path(&mut rig, path, 4000, 1);
        let mut rig = Rig::new(law(friction, 0.0), 1, true);
        let (both, _) = closed_path(&mut rig, path, 4000, 2);
        let got = first - both;
        let want = 4.0 * friction * force * (amplitude - slip);
        assert!(
            (got / want - 1.0).abs() < 0.01,
            "{got:e} instead of {want:e} J"
        );
    }
}

/// Mean distance of a square of unit edge from its centre:
/// (sqrt 2 + ln(1 + sqrt 2))/6.
fn mean_distance() -> f64 {
    (2.0_f64.sqrt() + 1.0_f64.asinh()) / 6.0
}

#[test]
fn a_spinning_face_reaches_the_moment_of_its_shape() {
    let mut rig = Rig::new(law(0.4, 0.6), 1, true);
    let mut body = rig.resting(Vector3::zeros());
    body.angular_velocity = Vector3::z() * 0.05;
    for _ in 0..400 {
        body.frame = turned(&body.frame, &Vector3::z(), 0.05 * 0.1);
        body.travelled += 0.01;
        let c = rig.update(&[body], 0.1);
        let most = 0.4 * c.normal_force * mean_distance();
        assert!(c.torsion.abs() <= 1.01 * most);
        assert!(c.torsion <= 0.0, "it drives the spin");
    }
    let c = rig.update(&[body], 0.1);
    let most = 0.4 * c.normal_force * mean_distance();
    assert!(c.slides);
    assert!(
        (c.torsion / -most - 1.0).abs() < 0.01,
        "{} of {most}",
        c.torsion
    );
}

/// Force and moment over mu N of Coulomb's law on a unit square that slides and spins.
fn coulomb(speed: f64, spin: f64) -> [f64; 2] {
    const N: i32 = 100;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(N) - 0.5;
    let (mut force, mut moment) = (0.0, 0.0);
    for (x, y) in (0..N * N).map(|i| (at(i / N), at(i % N))) {
        let v = [speed - spin * y, spin * x];
        let rate = 1.0 / (v[0].hypot(v[1]) * f64::from(N * N));
        force += v[0] * rate;
        moment += (x * v[1] - y * v[0]) * rate;
    }
    [force, moment]
}

/// Slip and spin together are resisted as Coulomb's law over the face says.
#[test]
fn slip_with_spin_is_shared_as_over_the_face() {
    for (speed, spin) in [(1.0, 0.1), (1.0, 3.0), (0.3, 3.0), (0.1, 3.0)] {
        let mut rig = Rig::new(law(0.4, 0.0), 1, true);
        let mut body = rig.resting(Vector3::zeros());
        let dt = 1e-3;
        let mut last = [0.0; 2];
        for _ in 0..300 {
            body.velocity = Vector3::x() * speed;
            body.angular_velocity = Vector3::z() * spin;
            body.frame.position += body.velocity * dt;
            body.frame = turned(&body.frame, &Vector3::z(), spin * dt);
            body.travelled += (speed + spin) * dt;
            let c = rig.update(&[body], dt);
            let most = 0.4 * c.normal_force;
            last = [c.friction.norm() / most, -c.torsion / most];
        }
        let want = coulomb(speed, spin);
        assert!((last[0] - want[0]).abs() < 0.02, "{last:?} {want:?}");
        let off = (last[1] - want[1]).abs() / mean_distance();
        assert!(off < 0.02, "{last:?} {want:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    /// For any motion of two bodies, friction never exceeds mu times the normal force and lies in the contact
    /// plane.
    #[test]
    fn friction_stays_within_coulombs_bound(
        mu in 0.0..1.0_f64,
        zeta in 0.0..0.7_f64,
        eta in 0.0..1.0_f64,
        seed in any::<u64>(),
    ) {
        let parameters = ContactParameters { damping_ratio: zeta, ..law(mu, eta) };
        let mut rig = Rig::new(parameters, 2, false);
        let mut stream = Stream(seed);
        let mut bodies = [0.0, 0.9].map(|z| placed(&rig.cube, Vector3::z() * z, stream.rotation()));
        let (dt, mut seen) = (1e-3, 0);
        for step in 0..300 {
            if step % 20 == 0 {
                bodies[1].velocity = stream.vector() * 4.0;
                bodies[1].angular_velocity = stream.vector() * 8.0;
            }
            crate::common::pack::advance(&mut bodies[1], &rig.cube, dt);
            rig.batch.update(&bodies, &[], dt).unwrap();
            for c in rig.batch.rigid_contacts() {
                let most = mu * c.normal_force;
                seen += 1;
                prop_assert!(c.normal_force >= 0.0);
                prop_assert!(c.friction.norm() <= most * (1.0 + 1e-12));
                prop_assert!(c.friction.dot(&c.normal).abs() <= 1e-9 * most);
            }
        }
        prop_assume!(seen > 0);
    }
}

/// Energy gained from the friction of a cube on the floor in a cycle of rocking on its face by `rock` (rad)
/// out of phase with turning about the normal by `turn` (rad), over the largest energy of its springs. They
/// are stretched throughout.
fn given_by_rocking(rock: f64, turn: f64) -> f64 {
    const STEPS: i32 = 2000;
    let mut rig = Rig::new(law(1e3, 0.0), 1, true);
    let place = |rig: &Rig, i: i32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(STEPS)).sin_cos();
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn * (1.0 - cos))
            * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), rock * sin);
        placed(
            &rig.cube,
            Vector3::z() * (0.5 - 10.0 * DEPTH),
            rotation.to_rotation_matrix().into_inner(),
        )
    };
    let mut now = place(&rig, 0);
    rig.update(&[now], 0.0);
    let (mut friction, mut first) = (rig.batch.loads()[0].friction, 0.0);
    let (mut work, mut largest) = (0.0, 0.0_f64);
    for i in 1..=2 * STEPS {
        let mut next = place(&rig, i);
        let turned = next.frame.rotation * now.frame.rotation.transpose();
        let turned = UnitQuaternion::from_matrix(&turned).scaled_axis();
        // The contact point stays in place, except for a push at the start.
        let arm = rig.batch.rigid_contacts()[0].arm_b;
        let mut moved = -turned.cross(&arm);
        if i == 1 {
            moved += Vector3::new(1e-3, 2e-3, 0.0);
        }
        next.frame.position.x = now.frame.position.x + moved.x;
        next.frame.position.y = now.frame.position.y + moved.y;
        let moved = next.frame.position - now.frame.position;
        next.travelled = now.travelled + moved.norm() + turned.norm();
        (next.velocity, next.angular_velocity) = (moved, turned);
        let contact = rig.update(&[next], 1.0);
        let before = std::mem::replace(&mut friction, rig.batch.loads()[0].friction);
        assert!(!contact.slides);
        // The first cycle brings the springs into a periodic state.
        if i > STEPS {
            work += 0.5 * (friction.power(&moved, &turned) + before.power(&moved, &turned));
            largest = largest.max(contact.spring_energy);
        } else {
            first = contact.spring_energy;
        }
        now = next;
    }
    let last = rig.batch.rigid_contacts()[0].spring_energy;
    (work + last - first) / largest
}

/// In either sense of a cycle of rocking and turning under stretched springs, they never give more energy
/// than they hold.
#[test]
fn friction_feeds_no_rocking() {
    for rock in [2e-3, -2e-3, 5e-3, -5e-3] {
        for turn in [0.05, 0.3] {
            let given = given_by_rocking(rock, turn);
            assert!(given < 1e-5, "{rock} rad, {turn} rad: {given:e}");
        }
    }
}
