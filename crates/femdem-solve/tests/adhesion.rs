//! Cohesion and adhesion as mechanics says: what hangs, falls, slides, bounces.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{
    D, DENSITY, G, add_floor, add_heap, add_sides, at, half_edge, parameters, run_until, solid,
    weightless,
};
use femdem_contact::{ContactParameters, LiquidBridge, MaterialId, Wall, Wrench};
use femdem_mesh::nalgebra::Vector3;
use femdem_solve::{BodySpec, Drive, ImplicitStep, World, WorldParameters};

fn pull(force: f64) -> Wrench {
    Wrench {
        force: Vector3::z() * -force,
        torque: Vector3::zeros(),
    }
}

/// Pulls a hanging body by a slowly growing force, and returns the largest one, weight included, that it bore, N.
fn borne(world: &mut World, id: u32, expected: f64) -> f64 {
    let weight = world.mass(id).unwrap() * G;
    let rate = 0.5 * (expected - weight) / 0.4;
    run_until(world, 0.2);
    let mut force = 0.0;
    while world.time() < 1.5 {
        let now = 0.5 * (expected - weight) + rate * (world.time() - 0.2);
        world.set_load(id, pull(now)).unwrap();
        world.step().unwrap();
        if world.contacts().is_empty() {
            return weight + force;
        }
        force = now;
    }
    f64::INFINITY
}

/// A cube under a plate hangs at rest, and falls when what pulls at it exceeds cohesion times area.
#[test]
fn a_hanging_cube_falls_at_the_pull_off_force() {
    let mut p = parameters(1e7, 0.5, 0.6);
    p.time_step.safety = 0.3;
    p.contact.cohesion = 2e4;
    let edge = 2.0 * half_edge();
    let pull_off = 2e4 * edge * edge;
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let plate = Wall::half_space("plate", -Vector3::z(), 0.0).unwrap();
    world.add_wall(plate, Drive::Fixed).unwrap();
    let place = at(Vector3::z() * (1e-6 - half_edge()));
    let spec = BodySpec::at_rest(shape, DENSITY, place);
    let id = world.add_body(spec).unwrap();
    let mut hung = world.clone();
    run_until(&mut hung, 0.3);
    assert!(hung.velocity(id).unwrap().norm() < 1e-6);
    assert!(hung.body_residual(id).unwrap() < 1e-3);
    let got = borne(&mut world, id, pull_off);
    assert!((got / pull_off - 1.0).abs() < 0.01, "{got} {pull_off}");
    let books = world.ledger();
    assert!(books.error_relative().abs() < 0.02, "{books:?}");
}

/// A cohesive block stands on a slope as long as W sin < mu (W cos + c A).
#[test]
fn a_cohesive_block_stands_on_a_steep_slope() {
    let (friction, held) = (0.3, 2.0);
    let edge = 2.0 * half_edge();
    let weight = DENSITY * edge.powi(3) * G;
    // sin - 0.3 cos = 0.6
    let steepest = (0.6 / 1.09_f64.sqrt()).asin() + 0.3_f64.atan();
    for (share, slides) in [(0.98, false), (1.02, true)] {
        let slope: f64 = steepest * share;
        let mut p = parameters(1e7, friction, 0.6);
        p.gravity = Vector3::new(slope.sin(), 0.0, -slope.cos()) * G;
        p.contact.cohesion = held * weight / (edge * edge);
        let mut world = World::new(p).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let place = at(Vector3::z() * (half_edge() - 1e-6));
        let id = world
            .add_body(BodySpec::at_rest(shape, DENSITY, place))
            .unwrap();
        run_until(&mut world, 0.4);
        let begin = world.velocity(id).unwrap().x;
        run_until(&mut world, 0.8);
        let gained = (world.velocity(id).unwrap().x - begin) / 0.4;
        let wanted = G * (slope.sin() - friction * (slope.cos() + held));
        if slides {
            assert!((gained / wanted - 1.0).abs() < 0.02, "{gained} {wanted}");
        } else {
            assert!(world.velocity(id).unwrap().norm() < 1e-5);
        }
    }
}

/// Without dashpots and friction cubes that stick, bounce and part keep their energy, though their attraction begins and ends
/// with jumps.
#[test]
fn cohesive_cubes_in_a_box_keep_their_energy() {
    let mut p = weightless(1e6, 0.0, 0.0);
    p.contact.cohesion = 2e3;
    p.time_step.safety = 0.3;
    let mut world = World::new(p).unwrap();
    let side = 0.22;
    for wall in Wall::closed_box(Vector3::zeros(), Vector3::repeat(side)).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    for k in 0..8_u32 {
        let bit = |n: u32| f64::from(k >> n & 1);
        let place = Vector3::new(bit(0), bit(1), bit(2)) * 0.08 + Vector3::repeat(0.07);
        let spec = BodySpec {
            velocity: Vector3::new((f64::from(k)).sin(), (2.0 * f64::from(k)).cos(), 0.3),
            angular_velocity: Vector3::new(1.0, -2.0, 0.5) * f64::from(k % 3),
            ..BodySpec::at_rest(shape, DENSITY, at(place))
        };
        world.add_body(spec).unwrap();
    }
    let mut deepest = 0.0_f64;
    let mut worst = 0.0_f64;
    while world.time() < 1.0 {
        world.step().unwrap();
        let books = world.ledger();
        deepest = deepest.min(world.contacts().iter().map(|c| c.adhesion.energy).sum());
        worst = worst.max(books.error().abs() / books.initial);
    }
    assert!(deepest < 0.0, "{deepest}");
    assert!(worst < 5e-3, "{worst}");
}

fn wet_heap() -> World {
    let mut p: WorldParameters = parameters(1e6, 0.6, 0.6);
    p.sleeping.enabled = true;
    p.contact.cohesion = 500.0;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 3.3 * D, Drive::Fixed);
    add_heap(&mut world, 60, 3);
    world
}

/// The same bits for any number of threads and through a checkpoint.
#[test]
fn attraction_has_the_same_bits_with_threads_and_through_bytes() {
    let steps = |world: &mut World, count: u32| {
        for _ in 0..count {
            world.step().unwrap();
        }
    };
    let mut world = wet_heap();
    steps(&mut world, 600);
    let mut again = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    steps(&mut world, 300);
    steps(&mut again, 300);
    assert_eq!(world.state_hash().unwrap(), again.state_hash().unwrap());
    assert!(world.contacts().iter().any(|c| c.adhesion.energy < 0.0));
    #[cfg(feature = "parallel")]
    {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let hash = pool.unwrap().install(|| {
            let mut world = wet_heap();
            steps(&mut world, 900);
            world.state_hash().unwrap()
        });
        assert_eq!(hash, world.state_hash().unwrap());
    }
}

#[test]
fn implicit_steps_refuse_attraction() {
    let mut p = parameters(1e6, 0.5, 0.6);
    p.contact.cohesion = 1.0;
    p.time_step.implicit = Some(ImplicitStep::default());
    let message = World::new(p).map(|_| ()).unwrap_err().to_string();
    assert!(
        message.contains("cohesion") && message.contains("step explicitly"),
        "{message}"
    );
}

/// Attraction that begins and ends within steps does the same, to second order in the step, whether or not the contacts are evaluated again between steps, as
/// where a law changes that none of them has: of a cohesive cube, and of a ball with adhesion and a liquid bridge.
#[test]
fn evaluations_between_steps_keep_the_weights_of_the_step() {
    let bounce = |ball: bool, disturbed: bool| {
        let mut p = weightless(1e7, 0.0, 0.0);
        p.time_step.largest = Some(1e-5);
        if ball {
            p.contact.adhesion_energy = 20.0;
            p.contact.liquid_bridge = Some(LiquidBridge {
                volume: 1e-10,
                tension: 40.0,
                contact_angle: 0.0,
            });
        } else {
            p.contact.cohesion = 2e4;
        }
        let mut world = World::new(p).unwrap();
        let reach = if ball { 0.5 * D } else { half_edge() };
        let shape = match ball {
            true => world.add_sphere("ball", reach),
            false => world.add_shape("P5", &solid("P5")),
        };
        add_floor(&mut world, Drive::Fixed);
        let spec = BodySpec {
            velocity: Vector3::z() * -0.5,
            ..BodySpec::at_rest(
                shape.unwrap(),
                DENSITY,
                at(Vector3::z() * (reach + 4.37e-5)),
            )
        };
        let id = world.add_body(spec).unwrap();
        let mut met = false;
        let mut friction = 0.1;
        while world.time() < 0.03 {
            world.step().unwrap();
            met |= !world.contacts().is_empty();
            if disturbed {
                friction = 0.3 - friction;
                let law = ContactParameters {
                    friction,
                    ..p.contact
                };
                world.set_law(MaterialId(7), MaterialId(8), law).unwrap();
            }
        }
        assert!(met && world.contacts().is_empty());
        let books = world.ledger();
        (world.velocity(id).unwrap().z, books.error() / books.initial)
    };
    for ball in [false, true] {
        let [(left, error), (disturbed, _)] = [false, true].map(|d| bounce(ball, d));
        assert!(
            (disturbed / left - 1.0).abs() < 1e-5,
            "{ball}: {disturbed} {left}"
        );
        assert!(error.abs() < 1e-3, "{ball}: {error}");
    }
}
