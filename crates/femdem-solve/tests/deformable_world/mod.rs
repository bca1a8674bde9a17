//! Deformable bodies in a world: energy, momentum, mixtures with rigid bodies, friction, checkpoints.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod patches;
mod rocking;
mod round_trip;
mod sleep;

use femdem_contact::{BodyId, Wall};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, Drive, Medium, World, WorldParameters,
};

/// A block of `cells` with the given sides, centred at the origin.
fn block(cells: [u32; 3], sides: [f64; 3], element: Element, young: f64) -> DeformableModel {
    let mesh = TetMesh::block(cells, &Vector3::from(sides)).unwrap();
    let centre = Vector3::from(sides) * 0.5;
    let points = mesh.points().iter().map(|p| p - centre).collect();
    let mesh = TetMesh::new(points, mesh.tets().to_vec()).unwrap();
    let material = NeoHookean::new(young, 0.25).unwrap().into();
    let region = MaterialRegion {
        material,
        density: 1000.0,
    };
    DeformableModel::new(&mesh, element, vec![region], None).unwrap()
}

fn smooth(safety: f64) -> WorldParameters {
    let mut p = WorldParameters {
        gravity: Vector3::zeros(),
        ..WorldParameters::default()
    };
    p.contact.friction = 0.0;
    p.contact.damping_ratio = 0.0;
    p.time_step.safety = safety;
    p
}

/// Runs `work` on so many threads.
fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(work)
}

fn total(world: &World) -> f64 {
    world.ledger().final_energy()
}

/// An elastic cube bouncing between two walls keeps its energy to 1e-3 at half the critical step.
#[test]
fn a_bouncing_cube_keeps_its_energy() {
    for element in [Element::T4, Element::T10] {
        let mut world = World::new(smooth(0.5)).unwrap();
        for wall in Wall::closed_box(Vector3::repeat(-0.08), Vector3::repeat(0.08)).unwrap() {
            world.add_wall(wall, Drive::Fixed).unwrap();
        }
        let model = block([2, 2, 2], [0.1; 3], element, 1e6);
        let model = world
            .add_model("cube", model, ContactStiffness::default())
            .unwrap();
        let spec = DeformableSpec {
            velocity: Vector3::new(0.7, 0.5, -1.0),
            angular_velocity: Vector3::new(3.0, -2.0, 5.0),
            ..DeformableSpec::at_rest(model, Pose::identity())
        };
        world.add_deformable(spec).unwrap();
        let start = total(&world);
        let mut worst = 0.0_f64;
        let mut touched = false;
        while world.time() < 0.3 {
            world.step().unwrap();
            worst = worst.max((total(&world) / start - 1.0).abs());
            touched |= world.deformable_contacts().next().is_some();
        }
        assert!(touched && worst < 1e-3, "{element:?} {worst}");
    }
}

/// The first step in contact with a foundation much stiffer than the elements adds no energy.
#[test]
fn stiff_foundations_keep_the_energy() {
    for ratio in [5.0, 50.0] {
        let mut world = World::new(smooth(0.5)).unwrap();
        let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
        world.add_wall(floor, Drive::Fixed).unwrap();
        let model = block([2, 2, 2], [0.1; 3], Element::T4, 1e6);
        let stiffness = ContactStiffness::Ratio(ratio);
        let model = world.add_model("cube", model, stiffness).unwrap();
        let spec = DeformableSpec {
            velocity: -Vector3::z(),
            ..DeformableSpec::at_rest(model, Pose::translation(0.0, 0.0, 0.0507))
        };
        world.add_deformable(spec).unwrap();
        let start = total(&world);
        let mut worst = 0.0_f64;
        while world.time() < 0.02 {
            world.step().unwrap();
            worst = worst.max((total(&world) / start - 1.0).abs());
        }
        assert!(world.linear_momentum().z > 0.0);
        assert!(worst < 0.02, "{ratio}: {worst}");
    }
}

/// Two blocks that collide obliquely beside a rigid one conserve momentum and angular momentum, as soft as their
/// contacts and much stiffer, so that they are damped as wholes.
#[test]
fn collisions_keep_momentum() {
    collide_obliquely(1e6, ContactStiffness::default());
    collide_obliquely(1e9, ContactStiffness::Penalty(1e6));
}

fn collide_obliquely(young: f64, stiffness: ContactStiffness) {
    let mut p = smooth(0.5);
    p.contact.friction = 0.5;
    p.contact.damping_ratio = 0.3;
    let mut world = World::new(p).unwrap();
    let model = block([2, 2, 2], [0.1; 3], Element::T4, young);
    let model = world.add_model("cube", model, stiffness).unwrap();
    let a10 = "A10"
        .parse::<CatalogueShape>()
        .unwrap()
        .polyhedron(0.1)
        .unwrap();
    let shape = world.add_shape("A10", &a10).unwrap();
    let at = |x: f64, y: f64, vx: f64| DeformableSpec {
        velocity: Vector3::new(vx, 0.0, 0.0),
        ..DeformableSpec::at_rest(model, Pose::translation(x, y, 0.01))
    };
    world.add_deformable(at(-0.08, 0.0, 1.0)).unwrap();
    world.add_deformable(at(0.08, 0.03, -1.0)).unwrap();
    let mut rigid = BodySpec::at_rest(shape, 2000.0, Pose::translation(-0.2, -0.02, 0.0));
    rigid.velocity.x = 2.0;
    world.add_body(rigid).unwrap();
    let about = Vector3::new(0.3, -0.2, 0.1);
    let (p0, l0) = (world.linear_momentum(), world.angular_momentum(&about));
    let mut pairs = std::collections::BTreeSet::new();
    while world.time() < 0.1 {
        world.step().unwrap();
        pairs.extend(world.deformable_contacts().map(|c| (c.a, c.b)));
    }
    assert!(pairs.len() >= 2, "{pairs:?}");
    let (p1, l1) = (world.linear_momentum(), world.angular_momentum(&about));
    assert!((p1 - p0).norm() < 1e-12 * 4.0, "{}", p1 - p0);
    assert!((l1 - l0).norm() < 1e-12 * 4.0, "{}", l1 - l0);
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 3e-3, "{ledger:?}");
}

/// Eight cubes in a box bounce for a while and keep their energy to 1e-3 at half the critical step.
#[test]
fn eight_cubes_in_a_box_keep_their_energy() {
    let mut world = World::new(smooth(0.5)).unwrap();
    for wall in Wall::closed_box(Vector3::repeat(-0.13), Vector3::repeat(0.13)).unwrap() {
        world.add_wall(wall, Drive::Fixed).unwrap();
    }
    let model = block([2, 2, 2], [0.1; 3], Element::T4, 1e6);
    let model = world
        .add_model("cube", model, ContactStiffness::default())
        .unwrap();
    for k in 0..8 {
        let side = |bit: u32| 0.06 * (2.0 * f64::from(k >> bit & 1) - 1.0);
        let spin = f64::from(k) - 3.5;
        world
            .add_deformable(DeformableSpec {
                velocity: Vector3::new(-side(1), side(2), -side(0)) * 8.0,
                angular_velocity: Vector3::new(spin, -0.5 * spin, 2.0),
                ..DeformableSpec::at_rest(model, Pose::translation(side(0), side(1), side(2)))
            })
            .unwrap();
    }
    let start = total(&world);
    let (mut worst, mut pairs) = (0.0_f64, std::collections::BTreeSet::new());
    while world.time() < 0.15 {
        world.step().unwrap();
        worst = worst.max((total(&world) / start - 1.0).abs());
        pairs.extend(world.deformable_contacts().map(|c| (c.a, c.b)));
    }
    assert!(pairs.len() > 20, "{} pairs met", pairs.len());
    assert!(worst < 1e-3, "{worst}");
}

/// The support on which a block slides.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Slope {
    Wall,
    Rigid,
    Deformable,
    /// The same with elements six times as large as the block's, added after it.
    CoarseAndLater,
}

/// A deformable block at rest on a slope of angle `t` (gravity is turned instead), and the block.
fn on_a_slope(slope: Slope, mu: f64, t: f64) -> (World, BodyId) {
    let mut p = smooth(0.9);
    p.gravity = 9.81 * Vector3::new(t.sin(), 0.0, -t.cos());
    p.contact.friction = mu;
    p.contact.damping_ratio = 0.3;
    let mut world = World::new(p).unwrap();
    let slab = [0.6, 0.2, 0.05];
    let add_block = |world: &mut World| {
        let model = block([3, 3, 2], [0.1, 0.1, 0.06], Element::T4, 1e6);
        let stiffness = ContactStiffness::default();
        let model = world.add_model("block", model, stiffness).unwrap();
        let pose = Pose::translation(-0.05, 0.003, 0.03 - 1e-5);
        world
            .add_deformable(DeformableSpec::at_rest(model, pose))
            .unwrap()
    };
    let before = (slope == Slope::CoarseAndLater).then(|| add_block(&mut world));
    match slope {
        Slope::Wall => {
            let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
            world.add_wall(floor, Drive::Fixed).unwrap();
        }
        Slope::Rigid => {
            let mesh = TetMesh::block([1, 1, 1], &Vector3::from(slab)).unwrap();
            let surface = mesh.surface().unwrap();
            let shape = world.add_shape("slab", &surface).unwrap();
            let spec = BodySpec::at_rest(shape, 1000.0, Pose::translation(-0.2, -0.1, -0.05));
            world.add_driven_body(spec, Drive::Fixed).unwrap();
        }
        Slope::Deformable | Slope::CoarseAndLater => {
            let cells = if before.is_some() {
                [3, 1, 1]
            } else {
                [12, 4, 1]
            };
            let model = block(cells, slab, Element::T4, 1e7);
            let mut boundary = Boundary::default();
            let bottom = Selection::Plane {
                normal: Vector3::z(),
                offset: -0.5 * slab[2],
                tolerance: 1e-9,
            };
            boundary.fix(&model, &bottom, [true; 3]).unwrap();
            let stiffness = ContactStiffness::default();
            let model = world.add_model("slab", model, stiffness).unwrap();
            let pose = Pose::translation(0.1, 0.0, -0.5 * slab[2]);
            world
                .add_deformable(DeformableSpec {
                    boundary,
                    ..DeformableSpec::at_rest(model, pose)
                })
                .unwrap();
        }
    }
    let id = before.unwrap_or_else(|| add_block(&mut world));
    (world, id)
}

fn place_and_speed(world: &World, id: BodyId) -> (f64, f64) {
    let body = world.deformable(id).unwrap();
    let mass: f64 = body.model().masses().iter().sum();
    (body.centroid().x, body.momentum().x / mass)
}

/// Below the angle of friction a block sticks without creep; above it slides with
/// g (sin t - mu cos t) to 2 %.
#[test]
fn blocks_stick_and_slide_on_slopes() {
    for slope in [
        Slope::Wall,
        Slope::Rigid,
        Slope::Deformable,
        Slope::CoarseAndLater,
    ] {
        let (mu, t) = (0.5_f64, 0.4_f64);
        let (mut world, id) = on_a_slope(slope, mu, t);
        let settle = |world: &mut World, until: f64| {
            while world.time() < until {
                world.step().unwrap();
            }
        };
        // It comes to rest in a medium, and stays at rest without it.
        let medium = Medium {
            drag: 100.0,
            ..Medium::default()
        };
        world.set_medium(medium).unwrap();
        settle(&mut world, 0.1);
        world.set_medium(Medium::default()).unwrap();
        settle(&mut world, 0.15);
        let (x0, _) = place_and_speed(&world, id);
        settle(&mut world, 0.2);
        let (x1, v1) = place_and_speed(&world, id);
        assert!((x1 - x0).abs() < 1e-6, "{slope:?}: creeps by {}", x1 - x0);
        assert!(v1.abs() < 1e-4, "{slope:?}: {v1}");

        let mu = 0.2;
        let (mut world, id) = on_a_slope(slope, mu, t);
        settle(&mut world, 0.05);
        let (_, v0) = place_and_speed(&world, id);
        settle(&mut world, 0.15);
        let (_, v1) = place_and_speed(&world, id);
        let acceleration = (v1 - v0) / 0.1;
        let expected = 9.81 * (t.sin() - mu * t.cos());
        let ratio = acceleration / expected;
        assert!((ratio - 1.0).abs() < 0.02, "{slope:?}: {ratio}");
    }
}

/// A cube falls on another that sleeps, with or without a deformable body far away from both. Returns their
/// positions after the impact, the dissipated energy and the time. The step is at the upper limit that is set.
fn strike_a_sleeper(far: bool) -> (Vec<Vector3>, f64, f64) {
    let mut p = WorldParameters::default();
    p.time_step.largest = Some(1e-4);
    let mut world = World::new(p).unwrap();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, Drive::Fixed).unwrap();
    let cube = "P5".parse::<CatalogueShape>().unwrap();
    let cube = cube.polyhedron(0.1 * 3_f64.sqrt()).unwrap();
    let shape = world.add_shape("cube", &cube).unwrap();
    let at = |x, z| BodySpec::at_rest(shape, 2000.0, Pose::translation(x, 0.0, z));
    let below = world.add_body(at(0.0, 0.05)).unwrap();
    if far {
        let model = block([1; 3], [0.1; 3], Element::T4, 1e4);
        let model = world
            .add_model("far", model, ContactStiffness::Ratio(0.1))
            .unwrap();
        let place = Pose::translation(50.0, 0.0, 1e3);
        world
            .add_deformable(DeformableSpec::at_rest(model, place))
            .unwrap();
    }
    while !world.is_asleep(below) {
        world.step().unwrap();
        assert!(world.time() < 1.0, "it does not sleep");
    }
    let fall = BodySpec {
        velocity: Vector3::new(0.1, 0.0, -1.0),
        ..at(0.03, 0.151)
    };
    let above = world.add_body(fall).unwrap();
    let until = world.time() + 0.02;
    while world.time() < until {
        world.step().unwrap();
    }
    let places = [below, above].map(|i| world.position(i).unwrap());
    let ledger = world.ledger();
    let dissipated = ledger.dissipated_damping + ledger.dissipated_friction;
    (places.to_vec(), dissipated, world.time())
}

/// The kick of a waking body uses its contact forces at that time, not those when it fell asleep.
#[test]
fn a_deformable_body_far_away_changes_nothing() {
    assert_eq!(strike_a_sleeper(false), strike_a_sleeper(true));
}

/// A world of deformable and rigid bodies continues bit for bit after a checkpoint, and with any number of
/// threads.
#[test]
fn the_same_bits_after_a_checkpoint_and_with_threads() {
    let run = |threads: usize, split: bool| {
        on_threads(threads, || {
            let (mut world, _) = on_a_slope(Slope::Deformable, 0.3, 0.4);
            let a10 = "A10"
                .parse::<CatalogueShape>()
                .unwrap()
                .polyhedron(0.05)
                .unwrap();
            let shape = world.add_shape("A10", &a10).unwrap();
            let at = Pose::translation(-0.05, 0.0, 0.09);
            world
                .add_body(BodySpec::at_rest(shape, 2000.0, at))
                .unwrap();
            for k in 0..400 {
                if split && k == 250 {
                    world = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
                }
                world.step().unwrap();
            }
            world.to_bytes().unwrap()
        })
    };
    let one = run(1, false);
    assert!(one == run(3, false), "threads");
    assert!(one == run(2, true), "checkpoint");
}
