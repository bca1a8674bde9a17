//! Walls and bodies that turn: bodies on them or in their way follow, and the ledger closes.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, add_mesh, at, parameters, pose, run_until, turned, weightless,
};
use crate::meshes;
use femdem_contact::MeshWall;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Point3, Vector3};
use femdem_mesh::shapes::{Shape, Sphere};
use femdem_mesh::tet::RevolvedShell;
use femdem_mesh::{Pose, Rotation, TetMesh};
use femdem_solve::{BodySpec, Drive, World};

/// What the moving plate is in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Plate {
    Plane,
    MeshWall,
    Body,
}

/// A cube on a plate at z = 0 that follows a drive.
fn cube_on_a_plate(plate: Plate, at: Vector3<f64>, drive: Drive) -> (World, u32) {
    let mut p = parameters(1e7, 0.8, 0.5);
    p.time_step.safety = 0.2;
    let mut world = World::new(p).unwrap();
    let slab = meshes::block(
        Vector3::new(-0.5, -0.5, -0.2),
        Vector3::new(1.0, 1.0, 0.0),
        3,
    );
    match plate {
        Plate::Plane => {
            add_floor(&mut world, drive);
        }
        Plate::MeshWall => {
            let wall = MeshWall::solid("plate", &slab);
            world.add_wall(wall, drive).unwrap();
        }
        Plate::Body => {
            let shape = add_mesh(&mut world, "plate", &slab);
            let spec = BodySpec::at_rest(shape, DENSITY, Pose::identity());
            world.add_driven_body(spec, drive).unwrap();
        }
    }
    let shape = world.add_shape("P5", &crate::common::solid("P5")).unwrap();
    let place = at + Vector3::z() * crate::common::half_edge();
    let spec = BodySpec::at_rest(shape, DENSITY, pose(place, Rotation::identity()));
    let body = world.add_body(spec).unwrap();
    (world, body)
}

/// A plane that rocks carries a cube along in the same way for any position of the origin.
#[test]
fn a_rocking_plane_far_from_the_origin() {
    let ridden = |shift: Vector3<f64>| {
        let drive = Drive::Rock {
            axis: Vector3::y(),
            point: shift - Vector3::x() * 0.2,
            stroke: 0.1,
            frequency: 10.0,
            start: 0.0,
            periods: 1,
        };
        let (mut world, body) = cube_on_a_plate(Plate::Plane, shift, drive);
        run_until(&mut world, 0.1);
        let l = world.ledger();
        let place = world.position(body).unwrap() - shift;
        (place, l.dissipated_friction + l.dissipated_damping)
    };
    let (here, far) = (ridden(Vector3::zeros()), ridden(Vector3::x() * 1000.0));
    let off = (here.0 - far.0).norm();
    assert!(off < 1e-8, "{off:e} m");
    assert!((far.1 / here.1 - 1.0).abs() < 1e-6, "{here:?} {far:?}");
}

/// A cube on a plate that oscillates smoothly about an axis beside it moves with it, without slip, and comes
/// back; and the ledger closes.
#[test]
fn a_body_rides_on_a_swinging_plate() {
    for plate in [Plate::Plane, Plate::MeshWall, Plate::Body] {
        let (point, at) = (Vector3::new(0.3, -0.1, 0.0), Vector3::new(0.45, 0.0, 0.0));
        let (stroke, frequency, start) = (1.0, 0.5, 0.1);
        let drive = Drive::Rock {
            axis: Vector3::z() * 2.0,
            point,
            stroke,
            frequency,
            start,
            periods: 1,
        };
        let (mut world, body) = cube_on_a_plate(plate, at, drive);
        for (time, angle) in [(start + 0.5 / frequency, stroke), (2.3, 0.0)] {
            while world.time() < time {
                world.step().unwrap();
            }
            let turned = Rotation::from_axis_angle(&Vector3::z_axis(), angle);
            let expected = point + turned * (at - point);
            let off = (world.position(body).unwrap() - expected).xy().norm();
            assert!(off < 1e-3 * (at - point).norm(), "{plate:?}: off by {off}");
            let turn = world.pose(body).unwrap().rotation.angle_to(&turned);
            assert!(turn < 1e-3, "{plate:?}: off by {turn} rad");
        }
        let ledger = world.ledger();
        let swing = 0.5 * world.mass(body).unwrap() * 0.28_f64.powi(2);
        assert!(ledger.error().abs() < 1e-2 * swing, "{plate:?}: {ledger:?}");
    }
}

/// A plate that starts to turn abruptly carries a cube along. It slips first, and the drive supplies the
/// cube's kinetic energy twice: once for the motion, once for the slip.
#[test]
fn a_turning_plate_drags_a_body_along() {
    for plate in [Plate::Plane, Plate::MeshWall, Plate::Body] {
        let at = Vector3::new(0.2, 0.0, 0.0);
        let rate = 1.5;
        let drive = Drive::Turn {
            axis: Vector3::z(),
            point: Vector3::zeros(),
            rate,
            start: 0.1,
            end: 10.0,
        };
        let (mut world, body) = cube_on_a_plate(plate, at, drive);
        while world.time() < 0.5 {
            world.step().unwrap();
        }
        let x = world.position(body).unwrap();
        let speed = world.velocity(body).unwrap().norm();
        assert!(
            (speed / (rate * x.xy().norm()) - 1.0).abs() < 5e-3,
            "{plate:?}: {speed}"
        );
        let spin = world.angular_velocity(body).unwrap().z;
        assert!((spin / rate - 1.0).abs() < 2e-2, "{plate:?}: {spin}");
        // The slip distance is v^2/2 mu g: the body lags by that much.
        let lag = rate * 0.4 * 0.2 - 0.2 * x.y.atan2(x.x);
        let expected = (rate * 0.2).powi(2) / (2.0 * 0.8 * G);
        assert!(
            (lag / expected - 1.0).abs() < 0.15,
            "{plate:?}: {lag} m, {expected}"
        );
        let ledger = world.ledger();
        let ratio = ledger.work_in / (2.0 * ledger.kinetic);
        assert!((ratio - 1.0).abs() < 0.1, "{plate:?}: {ratio} {ledger:?}");
        assert!(
            ledger.error().abs() < 1e-2 * ledger.kinetic,
            "{plate:?}: {ledger:?}"
        );
    }
}

/// A blade far from any body swings round and strikes one: no cache lets it pass through.
#[test]
fn a_blade_strikes_what_was_far() {
    let mut world = World::new(weightless(1e6, 0.0, 0.0)).unwrap();
    let blade = meshes::block(
        Vector3::new(-0.05, 0.0, -0.2),
        Vector3::new(0.05, 0.6, 0.2),
        1,
    );
    let drive = Drive::Turn {
        axis: Vector3::z(),
        point: Vector3::zeros(),
        rate: 4.0,
        start: 0.0,
        end: 1.0,
    };
    world
        .add_wall(MeshWall::solid("blade", &blade), drive)
        .unwrap();
    let shape = world.add_shape("P5", &crate::common::solid("P5")).unwrap();
    let at = Vector3::new(0.0, -0.4, 0.0);
    let spec = BodySpec::at_rest(shape, DENSITY, pose(at, Rotation::identity()));
    let body = world.add_body(spec).unwrap();
    let mut struck = None;
    let mut deepest = 0.0_f64;
    while world.time() < 1.0 {
        world.step().unwrap();
        if let Some(c) = world.contacts().first() {
            struck = struck.or(Some(world.time()));
            deepest = deepest.max(c.penetration());
        }
    }
    // Half a turn, less the half widths of blade and cube.
    let early = (0.05 + crate::common::half_edge()) / 0.4;
    let expected = (std::f64::consts::PI - early) / 4.0;
    let struck = struck.unwrap();
    assert!((struck - expected).abs() < 0.02, "{struck} {expected}");
    assert!(deepest < 0.3 * crate::common::half_edge(), "{deepest}");
    // Elastic: the cube leaves about twice as fast as the blade.
    let ledger = world.ledger();
    assert!(world.velocity(body).unwrap().norm() > 2.0);
    assert!(ledger.error().abs() < 1e-2 * ledger.work_in, "{ledger:?}");
}

/// Bodies of both kinds in a turning drum: they are carried up on the rising side, and the ledger closes.
#[test]
fn a_drum_turns_its_filling_over() {
    let mut p = parameters(1e6, 0.6, 0.5);
    p.time_step.safety = 0.3;
    let mut world = World::new(p).unwrap();
    let upright = RevolvedShell {
        profile: vec![[0.0, -0.125], [0.2, -0.125], [0.2, 0.125], [0.0, 0.125]],
        thickness: 0.05,
        facets: 16,
    };
    let upright = upright.mesh().unwrap();
    let lying = upright.points().iter().map(|p| Point3::new(p.y, p.z, p.x));
    let drum = TetMesh::new(lying.collect(), upright.tets().to_vec()).unwrap();
    let turn = Drive::Turn {
        axis: Vector3::y(),
        point: Vector3::zeros(),
        rate: 3.0,
        start: 0.1,
        end: 10.0,
    };
    world
        .add_wall(MeshWall::solid("drum", &drum), turn)
        .unwrap();
    let shapes = [
        add_mesh(&mut world, "dolos", &meshes::dolos(0.025)),
        world.add_shape("P5", &crate::common::solid("P5")).unwrap(),
    ];
    for i in 0..6_u64 {
        let cell = Vector3::new((i % 2) as f64, (i / 2 % 2) as f64, (i / 4) as f64);
        let place = cell.add_scalar(-0.5) * 0.11 - Vector3::z() * 0.02;
        let spec = BodySpec::at_rest(shapes[i as usize % 2], DENSITY, pose(place, turned(i)));
        world.add_body(spec).unwrap();
    }
    let mut centre = 0.0;
    let mut steps = 0.0;
    while world.time() < 0.7 {
        world.step().unwrap();
        if world.time() > 0.4 {
            centre += (0..6).map(|i| world.position(i).unwrap().x).sum::<f64>() / 6.0;
            steps += 1.0;
        }
    }
    // The lowest plates move towards -x with a turn about +y.
    let mean = centre / steps;
    assert!(mean < -0.02, "the filling is at {mean}");
    for i in 0..6 {
        let x = world.position(i).unwrap();
        assert!(
            x.x.hypot(x.z) < 0.2 && x.y.abs() < 0.125,
            "{i} has left: {x:?}"
        );
    }
    let ledger = world.ledger();
    let error = ledger.error().abs() / ledger.dissipated();
    assert!(error < 0.01, "{error:e} {ledger:?}");
}

/// Nothing resists the rolling of a ball, whatever the damping.
#[test]
fn rolling_is_not_resisted() {
    let roll = |damping: f64, speed: f64| {
        let mut p = parameters(1e6, 0.8, damping);
        p.time_step.largest = Some(2e-4);
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let ball = Shape::from(Sphere { level: 3 }).polyhedron(D).unwrap();
        let shape = world.add_shape("ball", &ball).unwrap();
        let radius = 0.5 * D;
        let spec = BodySpec {
            velocity: Vector3::x() * speed,
            angular_velocity: Vector3::y() * (speed / radius),
            ..BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * (0.97 * radius)))
        };
        world.add_body(spec).unwrap();
        run_until(&mut world, 0.1);
        let energy = |world: &World| world.body_kinetic_energy(0).unwrap();
        let (before, from) = (energy(&world), world.position(0).unwrap().x);
        run_until(&mut world, 0.3);
        let way = world.position(0).unwrap().x - from;
        (before - energy(&world)) / (world.mass(0).unwrap() * G * way)
    };
    for (damping, speed) in [(0.0, 0.5), (0.6, 0.5), (0.6, 0.05)] {
        let found = roll(damping, speed);
        assert!(found.abs() < 0.002, "{damping} {speed}: {found}");
    }
}

/// A ball that rolls on a block thirty times as large gains no energy from friction, whichever of the two was
/// added first.
#[test]
fn a_small_ball_rolls_on_a_large_block() {
    let roll = |ball_first: bool| {
        let mut p = parameters(1e7, 0.6, 0.3);
        p.time_step.safety = 0.3;
        let mut world = World::new(p).unwrap();
        let ball = Shape::from(Sphere { level: 3 }).polyhedron(D).unwrap();
        let side = 30.0 * D;
        let block = "P5".parse::<CatalogueShape>().unwrap();
        let block = block.polyhedron(side * 3.0_f64.sqrt()).unwrap();
        let [ball, block] = [("ball", ball), ("block", block)]
            .map(|(name, surface)| world.add_shape(name, &surface).unwrap());
        let radius = 0.5 * D;
        let rolling = BodySpec {
            velocity: Vector3::x(),
            angular_velocity: Vector3::y() / radius,
            ..BodySpec::at_rest(ball, DENSITY, at(Vector3::z() * (0.999 * radius)))
        };
        let ground = BodySpec::at_rest(block, DENSITY, at(Vector3::z() * (-0.5 * side)));
        if ball_first {
            world.add_body(rolling).unwrap();
        }
        world.add_driven_body(ground, Drive::Fixed).unwrap();
        if !ball_first {
            world.add_body(rolling).unwrap();
        }
        run_until(&mut world, 0.4);
        world.ledger().dissipated_friction
    };
    let [first, second] = [true, false].map(roll);
    assert!(first > 0.0 && second > 0.0, "{first:e} {second:e} J");
}
