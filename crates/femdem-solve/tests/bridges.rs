//! Liquid bridges as mechanics says: what hangs, comes apart, and what a rupture costs.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{D, DENSITY, add_floor, add_sides, at, parameters, run_until, weightless};
use femdem_contact::{LiquidBridge, Wall, Wrench};
use femdem_mesh::Vector3;
use femdem_solve::{BodySpec, Drive, World, WorldParameters};
use std::f64::consts::PI;

const RADIUS: f64 = 0.5 * D;

const WATER: LiquidBridge = LiquidBridge {
    volume: 1e-8,
    tension: 20.0,
    contact_angle: 0.3,
};

fn wet(mut p: WorldParameters) -> WorldParameters {
    p.contact.liquid_bridge = Some(WATER);
    p
}

fn ball(world: &mut World, place: Vector3, velocity: Vector3) -> u32 {
    let shape = match world.shapes().is_empty() {
        true => world.add_sphere("ball", RADIUS).unwrap(),
        false => world.shape_of(0).unwrap(),
    };
    let spec = BodySpec {
        velocity,
        ..BodySpec::at_rest(shape, DENSITY, at(place))
    };
    world.add_body(spec).unwrap()
}

/// A ball under a plate, and two balls of which one is held, bear a pull somewhat below 4 pi R gamma cos(theta) of the reduced
/// radius R, and come apart under one somewhat above.
#[test]
fn wet_balls_hold_against_less_than_the_largest_pull() {
    for (reduced, with_plate) in [(RADIUS, true), (0.5 * RADIUS, false)] {
        let most = 4.0 * PI * reduced * 20.0 * 0.3_f64.cos();
        for (share, holds) in [(0.97, true), (1.03, false)] {
            let mut world = World::new(wet(weightless(1e7, 0.5, 0.6))).unwrap();
            if with_plate {
                let plate = Wall::half_space("plate", -Vector3::z(), RADIUS).unwrap();
                world.add_wall(plate, Drive::Fixed).unwrap();
            } else {
                let held = ball(&mut world, Vector3::z() * (3.0 * RADIUS), Vector3::zeros());
                world.drive_body(held, Some(Drive::Fixed)).unwrap();
            }
            let middle = if with_plate { -2.0 * RADIUS } else { RADIUS };
            let low = Vector3::z() * (middle + 1e-6);
            let id = ball(&mut world, low, Vector3::zeros());
            run_until(&mut world, 0.05);
            assert!(
                (world.position(id).unwrap() - low).norm() < 0.01 * D,
                "it sinks in"
            );
            // The pull grows slowly.
            while world.time() < 0.4 {
                let grown = (4.0 * (world.time() - 0.05)).min(1.0);
                let pull = Wrench {
                    force: Vector3::z() * (-most * share * grown),
                    torque: Vector3::zeros(),
                };
                world.set_load(id, pull).unwrap();
                world.step().unwrap();
            }
            let gone = low.z - world.position(id).unwrap().z;
            assert_eq!(gone < 0.01 * D, holds, "{share} {gone}");
            assert_eq!(world.contacts().len(), usize::from(holds));
            let books = world.ledger();
            assert!(books.error_relative().abs() < 0.01, "{books:?}");
            assert_eq!(books.dissipated_bridges > 0.0, !holds);
        }
    }
}

/// Two balls meet without dashpots, go apart through the bridge that has formed, and break it: they lose what the bridge held, the
/// integral of its force from the touch to the rupture. The error of the ledger is of second order in the step.
#[test]
fn a_rupture_takes_the_work_of_the_bridge() {
    let through = |step: f64| {
        let mut p = wet(weightless(1e6, 0.0, 0.0));
        p.time_step.largest = Some(step);
        let mut world = World::new(p).unwrap();
        let speed = Vector3::x() * 0.1;
        let apart = Vector3::x() * (2.07 * RADIUS);
        let one = ball(&mut world, Vector3::zeros(), speed);
        let other = ball(&mut world, apart, -speed);
        let mut stretched = 0;
        let mut worst = 0.0_f64;
        while world.time() < 0.12 {
            world.step().unwrap();
            let contacts = world.contacts();
            stretched += usize::from(contacts.iter().any(|c| c.area == 0.0));
            worst = worst.max(world.ledger().error().abs());
        }
        assert!(stretched > 10 && world.contacts().is_empty(), "{stretched}");
        let books = world.ledger();
        // Of the force of Rabinovich et al. (2005), by Simpson's rule.
        let root = |gap: f64| (gap * gap + 2.0 * 1e-8 / (PI * RADIUS)).sqrt();
        let force = |gap: f64| 2.0 * PI * RADIUS * 20.0 * 0.3_f64.cos() * (1.0 - gap / root(gap));
        let (breaks, n) = (1.15 * 1e-8_f64.cbrt(), 200);
        let h = breaks / f64::from(n);
        let sum = (0..n).map(|k| {
            let x = f64::from(k) * h;
            h / 6.0 * (force(x) + 4.0 * force(x + 0.5 * h) + force(x + h))
        });
        let work: f64 = sum.sum();
        assert!((books.dissipated_bridges / work - 1.0).abs() < 1e-6);
        let lost = books.initial - books.kinetic;
        let speeds = [one, other].map(|id| world.velocity(id).unwrap().x);
        assert!((speeds[0] + speeds[1]).abs() < 1e-12);
        (worst / work, (lost / work - 1.0).abs())
    };
    let [coarse, fine] = [2e-5, 5e-6].map(through);
    assert!(coarse.1 < 0.02 && fine.1 < 0.002, "{coarse:?} {fine:?}");
    assert!(coarse.0 < 0.02 && fine.0 < 0.002, "{coarse:?} {fine:?}");
}

fn heap() -> World {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.contact.liquid_bridge = Some(LiquidBridge {
        volume: 1e-6,
        ..WATER
    });
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 3.3 * D, Drive::Fixed);
    for k in 0..60_u32 {
        let [i, j, l] = [k % 3, k / 3 % 3, k / 9].map(f64::from);
        let place = Vector3::new(i, j, l) * 1.05 + Vector3::repeat(0.55);
        let at = f64::from(k);
        let velocity = Vector3::new((7.0 * at).sin(), (3.0 * at).cos(), (11.0 * at).sin());
        ball(&mut world, place * D, velocity);
    }
    world
}

/// The same bits for any number of threads, and through a checkpoint while bridges are stretched.
#[test]
fn bridges_have_the_same_bits_with_threads_and_through_bytes() {
    let steps = |world: &mut World, count: u32| {
        for _ in 0..count {
            world.step().unwrap();
        }
    };
    let mut world = heap();
    let stretched = |world: &World| world.contacts().iter().filter(|c| c.area == 0.0).count();
    while stretched(&world) < 4 {
        assert!(world.time() < 1.0);
        world.step().unwrap();
    }
    let mut again = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    steps(&mut world, 300);
    steps(&mut again, 300);
    assert_eq!(world.state_hash().unwrap(), again.state_hash().unwrap());
    let books = world.ledger();
    assert!(books.error_relative().abs() < 0.02, "{books:?}");
    #[cfg(feature = "parallel")]
    {
        let count = world.steps() as u32;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let hash = pool.unwrap().install(|| {
            let mut world = heap();
            steps(&mut world, count);
            world.state_hash().unwrap()
        });
        assert_eq!(hash, world.state_hash().unwrap());
    }
}

/// Balls that are dried while they touch, or while a bridge between them is stretched, come apart without a rupture.
#[test]
fn no_bridge_outlives_its_law() {
    for stretched in [false, true] {
        let mut p = wet(weightless(1e6, 0.0, 0.0));
        p.time_step.largest = Some(5e-6);
        let mut world = World::new(p).unwrap();
        let speed = Vector3::x() * 0.1;
        ball(&mut world, Vector3::zeros(), speed);
        ball(&mut world, Vector3::x() * (2.0 * RADIUS + 1e-5), -speed);
        let over_gap = |world: &World| world.contacts().iter().any(|c| c.area == 0.0);
        let touching = |world: &World| world.contacts().iter().any(|c| c.area > 0.0);
        while if stretched {
            !over_gap(&world)
        } else {
            !touching(&world)
        } {
            world.step().unwrap();
        }
        let dry = WorldParameters {
            contact: weightless(1e6, 0.0, 0.0).contact,
            ..*world.parameters()
        };
        world.set_contact(dry.contact).unwrap();
        assert!(!over_gap(&world));
        let until = world.time() + 0.2;
        while world.time() < until {
            world.step().unwrap();
        }
        let books = world.ledger();
        assert!(world.contacts().is_empty());
        assert_eq!(books.dissipated_bridges, 0.0, "{stretched}");
        assert!(books.error_relative().abs() < 0.01, "{books:?}");
    }
}

/// More liquid than a ball has room for is a slip of units.
#[test]
fn a_bridge_larger_than_its_ball_is_refused() {
    let mut p = wet(weightless(1e6, 0.0, 0.0));
    p.contact.liquid_bridge = Some(LiquidBridge {
        volume: 1.1 * RADIUS.powi(3),
        ..WATER
    });
    let mut world = World::new(p).unwrap();
    let shape = world.add_sphere("ball", RADIUS).unwrap();
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros()));
    world.add_body(spec).unwrap();
    let error = world.step().unwrap_err().to_string();
    assert!(error.contains("liquid_bridge.volume"), "{error}");
}
