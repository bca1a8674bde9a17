//! Motion in closed form: flight, prescribed motion, drag and local damping.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, add_heap, at, half_edge, parameters, run_until, solid, weightless,
};
use femdem_contact::{Wall, restitution};
use femdem_mesh::nalgebra::Vector3;
use femdem_solve::{BodySpec, Drive, Medium, World, WorldParameters};

/// One cube in a world without walls.
fn flyer(p: WorldParameters, velocity: Vector3<f64>, angular_velocity: Vector3<f64>) -> World {
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = BodySpec {
        velocity,
        angular_velocity,
        ..BodySpec::at_rest(shape, DENSITY, at(Vector3::new(0.0, 0.0, 2.0)))
    };
    world.add_body(spec).unwrap();
    world
}

#[test]
fn a_projectile_flies_its_parabola() {
    let (v, w) = (Vector3::new(2.0, -1.0, 3.0), Vector3::new(5.0, -20.0, 8.0));
    let mut world = flyer(parameters(1e6, 0.6, 0.6), v, w);
    run_until(&mut world, 1.0);
    let t = world.time();
    let place = Vector3::new(0.0, 0.0, 2.0) + v * t - Vector3::z() * (0.5 * G * t * t);
    let off = (world.position(0).unwrap() - place).norm();
    assert!(off < 1e-11, "it is {off:e} m off its parabola");
    let speed = v - Vector3::z() * (G * t);
    assert!((world.velocity(0).unwrap() - speed).norm() < 1e-11);
    // The inertia of a cube is isotropic: its spin is constant.
    assert!((world.angular_velocity(0).unwrap() - w).norm() < 1e-10);
    assert!(world.ledger().error().abs() < 1e-12 * world.ledger().initial.abs());
}

#[test]
fn drag_leads_to_the_terminal_velocity() {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.medium.drag = 20.0;
    let mut world = flyer(p, Vector3::zeros(), Vector3::zeros());
    run_until(&mut world, 1.0);
    let fall = -world.velocity(0).unwrap().z;
    let want = G / 20.0;
    assert!(
        (fall / want - 1.0).abs() < 1e-6,
        "{fall} instead of {want} m/s"
    );
    // The work of gravity is in the motion or was dissipated by the medium.
    let ledger = world.ledger();
    assert!(ledger.dissipated_medium > 0.0);
    assert!(ledger.error_relative().abs() < 1e-3);
}

#[test]
fn drag_decays_exactly() {
    let (v, w) = (Vector3::new(1.0, 2.0, -0.5), Vector3::new(3.0, -2.0, 7.0));
    let mut p = weightless(1e6, 0.6, 0.6);
    p.medium.drag = 3.0;
    let mut world = flyer(p, v, w);
    run_until(&mut world, 0.7);
    let left = (-3.0 * world.time()).exp();
    assert!((world.velocity(0).unwrap() - v * left).norm() < 1e-12);
    assert!((world.angular_velocity(0).unwrap() - w * left).norm() < 1e-11);
}

/// Cundall's damping takes a fixed share of every force against the motion: a body falls
/// with (1 - a) g and rises with (1 + a) g.
#[test]
fn local_damping_takes_its_share_of_the_force() {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.medium.local_damping = 0.3;
    let mut world = flyer(p, Vector3::zeros(), Vector3::zeros());
    run_until(&mut world, 0.5);
    let (t, v) = (world.time(), world.velocity(0).unwrap().z);
    // In the first half step there is no motion to resist.
    assert!(
        (v / (-0.7 * G * t) - 1.0).abs() < 1e-3,
        "{v} m/s after {t} s"
    );
    assert!(world.ledger().dissipated_medium > 0.0);
    let mut world = flyer(p, Vector3::z() * 10.0, Vector3::zeros());
    run_until(&mut world, 0.5);
    let (t, v) = (world.time(), world.velocity(0).unwrap().z);
    assert!(
        (v - (10.0 - 1.3 * G * t)).abs() < 1e-10,
        "{v} m/s after {t} s"
    );
    assert!(world.ledger().dissipated_medium > 0.0);
}

/// A cube on the floor at rest, with the depth it has sunk in.
fn resting(p: WorldParameters) -> (World, f64) {
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let pose = at(Vector3::new(0.0, 0.0, half_edge()));
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, pose))
        .unwrap();
    run_until(&mut world, 0.5);
    let depth = half_edge() - world.position(0).unwrap().z;
    (world, depth)
}

/// A cube on a slowly shaken floor moves with it: the spring carries m (g + a). The dashpot uses the floor's
/// velocity half a step ahead of the body's, hence the small step.
#[test]
fn a_body_follows_a_slow_floor() {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.time_step.safety = 0.3;
    let (mut world, depth) = resting(p);
    let weight = G * world.mass(0).unwrap();
    // F = 2 p A delta/h: the face of edge 2 h on the wall.
    let want = weight / (2.0 * 1e6 * 4.0 * half_edge());
    assert!(
        (depth / want - 1.0).abs() < 0.01,
        "it sinks in by {depth:e} instead of {want:e} m"
    );
    let start = world.time() + 0.01;
    let (stroke, frequency) = (0.05, 1.0);
    let drive = Drive::Shake {
        stroke: Vector3::z() * stroke,
        frequency,
        start,
        periods: 2,
    };
    world.drive_wall(0, drive).unwrap();
    let omega = std::f64::consts::TAU * frequency;
    let (mut worst, mut highest) = (0.0_f64, 0.0_f64);
    run_until(&mut world, start + 0.1);
    while world.time() < start + 2.0 {
        world.step().unwrap();
        let phase = omega * (world.time() - start);
        let floor = 0.5 * stroke * (1.0 - phase.cos());
        let acceleration = 0.5 * stroke * omega * omega * phase.cos();
        let sunk = half_edge() - (world.position(0).unwrap().z - floor);
        worst = worst.max((sunk / depth - (1.0 + acceleration / G)).abs());
        highest = highest.max(floor);
    }
    assert!((highest / stroke - 1.0).abs() < 1e-3);
    assert!(worst < 0.02, "the spring is off by {worst} of its rest");
}

/// A cube on a floor that suddenly moves at speed v slides for v/(mu g) and then moves with it, at a distance
/// of v^2/(2 mu g) behind.
#[test]
fn a_body_on_a_belt_lags_by_its_sliding() {
    let (mut world, _) = resting(parameters(1e6, 0.4, 0.6));
    let from = world.position(0).unwrap().x;
    let (v, start) = (1.0, world.time());
    let drive = Drive::Linear {
        velocity: Vector3::x() * v,
        start,
        end: start + 2.0,
    };
    world.drive_wall(0, drive).unwrap();
    run_until(&mut world, start + 1.0);
    let lag = v * (world.time() - start) - (world.position(0).unwrap().x - from);
    let want = v * v / (2.0 * 0.4 * G);
    assert!(
        (lag / want - 1.0).abs() < 0.01,
        "it lags by {lag} instead of {want} m"
    );
    let ledger = world.ledger();
    // The work of the belt is mu m g v for v/(mu g); half of it becomes motion, half heat.
    let energy = 0.5 * world.mass(0).unwrap() * v * v;
    assert!((ledger.work_in / (2.0 * energy) - 1.0).abs() < 0.01);
    assert!((ledger.dissipated_friction / energy - 1.0).abs() < 0.02);
    assert!(ledger.error_relative().abs() < 1e-3, "{ledger:?}");
}

/// A driven cube hits a free one, which leaves with (1 + e) times the speed.
#[test]
fn a_driven_body_hits_like_an_infinite_mass() {
    let mut p = weightless(1e7, 0.0, 0.3);
    p.time_step.safety = 0.05;
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = |x: f64| BodySpec::at_rest(shape, DENSITY, at(Vector3::x() * x));
    let velocity = Vector3::x() * 0.5;
    let drive = Drive::Linear {
        velocity,
        start: 0.0,
        end: 10.0,
    };
    let ram = world.add_driven_body(spec(0.0), drive).unwrap();
    let free = world.add_body(spec(2.0 * half_edge() + 0.01)).unwrap();
    run_until(&mut world, 0.05);
    let want = (1.0 + restitution(0.3)) * 0.5;
    let got = world.velocity(free).unwrap().x;
    assert!(
        (got / want - 1.0).abs() < 0.01,
        "{got} instead of {want} m/s"
    );
    assert!((world.position(ram).unwrap().x - 0.5 * world.time()).abs() < 1e-12);
    let ledger = world.ledger();
    assert!(
        ledger.work_in > 0.0 && ledger.error_relative().abs() < 1e-3,
        "{ledger:?}"
    );
}

/// Bodies in a shaken, rough, damped box: the ledger closes with the work of the drive.
#[test]
fn the_ledger_of_a_shaken_box_closes() {
    let mut p = parameters(1e6, 0.5, 0.3);
    p.time_step.safety = 0.3;
    let mut world = World::new(p).unwrap();
    let stroke = Vector3::new(0.5, 0.2, 1.0) * (0.3 * D);
    let drive = Drive::Shake {
        stroke,
        frequency: 10.0,
        start: 0.05,
        periods: 4,
    };
    for wall in Wall::closed_box(Vector3::zeros(), Vector3::repeat(3.2 * D)).unwrap() {
        world.add_wall(wall, drive).unwrap();
    }
    add_heap(&mut world, 20, 3);
    run_until(&mut world, 0.5);
    let ledger = world.ledger();
    assert!(
        ledger.work_in.abs() > 0.1 * ledger.dissipated(),
        "{ledger:?}"
    );
    let error = ledger.error_relative();
    assert!(
        error.abs() < 1e-3,
        "the books are off by {error:e}: {ledger:?}"
    );
}

/// A medium that is set later acts from then on.
#[test]
fn the_medium_can_be_changed() {
    let mut world = flyer(weightless(1e6, 0.6, 0.6), Vector3::x(), Vector3::zeros());
    run_until(&mut world, 0.2);
    assert!((world.velocity(0).unwrap().x - 1.0).abs() < 1e-14);
    let from = world.time();
    world
        .set_medium(Medium {
            drag: 5.0,
            local_damping: 0.0,
        })
        .unwrap();
    run_until(&mut world, 0.4);
    let want = (-5.0 * (world.time() - from)).exp();
    assert!((world.velocity(0).unwrap().x / want - 1.0).abs() < 1e-10);
}
