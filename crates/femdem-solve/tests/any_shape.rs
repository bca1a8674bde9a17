//! Bodies and walls of any shape in the world: they conserve what is conserved, hold each other,
//! and go through bytes.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod common;
#[path = "../../femdem-contact/tests/common/meshes.rs"]
mod meshes;

use common::{DENSITY, G, add_floor, add_sides, noise, parameters, turned, weightless};
use femdem_contact::{Drum, Field, MeshWall, Partner, Wall, restitution};
use femdem_mesh::nalgebra::{Point3, Translation3, Vector3};
use femdem_mesh::{Polyhedron, Pose, Rotation, TetMesh};
use femdem_solve::{BodySpec, Drive, SolveError, World};
use std::f64::consts::FRAC_PI_2;

fn add_mesh(world: &mut World, name: &str, mesh: &TetMesh) -> u32 {
    let surface = mesh.surface().unwrap();
    world
        .add_mesh_shape(name, &surface, mesh, Field::Body)
        .unwrap()
}

fn pose(position: Vector3<f64>, rotation: Rotation) -> Pose {
    Pose::from_parts(Translation3::from(position), rotation)
}

/// Pellets with a hole and dolosse fly about in a closed box, without friction and damping.
/// Returns the largest energy error, its trend, and how many patches and pairs were seen.
fn elastic_box(count: u64, seconds: f64) -> (f64, f64, [usize; 2]) {
    let mut p = weightless(1e6, 0.0, 0.0);
    p.time_step.safety = 0.1;
    p.time_step.largest = Some(2e-5);
    let mut world = World::new(p).unwrap();
    let d = 0.1;
    let shapes = [
        add_mesh(&mut world, "pellet", &meshes::pellet(0.015, 0.04, 0.07, 12)),
        add_mesh(&mut world, "dolos", &meshes::dolos(0.026)),
    ];
    let wide = (count as f64).cbrt().ceil() as u64;
    let side = 1.15 * d * wide as f64;
    for wall in Wall::closed_box(Vector3::zeros(), Vector3::repeat(side)).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    for i in 0..count {
        let cell = [i % wide, i / wide % wide, i / (wide * wide)];
        let position = Vector3::from(cell.map(|c| (1.15 * c as f64 + 0.575) * d));
        world
            .add_body(BodySpec {
                shape: shapes[i as usize % 2],
                density: DENSITY,
                pose: pose(position, turned(i)),
                velocity: Vector3::new(noise(7 * i), noise(7 * i + 1), noise(7 * i + 2)),
                angular_velocity: Vector3::new(
                    noise(7 * i + 3),
                    noise(7 * i + 4),
                    noise(7 * i + 5),
                ) * 9.0,
            })
            .unwrap();
    }
    let start = world.kinetic_energy();
    let (mut worst, mut halves, mut counts) = (0.0_f64, [0.0_f64; 2], [0.0_f64; 2]);
    let mut seen = [0; 2];
    while world.time() < seconds {
        for _ in 0..100 {
            world.step().unwrap();
        }
        let off = world.ledger().final_energy() / start - 1.0;
        worst = worst.max(off.abs());
        let half = usize::from(world.time() > 0.5 * seconds);
        halves[half] += off;
        counts[half] += 1.0;
        let contacts = world.contacts();
        seen[0] += contacts.len();
        seen[1] += contacts.iter().filter(|c| c.patch == 0).count();
    }
    (worst, halves[1] / counts[1] - halves[0] / counts[0], seen)
}

#[test]
fn elastic_box_keeps_its_energy() {
    let (worst, trend, [patches, pairs]) = elastic_box(20, 0.1);
    assert!(
        pairs > 100 && patches > pairs,
        "{patches} patches of {pairs} pairs"
    );
    assert!(worst < 1e-4, "energy error {worst:e}");
    assert!(trend.abs() < 5e-5, "energy trend {trend:e}");
}

/// The same for a whole second: some minutes.
#[test]
#[ignore = "takes minutes; run in release"]
fn elastic_box_keeps_its_energy_for_a_second() {
    let (worst, trend, seen) = elastic_box(20, 1.0);
    assert!(
        worst < 1e-4 && trend.abs() < 2e-5,
        "energy error {worst:e}, trend {trend:e}, patches and pairs {seen:?}"
    );
}

/// Three dolosse meet in free space, with friction and damping: momentum and angular momentum to
/// round-off.
#[test]
fn momentum_is_kept_to_round_off() {
    let mut world = World::new(weightless(1e6, 0.5, 0.3)).unwrap();
    let shape = add_mesh(&mut world, "dolos", &meshes::dolos(0.04));
    for i in 0..3_u32 {
        let angle = f64::from(i) * 2.1;
        let out = Vector3::new(angle.cos(), angle.sin(), 0.1 * f64::from(i));
        let mut spec = BodySpec::at_rest(shape, DENSITY, pose(out * 0.12, turned(u64::from(i))));
        spec.velocity = -out + Vector3::new(0.1, 0.0, 0.0);
        spec.angular_velocity = Vector3::new(1.0, f64::from(i), -2.0);
        world.add_body(spec).unwrap();
    }
    let about = Vector3::new(0.3, -0.2, 0.1);
    let before = [world.linear_momentum(), world.angular_momentum(&about)];
    let scale: f64 = (0..3)
        .map(|i| world.mass(i).unwrap() * world.velocity(i).unwrap().norm())
        .sum();
    let mut touched = 0;
    while world.time() < 0.2 {
        world.step().unwrap();
        touched += world.contacts().len();
    }
    assert!(touched > 30, "{touched} contacts");
    assert!((world.linear_momentum() - before[0]).norm() < 1e-12 * scale);
    assert!((world.angular_momentum(&about) - before[1]).norm() < 1e-12 * scale);
}

/// A block on two feet meets a floor squarely, without weight: two patches rebound as one contact
/// would.
#[test]
fn two_patches_rebound_as_one() {
    for zeta in [0.1, 0.3, 0.6] {
        let mut p = weightless(1e6, 0.0, zeta);
        p.time_step.safety = 0.05;
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let x = [-0.05, -0.02, 0.02, 0.05];
        let z = [0.0, 0.03, 0.06, 0.1];
        let cells: Vec<[i32; 3]> = (0..18)
            .map(|i| [i % 3, i / 3 % 2, i / 6])
            .filter(|c| !(c[0] == 1 && c[2] == 0))
            .collect();
        let mesh = meshes::boxes(&cells, &x, &[-0.05, 0.0, 0.05], &z);
        let shape = add_mesh(&mut world, "feet", &mesh);
        let mut spec = BodySpec::at_rest(shape, DENSITY, Pose::translation(0.0, 0.0, 1e-3));
        spec.velocity.z = -0.05;
        let body = world.add_body(spec).unwrap();
        let mut patches = 0;
        while world.time() < 0.1 {
            world.step().unwrap();
            patches = patches.max(world.contacts().len());
        }
        let rebound = world.velocity(body).unwrap().z / 0.05;
        let expected = restitution(zeta);
        assert_eq!(patches, 2);
        assert!(
            (rebound - expected).abs() < 0.01,
            "{zeta}: {rebound}, {expected}"
        );
    }
}

/// Two rings hang from a third that is held: each in the one above, crosswise. They come to rest,
/// each carries what hangs below it, and nothing creeps.
#[test]
fn a_chain_of_links_holds_its_weight() {
    let mut p = parameters(1e7, 0.5, 0.5);
    p.medium.drag = 20.0;
    let mut world = World::new(p).unwrap();
    let (radius, bar) = (0.05, 0.012);
    let shape = add_mesh(&mut world, "link", &meshes::ring(radius, bar, 12, 6));
    let upright = Rotation::from_axis_angle(&Vector3::x_axis(), FRAC_PI_2);
    let cross = Rotation::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2) * upright;
    let drop = 2.0 * (radius - bar) + 0.001;
    let link = |k: u32| {
        let turn = if k % 2 == 0 { upright } else { cross };
        let place = Vector3::new(0.0, 0.0, -drop * f64::from(k));
        BodySpec::at_rest(shape, DENSITY, pose(place, turn))
    };
    world.add_driven_body(link(0), Drive::Fixed).unwrap();
    world.add_body(link(1)).unwrap();
    world.add_body(link(2)).unwrap();
    while world.time() < 1.0 {
        world.step().unwrap();
    }
    world.set_medium(femdem_solve::Medium::default()).unwrap();
    while world.time() < 1.5 {
        world.step().unwrap();
    }
    let places = |w: &World| [1, 2].map(|i| (w.position(i).unwrap(), w.pose(i).unwrap().rotation));
    let before = places(&world);
    let (mut carried, mut steps) = ([Vector3::zeros(); 2], 0.0);
    while world.time() < 2.5 {
        world.step().unwrap();
        for c in world.contacts() {
            // The lower link of a pair has the higher number.
            assert_eq!(c.a, Partner::Body(c.b - 1), "only neighbours touch");
            carried[c.b as usize - 1] += c.force_on_b();
        }
        steps += 1.0;
    }
    let weight = world.mass(1).unwrap() * G;
    for (i, links) in [(0, 2.0), (1, 1.0)] {
        let off = carried[i] / steps - Vector3::z() * (links * weight);
        assert!(
            off.norm() < 1e-3 * weight,
            "link {i} is off by {off:?} of {weight} N"
        );
    }
    for ((x, turn), (now, turned)) in before.iter().zip(places(&world)) {
        let crept = (now - x).norm();
        assert!(crept < 1e-6 * radius, "crept by {crept:e} m in a second");
        assert!(turn.angle_to(&turned) < 1e-6);
    }
}

/// What a plate that moves is to the world.
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
    let shape = world.add_shape("P5", &common::solid("P5")).unwrap();
    let place = at + Vector3::z() * common::half_edge();
    let spec = BodySpec::at_rest(shape, DENSITY, pose(place, Rotation::identity()));
    let body = world.add_body(spec).unwrap();
    (world, body)
}

/// A cube on a plate that swings smoothly about an axis beside it goes with it, without slip, and
/// comes back; and the books close.
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

/// A plate that starts to turn at once takes a cube along: it slips first, which the drive pays
/// for as much again as for the cube's speed.
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
        // Slip takes v^2/2 mu g: the body lags by that much.
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

/// A blade far from any body swings round and strikes one: no cache lets it pass.
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
    let shape = world.add_shape("P5", &common::solid("P5")).unwrap();
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
    let early = (0.05 + common::half_edge()) / 0.4;
    let expected = (std::f64::consts::PI - early) / 4.0;
    let struck = struck.unwrap();
    assert!((struck - expected).abs() < 0.02, "{struck} {expected}");
    assert!(deepest < 0.3 * common::half_edge(), "{deepest}");
    // Elastic: the cube leaves about twice as fast as the blade.
    let ledger = world.ledger();
    assert!(world.velocity(body).unwrap().norm() > 2.0);
    assert!(ledger.error().abs() < 1e-2 * ledger.work_in, "{ledger:?}");
}

/// Bodies of both kinds in a turning drum: they are carried up on the side that rises, and the
/// books close.
#[test]
fn a_drum_turns_its_filling_over() {
    let mut p = parameters(1e6, 0.6, 0.5);
    p.time_step.safety = 0.3;
    let mut world = World::new(p).unwrap();
    let drum = Drum {
        radius: 0.2,
        length: 0.25,
        thickness: 0.05,
        facets: 16,
    };
    let turn = Drive::Turn {
        axis: Vector3::y(),
        point: Vector3::zeros(),
        rate: 3.0,
        start: 0.1,
        end: 10.0,
    };
    world
        .add_wall(MeshWall::drum("drum", &drum).unwrap(), turn)
        .unwrap();
    let shapes = [
        add_mesh(&mut world, "dolos", &meshes::dolos(0.025)),
        world.add_shape("P5", &common::solid("P5")).unwrap(),
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

/// A heap of both kinds with friction between planes and in front of a mesh wall.
fn heap() -> World {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 0.32, Drive::Fixed);
    let low = Vector3::new(-0.2, -0.2, 0.0);
    let step = meshes::block(low, Vector3::new(0.1, 0.5, 0.03), 2);
    world
        .add_wall(MeshWall::solid("step", &step), Drive::Fixed)
        .unwrap();
    let ramp = [
        [0.3, 0.0, 0.0],
        [0.4, 0.0, 0.1],
        [0.4, 0.4, 0.1],
        [0.3, 0.4, 0.0],
    ];
    let ramp = ramp.map(|[x, y, z]| Point3::new(x, y, z)).to_vec();
    let ramp = MeshWall::sheet("ramp", ramp, vec![[0, 1, 2], [0, 2, 3]], 0.05).unwrap();
    world.add_wall(ramp, Drive::Fixed).unwrap();
    let shapes = [
        add_mesh(&mut world, "dolos", &meshes::dolos(0.03)),
        world.add_shape("A1", &common::solid("A1")).unwrap(),
        add_mesh(&mut world, "pellet", &meshes::pellet(0.02, 0.05, 0.08, 8)),
    ];
    for i in 0..18_u64 {
        let cell = [i % 3, i / 3 % 3, i / 9].map(|c| 0.105 * c as f64 + 0.055);
        let place = Vector3::from(cell) + Vector3::z() * 0.03;
        let spec = BodySpec::at_rest(shapes[i as usize % 3], DENSITY, pose(place, turned(i)));
        world.add_body(spec).unwrap();
    }
    world
}

fn advance(world: &mut World, steps: u32) {
    for _ in 0..steps {
        world.step().unwrap();
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut world = heap();
            advance(&mut world, 250);
            world.state_hash().unwrap()
        })
    };
    let one = run(1);
    assert_eq!(run(2), one, "two threads");
    assert_eq!(run(3), one, "three threads");
}

#[test]
fn through_bytes_in_the_middle() {
    let mut straight = heap();
    let mut broken = straight.clone();
    let mut patches = 0;
    for _ in 0..8 {
        advance(&mut straight, 50);
        advance(&mut broken, 50);
        broken = World::from_bytes(&broken.to_bytes().unwrap()).unwrap();
        patches = patches.max(broken.contacts().iter().filter(|c| c.patch > 0).count());
    }
    assert_eq!(straight.state_hash().unwrap(), broken.state_hash().unwrap());
    assert!(patches > 0, "no pair had several patches");
    assert!(straight.stability().unwrap().is_some());
}

#[test]
fn a_mesh_of_another_size_is_refused() {
    let mut world = World::new(parameters(1e6, 0.5, 0.5)).unwrap();
    let mesh = meshes::dolos(0.03);
    let surface: Polyhedron = meshes::dolos(0.04).surface().unwrap();
    let error = world.add_mesh_shape("dolos", &surface, &mesh, Field::Body);
    assert!(matches!(error, Err(SolveError::Parameter { .. })));
}
