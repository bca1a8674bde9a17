//! Closed-form checks of the whole step: conservation, friction, stacking.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{DENSITY, parameters};
use femdem_contact::Wall;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Translation3, Vector3};
use femdem_mesh::{Polyhedron, Pose, Rotation};
use femdem_solve::{BodySpec, Drive, TimeStepParameters, World};

fn solid(id: &str, d: f64) -> Polyhedron {
    id.parse::<CatalogueShape>().unwrap().polyhedron(d).unwrap()
}

fn pose(position: Vector3<f64>, rotation: Rotation) -> Pose {
    Pose::from_parts(Translation3::from(position), rotation)
}

/// A pseudo-random number in [-1, 1] from an index: variety, not quality.
fn noise(i: u64) -> f64 {
    let x = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((x >> 11) as f64 / (1u64 << 52) as f64) - 1.0
}

/// 27 bodies of five shapes fly about in a closed box without friction or damping for one
/// second: the energy stays within 1e-5 and has no trend. Uses the culled production
/// kernel, where a wrong cull shows as growth of the energy.
#[test]
fn elastic_box_of_27_keeps_its_energy() {
    let mut p = parameters(1e7, 0.0, 0.0);
    p.gravity = Vector3::zeros();
    p.time_step = TimeStepParameters {
        safety: 0.1,
        largest: Some(1e-5),
        implicit: None,
    };
    let mut world = World::new(p).unwrap();
    let d = 0.1;
    let shapes: Vec<u32> = ["P1", "P5", "A1", "P3", "A10"]
        .iter()
        .map(|s| world.add_shape(s, &solid(s, d)).unwrap())
        .collect();
    let side = 3.3 * d;
    for wall in Wall::closed_box(Vector3::zeros(), Vector3::repeat(side)).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    for i in 0..27_u64 {
        let cell = Vector3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64);
        let position = (cell * 1.1).add_scalar(0.55) * d;
        let turn = Vector3::new(noise(7 * i), noise(7 * i + 1), noise(7 * i + 2)) * 3.0;
        let velocity = Vector3::new(noise(7 * i + 3), noise(7 * i + 4), noise(7 * i + 5));
        let spec = BodySpec {
            shape: shapes[i as usize % 5],
            density: DENSITY,
            pose: pose(position, Rotation::from_scaled_axis(turn)),
            velocity,
            angular_velocity: turn * 3.0,
            material: Default::default(),
        };
        world.add_body(spec).unwrap();
    }
    let start = world.kinetic_energy();
    let energy = |w: &World| w.ledger().final_energy();
    let (mut worst, mut halves) = (0.0_f64, [0.0_f64, 0.0]);
    let mut counts = [0.0, 0.0];
    let mut collisions = 0;
    while world.time() < 1.0 {
        for _ in 0..100 {
            world.step().unwrap();
        }
        let off = energy(&world) / start - 1.0;
        worst = worst.max(off.abs());
        let half = usize::from(world.time() > 0.5);
        halves[half] += off;
        counts[half] += 1.0;
        collisions += world.contacts().len();
    }
    assert!(collisions > 1000, "only {collisions} contacts were sampled");
    assert!(worst < 1e-5, "energy error {worst:e}");
    let trend = halves[1] / counts[1] - halves[0] / counts[0];
    assert!(trend.abs() < 5e-6, "energy trend {trend:e}");
}

/// Three bodies collide in free space: momentum and angular momentum are conserved to round-off.
#[test]
fn momentum_is_kept_to_round_off() {
    let mut p = parameters(1e7, 0.5, 0.3);
    p.gravity = Vector3::zeros();
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("A1", &solid("A1", 0.1)).unwrap();
    for i in 0..3 {
        let angle = f64::from(i) * 2.1;
        let out = Vector3::new(angle.cos(), angle.sin(), 0.1 * f64::from(i));
        let mut spec = BodySpec::at_rest(shape, DENSITY, pose(out * 0.12, Rotation::identity()));
        spec.velocity = -out + Vector3::new(0.1, 0.0, 0.0);
        spec.angular_velocity = Vector3::new(1.0, f64::from(i), -2.0);
        world.add_body(spec).unwrap();
    }
    let about = Vector3::new(0.3, 0.2, 0.1);
    let (p0, l0) = (world.linear_momentum(), world.angular_momentum(&about));
    let mut touched = false;
    while world.time() < 0.4 {
        world.step().unwrap();
        touched |= !world.contacts().is_empty();
    }
    assert!(touched);
    let speed = world.velocity(0).unwrap().norm();
    let scale = world.mass(0).unwrap() * speed.max(1.0);
    assert!((world.linear_momentum() - p0).norm() < 1e-12 * scale);
    assert!((world.angular_momentum(&about) - l0).norm() < 1e-12 * scale);
}

/// A block on a slope of angle `slope`, with a friction coefficient and one of walls, `far` m from the wall's
/// origin. Returns its displacement down the slope between two times, and its speed at both.
fn slide(
    slope: f64,
    friction: (f64, Option<f64>),
    far: f64,
    [from, to]: [f64; 2],
) -> (f64, [f64; 2]) {
    let mut p = parameters(1e6, friction.0, 0.6);
    p.contact.wall_friction = friction.1;
    let g = 9.81;
    // Gravity is turned instead of the plane.
    p.gravity = Vector3::new(g * slope.sin(), 0.0, -g * slope.cos());
    let mut world = World::new(p).unwrap();
    let d = 0.1;
    let shape = world.add_shape("P5", &solid("P5", d)).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let height = d / 12.0_f64.sqrt();
    let spec = BodySpec::at_rest(
        shape,
        DENSITY,
        pose(Vector3::new(far, 0.0, height), Rotation::identity()),
    );
    let body = world.add_body(spec).unwrap();
    let run = |world: &mut World, until: f64| {
        while world.time() < until {
            world.step().unwrap();
        }
        (
            world.position(body).unwrap().x,
            world.velocity(body).unwrap().x,
        )
    };
    let (x0, v0) = run(&mut world, from);
    let (x1, v1) = run(&mut world, to);
    (x1 - x0, [v0, v1])
}

#[test]
fn a_block_sticks_below_the_friction_angle() {
    for (friction, far) in [
        ((0.6, None), 0.0),
        ((0.0, Some(0.6)), 0.0),
        ((0.6, None), 100.0),
        ((0.6, None), 3000.0),
    ] {
        // In four seconds the rocking of the first touch decays.
        let (moved, _) = slide(0.9 * 0.6_f64.atan(), friction, far, [4.0, 6.0]);
        assert!(moved.abs() < 1e-12, "it drifted by {moved:e} m in 2 s");
    }
}

#[test]
fn a_block_slides_above_the_friction_angle() {
    let slope = 1.2 * 0.6_f64.atan();
    for (friction, wall) in [((0.6, None), 0.6), ((0.6, Some(0.0)), 0.0)] {
        let (_, [v0, v1]) = slide(slope, friction, 0.0, [0.5, 1.0]);
        let got = (v1 - v0) / 0.5;
        let want = 9.81 * (slope.sin() - wall * slope.cos());
        assert!((got / want - 1.0).abs() < 0.01, "{got} instead of {want}");
    }
}

/// Ten cubes, aligned, with coplanar side faces: the stack stands for 10 s.
#[test]
fn a_stack_of_ten_cubes_stands() {
    let d = 0.1;
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    let shape = world.add_shape("P5", &solid("P5", d)).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let edge = d / 3.0_f64.sqrt();
    for k in 0..10 {
        let z = edge * (f64::from(k) + 0.5);
        world
            .add_body(BodySpec::at_rest(
                shape,
                DENSITY,
                pose(Vector3::new(0.0, 0.0, z), Rotation::identity()),
            ))
            .unwrap();
    }
    let places = |w: &World| (0..10).map(|i| w.position(i).unwrap()).collect::<Vec<_>>();
    while world.time() < 1.0 {
        world.step().unwrap();
    }
    let settled = places(&world);
    while world.time() < 10.0 {
        world.step().unwrap();
    }
    let creep = places(&world)
        .iter()
        .zip(&settled)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    assert!(creep < 1e-3 * d, "the stack crept by {:e} d", creep / d);
    assert!(world.residuals().max_over_load < 0.01);
}
