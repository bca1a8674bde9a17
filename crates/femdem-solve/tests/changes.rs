//! Worlds that are changed while they run, and their energy ledger.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, at, half_edge, parameters, run_until, solid, weightless,
};
use femdem_contact::{BodyId, ContactParameters, Wall};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, Drive, World, WorldRelaxation};

fn add_cube(world: &mut World) -> BodyId {
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let place = at(Vector3::z() * half_edge());
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, place))
        .unwrap()
}

fn add_soft_cube(
    world: &mut World,
    stiffness: ContactStiffness,
    spec: impl Fn(u32) -> DeformableSpec,
) {
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(D)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e7, 0.0).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let model = world.add_model("cube", model, stiffness).unwrap();
    world.add_deformable(spec(model)).unwrap();
}

fn with(world: &World, change: impl Fn(&mut ContactParameters)) -> ContactParameters {
    let mut law = world.parameters().contact;
    change(&mut law);
    law
}

/// A cube at rest on a slope, held by friction, slides once the friction is reduced.
#[test]
fn a_new_law_wakes_what_sleeps() {
    let mut p = parameters(1e7, 0.8, 0.6);
    let angle = 0.4_f64;
    p.gravity = Vector3::new(angle.sin(), 0.0, -angle.cos()) * G;
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let cube = add_cube(&mut world);
    while !world.is_asleep(cube) {
        world.step().unwrap();
        assert!(world.time() < 5.0);
    }
    let law = with(&world, |law| law.friction = 0.1);
    world.set_contact(law).unwrap();
    let start = world.time();
    run_until(&mut world, start + 0.2);
    let expected = G * (angle.sin() - 0.1 * angle.cos()) * (world.time() - start);
    let speed = world.velocity(cube).unwrap().x;
    assert!((speed / expected - 1.0).abs() < 0.02, "{speed} {expected}");
}

/// Contacts that are made stiffer under load store more energy, which is booked as work; so do friction
/// springs.
#[test]
fn a_new_law_is_on_the_books() {
    let mut p = parameters(1e6, 0.8, 0.6);
    p.gravity = Vector3::new(0.3, 0.0, -1.0) * G;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_cube(&mut world);
    run_until(&mut world, 0.3);
    let before = world.ledger();
    let law = with(&world, |law| {
        law.penalty *= 10.0;
        law.tangential_ratio *= 0.5;
    });
    world.set_contact(law).unwrap();
    let after = world.ledger();
    assert!((after.elastic / before.elastic - 10.0).abs() < 1e-9);
    assert!(after.work_in > before.work_in + 5.0 * before.elastic);
    let missed = (after.error() - before.error()).abs();
    assert!(missed < 1e-9 * after.elastic, "{missed} {}", after.elastic);
    let dissipated = after.dissipated_friction - before.dissipated_friction;
    assert!(dissipated.abs() < 1e-9 * after.elastic, "{dissipated}");
}

/// A deformable body whose contact stiffness follows the law penetrates less when the law is stiffer.
#[test]
fn deformable_bodies_follow_a_new_law() {
    let depth = |penalty: f64, later: f64| {
        let mut world = World::new(parameters(penalty, 0.6, 0.6)).unwrap();
        add_floor(&mut world, Drive::Fixed);
        add_soft_cube(&mut world, ContactStiffness::Law, |model| {
            DeformableSpec::at_rest(model, Pose::translation(0.0, 0.0, -1e-5))
        });
        let law = with(&world, |law| law.penalty = later);
        world.set_contact(law).unwrap();
        world.relax(&WorldRelaxation::default()).unwrap();
        let body = world.deformable(0).unwrap();
        let nodes = body.positions().iter().map(|x| x.z);
        -nodes.fold(f64::INFINITY, f64::min)
    };
    let (changed, made_so) = (depth(1e5, 1e6), depth(1e6, 1e6));
    assert!(
        (changed / made_so - 1.0).abs() < 1e-2,
        "{changed} {made_so}"
    );
    assert!(depth(1e5, 1e5) > 5.0 * made_so);
    // At once, and on the books: the energy is linear in the penalty.
    let mut world = World::new(parameters(1e5, 0.0, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_soft_cube(&mut world, ContactStiffness::Law, |model| {
        DeformableSpec::at_rest(model, Pose::translation(0.0, 0.0, -1e-5))
    });
    world.step().unwrap();
    let before = world.ledger();
    let law = with(&world, |law| law.penalty = 1e6);
    world.set_contact(law).unwrap();
    let after = world.ledger();
    assert!((after.elastic / before.elastic / 10.0 - 1.0).abs() < 1e-9);
    let (gained, work) = (
        after.elastic - before.elastic,
        after.work_in - before.work_in,
    );
    assert!((work / gained - 1.0).abs() < 1e-9, "{work} {gained}");
}

/// A moving body that is suddenly held gives up its kinetic energy as work.
#[test]
fn holding_what_moves_is_on_the_books() {
    let mut world = World::new(weightless(1e6, 0.6, 0.6)).unwrap();
    add_soft_cube(&mut world, ContactStiffness::default(), |model| {
        DeformableSpec {
            velocity: Vector3::x(),
            ..DeformableSpec::at_rest(model, Pose::identity())
        }
    });
    for _ in 0..5 {
        world.step().unwrap();
    }
    let body = world.deformable(0).unwrap();
    let mut boundary = Boundary::default();
    let places = body.positions().to_vec();
    boundary
        .drive_from(
            body.model(),
            &Selection::All,
            [true; 3],
            Drive::Fixed,
            &places,
        )
        .unwrap();
    world.set_boundary(0, boundary).unwrap();
    for _ in 0..5 {
        world.step().unwrap();
    }
    let (ledger, energy) = (world.ledger(), 0.5 * DENSITY * D.powi(3));
    assert!((ledger.work_in / energy + 1.0).abs() < 1e-9, "{ledger:?}");
    assert!(ledger.error().abs() < 1e-9 * energy, "{ledger:?}");
}

/// A wall that is put where a body sleeps pushes it out.
#[test]
fn a_new_wall_wakes_what_sleeps() {
    let mut p = parameters(1e6, 0.6, 0.6);
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let cube = add_cube(&mut world);
    while !world.is_asleep(cube) {
        world.step().unwrap();
        assert!(world.time() < 5.0);
    }
    let side = Wall::half_space("side", Vector3::x(), 2e-3 - half_edge()).unwrap();
    let side = world.add_wall(side, Drive::Fixed).unwrap();
    world.step().unwrap();
    let pushed = world.wall_load(side).unwrap().total.force.x;
    assert!(pushed < 0.0, "{pushed}");
    assert!(world.load(cube).unwrap().contacts == 2);
    let start = world.time();
    run_until(&mut world, start + 1.0);
    assert!(world.position(cube).unwrap().x > 1.9e-3);
}

/// Pose of a driven wall.
#[test]
fn a_driven_wall_has_a_pose() {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    let drive = Drive::Linear {
        velocity: Vector3::new(0.5, 0.0, 0.0),
        start: 0.0,
        end: 10.0,
    };
    let floor = add_floor(&mut world, drive);
    run_until(&mut world, 0.1);
    let way = world.wall_pose(floor).unwrap().translation.vector;
    assert!((way - Vector3::x() * (0.5 * world.time())).norm() < 1e-12);
    assert!(world.wall_pose(floor + 1).is_none() && world.wall_load(floor + 1).is_none());
}

/// Cubes are set into the floor, beside each other, and a soft one into a cube. Their overlaps drive them
/// apart, and all of this energy is in the initial energy. A wall placed where cubes are brings its own.
#[test]
fn overlaps_of_what_is_added_are_on_the_books() {
    let mut p = parameters(1e7, 0.0, 0.0);
    p.gravity = Vector3::zeros();
    p.time_step.safety = 0.05;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let rigid = |x: f64, z: f64| BodySpec::at_rest(shape, DENSITY, at(Vector3::new(x, 0.0, z)));
    let deep = 0.05 * half_edge();
    let two = 2.0 * half_edge() - deep;
    world.add_body(rigid(0.0, half_edge() - deep)).unwrap();
    world.add_body(rigid(0.0, half_edge() + two)).unwrap();
    let check = |world: &mut World, from: f64| {
        let time = world.time();
        run_until(world, time + 0.02);
        let ledger = world.ledger();
        assert!(ledger.initial > from, "{ledger:?}");
        assert!(ledger.error().abs() < 1e-3 * ledger.initial, "{ledger:?}");
        ledger.initial
    };
    let first = check(&mut world, 0.0);
    world.add_body(rigid(0.3, half_edge() - deep)).unwrap();
    let corner = at(Vector3::new(
        0.3 - 0.5 * D,
        -0.5 * D,
        2.0 * half_edge() - 2.0 * deep,
    ));
    add_soft_cube(&mut world, ContactStiffness::default(), |model| {
        DeformableSpec::at_rest(model, corner)
    });
    let second = check(&mut world, first);
    let front = world.position(0).unwrap().x - half_edge() + deep;
    let wall = Wall::half_space("x-", Vector3::x(), front).unwrap();
    world.add_wall(wall, Drive::Fixed).unwrap();
    check(&mut world, second);
}
