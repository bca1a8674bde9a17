//! Bonded bodies: strength and energy, a beam of blocks, books, sleep, bits.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{at, parameters, weightless};
use femdem_contact::bond::{BondLaw, BondSection};
use femdem_contact::{BodyId, Wall};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Rotation, Vector3};
use femdem_solve::{BodySpec, Drive, Medium, SleepParameters, World};

pub(crate) const LAW: BondLaw = BondLaw {
    stiffness: 1e11,
    tensile: 1e6,
    cohesion: 3e6,
    friction: 0.6,
    energies: [20.0, 100.0],
    mix: 2.0,
    softening: femdem_contact::glue::Softening::Linear,
    damping: 0.0,
};

/// Edge of the blocks, m.
pub(crate) const A: f64 = 0.1;

pub(crate) fn block(world: &mut World) -> u32 {
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(A * 3_f64.sqrt()).unwrap();
    world.add_shape("block", &cube).unwrap()
}

pub(crate) fn bond(world: &mut World, bodies: [BodyId; 2], law: BondLaw) -> u32 {
    let section = world.section_between(bodies, 1e-6, 1.0).unwrap().unwrap();
    assert!((section.area() / (A * A) - 1.0).abs() < 1e-9);
    world.add_bond(bodies, &section, law).unwrap()
}

/// Pulled or sheared apart by a slow drive: f_t A and G_I A, c A and G_II A; the work of the drive is what is lost.
#[test]
fn peak_force_and_energy_of_a_pair() {
    for (along, strength, energy) in [(Vector3::x(), 1e6, 20.0), (Vector3::z(), 3e6, 100.0)] {
        let mut p = weightless(1e9, 0.5, 0.1);
        p.time_step.largest = Some(1e-6);
        let mut world = World::new(p).unwrap();
        let shape = block(&mut world);
        let spec = |x: f64| BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * x));
        let fixed = world.add_driven_body(spec(0.0), Drive::Fixed).unwrap();
        let drive = Drive::Linear {
            velocity: along * 0.02,
            start: 0.0,
            end: 1.0,
        };
        let pulled = world.add_driven_body(spec(A), drive).unwrap();
        let id = bond(&mut world, [fixed, pulled], LAW);
        let mut peak = 0.0_f64;
        while !world.bond(id).unwrap().has_ended() {
            world.step().unwrap();
            peak = peak.max(world.bond(id).unwrap().state().force.dot(&along));
            assert!(world.time() < 0.01);
        }
        assert!((peak / (strength * A * A) - 1.0).abs() < 0.01, "{peak}");
        let ledger = world.ledger();
        assert!((ledger.dissipated_bonds / (energy * A * A) - 1.0).abs() < 1e-4);
        assert!((ledger.work_in / (energy * A * A) - 1.0).abs() < 1e-3);
        let time = world.bond(id).unwrap().broken_at().unwrap();
        assert!((0.02 * time / (2.0 * energy / strength) - 1.0).abs() < 0.01);
    }
}

/// Two free blocks fly apart and turn until the bond breaks: momentum, angular momentum and energy.
#[test]
fn free_blocks_keep_momentum_and_energy() {
    let mut p = weightless(1e9, 0.5, 0.0);
    p.time_step.largest = Some(1e-6);
    let mut world = World::new(p).unwrap();
    let shape = block(&mut world);
    let bodies = [0.0, 1.0].map(|x| {
        let spec = BodySpec {
            velocity: Vector3::new(x, 0.3 * x, -0.2),
            angular_velocity: Vector3::new(1.0, 2.0 * x, -3.0),
            ..BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * (A * x)))
        };
        world.add_body(spec).unwrap()
    });
    let id = bond(&mut world, bodies, LAW);
    let origin = Vector3::zeros();
    let before = (world.linear_momentum(), world.angular_momentum(&origin));
    let mut worst = 0.0_f64;
    while !world.bond(id).unwrap().has_ended() {
        world.step().unwrap();
        worst = worst.max(world.ledger().error_relative().abs());
        assert!(world.time() < 0.01, "{:?}", world.bond(id).unwrap().state());
    }
    assert!((world.linear_momentum() - before.0).norm() < 1e-12);
    assert!((world.angular_momentum(&origin) - before.1).norm() < 1e-12);
    assert!(
        world.ledger().dissipated_bonds > 0.2 && worst < 1e-4,
        "{worst}"
    );
}

/// A beam of blocks under its weight: the deflection of n joints of stiffness k I and k A, and the root gives way where M/W
/// reaches the strength.
#[test]
fn a_beam_of_blocks() {
    let mut p = parameters(1e9, 0.5, 0.1);
    p.gravity = Vector3::zeros();
    p.medium = Medium {
        local_damping: 0.6,
        ..Medium::default()
    };
    let mut world = World::new(p).unwrap();
    let shape = block(&mut world);
    let n = 4;
    let spec = |i: u32| BodySpec::at_rest(shape, 2000.0, at(Vector3::x() * (A * f64::from(i))));
    let mut bodies = vec![world.add_driven_body(spec(0), Drive::Fixed).unwrap()];
    bodies.extend((1..=n).map(|i| world.add_body(spec(i)).unwrap()));
    let (area, second) = (A * A, A.powi(4) / 12.0);
    let weight = |g: f64| 2000.0 * A.powi(3) * g;
    let arms = |j: u32| (j..=n).map(move |i| (f64::from(i - j) + 0.5) * A);
    let moment = |j: u32, g: f64| arms(j).sum::<f64>() * weight(g);
    let law = BondLaw {
        stiffness: 1e9,
        tensile: moment(1, 100.0) / (A.powi(3) / 6.0),
        energies: [4e3, 1e5],
        damping: 0.2,
        ..LAW
    };
    let bonds: Vec<u32> = bodies
        .windows(2)
        .map(|w| bond(&mut world, [w[0], w[1]], law))
        .collect();
    let step = |world: &mut World, g: f64| {
        world.set_gravity(Vector3::z() * -g).unwrap();
        for _ in 0..400 {
            world.step().unwrap();
        }
    };
    for k in 1..=10 {
        step(&mut world, 5.0 * f64::from(k));
    }
    for _ in 0..10 {
        step(&mut world, 50.0);
    }
    let bends = |j: u32| {
        let turn = moment(j, 50.0) / (law.stiffness * second);
        turn * (f64::from(n - j) + 0.5) * A
            + f64::from(n - j + 1) * weight(50.0) / (law.stiffness * area)
    };
    let expected: f64 = (1..=n).map(bends).sum();
    let tip = -world.position(bodies[n as usize]).unwrap().z;
    assert!((tip / expected - 1.0).abs() < 0.01, "{tip} {expected}");
    let root = world.bond(bonds[0]).unwrap();
    assert!((root.state().moment.norm() / moment(1, 50.0) - 1.0).abs() < 0.01);
    assert!((root.state().tension / (0.5 * law.tensile) - 1.0).abs() < 0.01);
    for k in 11..=18 {
        step(&mut world, 5.0 * f64::from(k));
    }
    let mut g = 90.0;
    while !world.bond(bonds[0]).unwrap().has_yielded() {
        g += 0.5;
        step(&mut world, g);
        assert!(g < 110.0);
    }
    assert!((g / 100.0 - 1.0).abs() < 0.02, "{g}");
    assert!(!world.bond(bonds[1]).unwrap().has_yielded());
}

/// A lattice of bonded spheres above a floor, tilted by an angle; it sleeps if it is not.
fn cluster(law: BondLaw, speed: f64, tilt: f64) -> World {
    let mut p = parameters(1e8, 0.5, 0.1);
    p.sleeping = SleepParameters {
        enabled: tilt == 0.0,
        ..SleepParameters::default()
    };
    let mut world = World::new(p).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let r = 0.01;
    let ball = world.add_sphere("ball", r).unwrap();
    let mut bodies = Vec::new();
    for i in 0..27_u32 {
        let place = Vector3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9));
        let turn = Rotation::from_scaled_axis(Vector3::new(1.0, 0.6, 0.0) * tilt);
        let place = turn * place * (2.0 * r) + Vector3::z() * ((1.001 + 2.0 * tilt) * r);
        let spec = BodySpec {
            velocity: Vector3::new(0.2 * speed, 0.0, -speed),
            ..BodySpec::at_rest(ball, 2500.0, at(place))
        };
        bodies.push(world.add_body(spec).unwrap());
    }
    for (k, &a) in bodies.iter().enumerate() {
        for &b in &bodies[k + 1..] {
            if let Some(section) = world.section_between([a, b], 1e-6, 0.5).unwrap() {
                world.add_bond([a, b], &section, law).unwrap();
            }
        }
    }
    assert_eq!(world.bonds().count(), 54);
    world
}

/// An impact breaks bonds, and pieces slide and press on broken faces: the books close, and resumed in the middle, on any number
/// of threads, the bits are the same.
#[test]
fn an_impact_with_books_and_bits() {
    let law = BondLaw {
        damping: 0.05,
        ..LAW
    };
    let mut world = cluster(law, 5.0, 0.5);
    let partly = |world: &World| {
        world
            .bonds()
            .any(|(_, bond)| bond.has_yielded() && !bond.is_broken())
    };
    while !partly(&world) {
        world.step().unwrap();
        assert!(world.steps() < 5000);
    }
    let mut resumed = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    for _ in 0..3000 {
        world.step().unwrap();
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(3)
        .build()
        .unwrap()
        .install(|| {
            for _ in 0..3000 {
                resumed.step().unwrap();
            }
        });
    assert!(world.to_bytes().unwrap() == resumed.to_bytes().unwrap());
    let ended = world.bonds().filter(|(_, b)| b.has_ended()).count();
    let ledger = world.ledger();
    let report = format!(
        "{ended} ended, error {:e}, {ledger:?}",
        ledger.error_relative()
    );
    assert!(ended > 5 && ended < 54, "{report}");
    assert!(ledger.error_relative().abs() < 1e-4, "{report}");
}

/// Bonded bodies fall asleep together, and wake together.
#[test]
fn sleepers_are_bonded_sleepers() {
    let law = BondLaw {
        tensile: 1e8,
        cohesion: 1e8,
        energies: [1e6, 1e6],
        damping: 0.3,
        ..LAW
    };
    let mut world = cluster(law, 0.05, 0.0);
    while world.awake_count() > 0 {
        world.step().unwrap();
        let asleep = 27 - world.awake_count();
        assert!(asleep == 0 || asleep == 27, "{asleep}");
        assert!(world.time() < 2.0);
    }
    world
        .set_velocity(13, Vector3::z() * 0.1, Vector3::zeros())
        .unwrap();
    assert_eq!(world.awake_count(), 27);
    assert_eq!(world.bonded_with(3).len(), 27);
}

/// Bodies that go take their bonds with them, and the books know it; steps that solve for the end refuse bonds by name.
#[test]
fn bonds_go_with_their_bodies() {
    let mut world = cluster(LAW, 0.5, 0.5);
    for _ in 0..400 {
        world.step().unwrap();
    }
    let before = world.ledger();
    assert!(before.bonds > 1e-3);
    world.remove_body(13).unwrap();
    assert_eq!(world.bonds().count(), 48);
    world.set_pose(0, at(Vector3::x() * 3.0)).unwrap();
    assert_eq!(world.bonds().count(), 45);
    let after = world.ledger();
    assert!((after.error() - before.error()).abs() < 1e-9);
    assert!(after.bonds < before.bonds);
    let mut time_step = world.parameters().time_step;
    time_step.implicit = Some(femdem_solve::ImplicitStep::default());
    world.set_time_step(time_step).unwrap();
    let refused = world.step().unwrap_err().to_string();
    assert!(
        refused.contains("bonds with time_step.implicit"),
        "{refused}"
    );
    let section = BondSection::disc(Vector3::zeros(), Vector3::x(), 0.01).unwrap();
    let refused = world
        .add_bond([1, 2], &section, LAW)
        .unwrap_err()
        .to_string();
    assert!(refused.contains("implicit"), "{refused}");
}
