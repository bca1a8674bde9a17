//! Exact spheres as mechanics says, with the default damping: rest, bounces, rolling, bowling.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{D, DENSITY, G, add_floor, at, parameters, run_until, solid, weightless};
use femdem_contact::restitution;
use femdem_mesh::nalgebra::Vector3;
use femdem_solve::{BodySpec, Drive, World, WorldParameters};
use std::f64::consts::PI;

const RADIUS: f64 = 0.01;

fn ball_on_floor(p: WorldParameters, height: f64) -> World {
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_sphere("ball", RADIUS).unwrap();
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * height));
    world.add_body(spec).unwrap();
    world
}

/// 4/3 pi R^3 and 2/5 m R^2, of the ball and not of the polyhedron that is drawn.
#[test]
fn it_has_the_mass_of_the_ball() {
    let world = ball_on_floor(parameters(1e6, 0.5, 0.6), 1.0);
    let mass = DENSITY * 4.0 / 3.0 * PI * RADIUS.powi(3);
    assert!((world.mass(0).unwrap() / mass - 1.0).abs() < 1e-15);
    let shape = &world.shapes()[0];
    assert_eq!((shape.volume * DENSITY, shape.sphere), (mass, Some(RADIUS)));
    assert!((shape.polyhedron.bounding_radius() / RADIUS - 1.0).abs() < 1e-12);
    let (low, high) = world.bounds(0).unwrap();
    assert_eq!([low.z, high.z], [1.0 - RADIUS, 1.0 + RADIUS]);
}

/// At rest 2 pi p e^2 (1 - 2 e/(3 R)) = m g at the depth e.
#[test]
fn it_rests_at_the_depth_of_the_law() {
    let mut world = ball_on_floor(parameters(1e6, 0.5, 0.6), RADIUS);
    run_until(&mut world, 0.5);
    let depth = RADIUS - world.position(0).unwrap().z;
    let force = 2.0 * PI * 1e6 * depth * depth * (1.0 - 2.0 * depth / (3.0 * RADIUS));
    let weight = world.mass(0).unwrap() * G;
    assert!((force / weight - 1.0).abs() < 1e-6, "{force} for {weight}");
}

/// Speed after over before an impact on a floor or on an equal, fixed ball.
fn rebound(damping: f64, on_ball: bool, safety: f64) -> f64 {
    let mut p = weightless(1e8, 0.5, damping);
    p.time_step.safety = safety;
    let mut world = World::new(p).unwrap();
    let shape = world.add_sphere("ball", RADIUS).unwrap();
    let gap = if on_ball { 3.0 } else { 1.0 } * RADIUS;
    if on_ball {
        let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * RADIUS));
        world.add_driven_body(spec, Drive::Fixed).unwrap();
    } else {
        add_floor(&mut world, Drive::Fixed);
    }
    let spec = BodySpec {
        velocity: Vector3::z() * -0.5,
        ..BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * (gap + 0.001)))
    };
    let ball = world.add_body(spec).unwrap();
    run_until(&mut world, 0.02);
    assert!(world.contacts().is_empty());
    assert!(world.angular_velocity(ball).unwrap().norm() < 1e-9);
    world.velocity(ball).unwrap().z / 0.5
}

/// It leaves a floor and another ball with the coefficient of restitution of the damping ratio: to 3 % with the default
/// step, and to 0.5 % with a short one.
#[test]
fn it_bounces_with_the_restitution() {
    let usual = WorldParameters::default().time_step.safety;
    for (safety, tolerance) in [(usual, 0.03), (0.1, 0.005)] {
        for damping in [0.0, 0.2, 0.6] {
            for on_ball in [false, true] {
                let out = rebound(damping, on_ball, safety);
                let want = restitution(damping);
                let error = (out / want - 1.0).abs();
                assert!(
                    error < tolerance,
                    "{damping} {on_ball} {safety}: {out} for {want}"
                );
            }
        }
    }
}

/// Down a slope with 5/7 g sin, whatever the damping.
#[test]
fn it_rolls_down_a_slope() {
    for (degrees, damping) in [(5.0_f64, 0.6), (20.0, 0.6), (20.0, 0.0)] {
        let mut p = parameters(1e8, 0.6, damping);
        let (sin, cos) = degrees.to_radians().sin_cos();
        p.gravity = Vector3::new(sin, 0.0, -cos) * G;
        let mut world = ball_on_floor(p, 0.9987 * RADIUS);
        run_until(&mut world, 0.5);
        let got = world.velocity(0).unwrap().x / world.time();
        let want = 5.0 / 7.0 * G * sin;
        assert!(
            (got / want - 1.0).abs() < 2e-3,
            "{degrees}: {got} for {want}"
        );
    }
}

/// Sliding without spin, it slows down by mu g until it rolls with 5/7 of its speed, and then goes on.
#[test]
fn a_bowling_ball_ends_up_rolling() {
    let (speed, mu) = (1.0, 0.2);
    let mut world = World::new(parameters(1e8, mu, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_sphere("ball", RADIUS).unwrap();
    let depth = (DENSITY * 4.0 / 3.0 * RADIUS.powi(3) * G / (2.0 * 1e8)).sqrt();
    let spec = BodySpec {
        velocity: Vector3::x() * speed,
        ..BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * (RADIUS - depth)))
    };
    world.add_body(spec).unwrap();
    let slides = 2.0 / 7.0 * speed / (mu * G);
    run_until(&mut world, 0.5 * slides);
    let got = world.velocity(0).unwrap().x;
    let want = speed - mu * G * world.time();
    assert!((got / want - 1.0).abs() < 2e-3, "{got} for {want}");
    run_until(&mut world, 3.0 * slides);
    let (velocity, rate) = (
        world.velocity(0).unwrap(),
        world.angular_velocity(0).unwrap(),
    );
    assert!(
        (velocity.x / (5.0 / 7.0 * speed) - 1.0).abs() < 5e-3,
        "{velocity:?}"
    );
    let grip = rate.y * RADIUS / velocity.x;
    assert!((grip - 1.0).abs() < 2e-3, "{grip}");
}

/// A head-on and an oblique impact of two balls without friction: momenta along the line of centres are exchanged.
#[test]
fn billiard_balls_exchange_momentum() {
    for offset in [0.0, 0.5 * RADIUS, 1.2 * RADIUS] {
        let mut world = World::new(weightless(1e8, 0.0, 0.0)).unwrap();
        let shape = world.add_sphere("ball", RADIUS).unwrap();
        let still = BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros()));
        world.add_body(still).unwrap();
        let spec = BodySpec {
            velocity: Vector3::x(),
            ..BodySpec::at_rest(shape, DENSITY, at(Vector3::new(-0.022, offset, 0.0)))
        };
        world.add_body(spec).unwrap();
        run_until(&mut world, 0.05);
        let (a, b) = (world.velocity(0).unwrap(), world.velocity(1).unwrap());
        let sin = offset / (2.0 * RADIUS);
        let line = Vector3::new((1.0 - sin * sin).sqrt(), -sin, 0.0);
        let want = line * line.x;
        assert!((a - want).norm() < 0.02, "{offset}: {a:?} for {want:?}");
        assert!((a + b - Vector3::x()).norm() < 1e-9);
        let energy = a.norm_squared() + b.norm_squared();
        assert!((energy - 1.0).abs() < 5e-3, "{offset}: {energy}");
        assert!(world.angular_velocity(0).unwrap().norm() < 1e-12);
    }
}

/// A heap of balls and a cube is the same, bit for bit, whether it was stored on the way or not.
#[test]
fn a_heap_goes_on_from_a_checkpoint() {
    let mut p = parameters(1e6, 0.5, 0.6);
    p.gravity = -Vector3::z() * G;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let ball = world.add_sphere("ball", RADIUS).unwrap();
    let cube = world.add_shape("cube", &solid("P5")).unwrap();
    for i in 0..9 {
        let shape = if i % 3 == 2 { cube } else { ball };
        let lean = 0.02 * f64::from(i % 2);
        let place = Vector3::new(lean, 0.3 * lean, D * (0.51 + 1.01 * f64::from(i)));
        world
            .add_body(BodySpec::at_rest(shape, DENSITY, at(place)))
            .unwrap();
    }
    run_until(&mut world, 0.3);
    let mut other = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    run_until(&mut world, 0.4);
    run_until(&mut other, 0.4);
    assert!(world.contacts().len() > 3);
    assert_eq!(world.to_bytes().unwrap(), other.to_bytes().unwrap());
    assert!(
        world
            .add_sphere("none", 0.0)
            .unwrap_err()
            .to_string()
            .contains("radius")
    );
}
