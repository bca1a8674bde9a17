//! Bodies and walls of any shape in the world: conservation laws, interlocked bodies, and checkpoints.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    DENSITY, G, add_floor, add_mesh, add_sides, noise, parameters, pose, turned, weightless,
};
use crate::meshes;
use femdem_contact::{Field, MeshWall, Partner, Wall, restitution};
use femdem_mesh::nalgebra::{Point3, Vector3};
use femdem_mesh::{Polyhedron, Pose, Rotation};
use femdem_solve::{BodySpec, Drive, SolveError, World};
use std::f64::consts::FRAC_PI_2;

/// Pellets with a hole and dolosse fly about in a closed box, without friction and damping. Returns the
/// largest energy error, its trend, and how many patches and pairs there were.
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
                material: Default::default(),
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

/// Twenty of each for a whole second.
#[test]
#[ignore = "a minute: cargo test --release -p femdem-solve --test all any_shape:: -- --ignored"]
fn elastic_box_keeps_its_energy_for_a_second() {
    let (worst, trend, seen) = elastic_box(40, 1.0);
    assert!(
        worst < 1e-4 && trend.abs() < 2e-5,
        "energy error {worst:e}, trend {trend:e}, patches and pairs {seen:?}"
    );
}

/// Three dolosse collide in free space, with friction and damping: momentum and angular momentum are
/// conserved to round-off.
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

/// A block on two feet hits a floor squarely, without weight: two patches rebound like one contact.
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

/// Two rings hang from a third that is held, each in the one above, crosswise. They come to rest, each
/// carries what hangs below it, and nothing creeps.
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
        let turn = if k.is_multiple_of(2) { upright } else { cross };
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
        world.add_shape("A1", &crate::common::solid("A1")).unwrap(),
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
