//! A state as the beginning of another motion.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, add_heap, add_sides, at, half_edge, parameters, run_until, solid,
};
use femdem_contact::BodyId;
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::{TetMesh, Vector3};
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, Drive, World};

fn linear(velocity: Vector3, start: f64, end: f64) -> Drive {
    Drive::Linear {
        velocity,
        start,
        end,
    }
}

fn heap() -> (World, Vec<BodyId>) {
    let mut world = World::new(parameters(1e6, 0.5, 0.3)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    add_sides(&mut world, 2.2 * D, Drive::Fixed);
    let bodies = add_heap(&mut world, 12, 2);
    (world, bodies)
}

/// The clock says nothing about the motion: without anything prescribed it goes on to the same bits.
#[test]
fn the_motion_goes_on_under_a_new_clock() {
    let (mut world, bodies) = heap();
    run_until(&mut world, 0.25);
    let mut other = world.clone();
    other.restart_clock();
    assert_eq!((other.time(), other.steps()), (0.0, 0));
    assert_eq!(other.ledger().error(), 0.0);
    assert_eq!(other.ledger().dissipated(), 0.0);
    assert_eq!(
        (other.ledger().exchanged, other.ledger().work_in),
        (0.0, 0.0)
    );
    assert!((other.ledger().initial - world.ledger().final_energy()).abs() < 1e-12);
    for _ in 0..300 {
        world.step().unwrap();
        other.step().unwrap();
    }
    for &id in &bodies {
        assert_eq!(world.pose(id), other.pose(id));
    }
    let (whole, part) = (world.ledger(), other.ledger());
    assert!(part.dissipated_damping > 0.0 && part.dissipated_damping < whole.dissipated_damping);
    assert!(part.error_relative().abs() < 0.02, "{part:?}");
}

/// What has moved stays where it is and moves as far once more.
#[test]
fn motions_begin_anew_from_where_they_are() {
    let mut world = World::new(parameters(1e6, 0.5, 0.3)).unwrap();
    let rock = Drive::Rock {
        axis: Vector3::y(),
        point: Vector3::new(0.0, 0.0, -1.0),
        stroke: 0.2,
        frequency: 1.0,
        start: 0.0,
        periods: 4,
    };
    let lift = linear(Vector3::new(0.0, 0.0, -0.5), 0.1, 0.2);
    let (wall, tilted) = (add_floor(&mut world, lift), add_floor(&mut world, rock));
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z() * 5.0));
    let driven = world.add_driven_body(spec, lift).unwrap();
    run_until(&mut world, 0.3);
    let state = |world: &World| {
        let of_wall = world.wall_pose(wall).unwrap().translation.vector.z;
        (of_wall, world.position(driven).unwrap().z)
    };
    let before = (state(&world), world.wall_pose(tilted).unwrap());
    world.restart_clock();
    let after = (state(&world), world.wall_pose(tilted).unwrap());
    assert!(
        (before.0.0 + 0.05).abs() < 1e-12 && (before.0.1 - 4.95).abs() < 1e-12,
        "{before:?}"
    );
    assert_eq!(before.0, after.0);
    assert!(before.1.rotation.angle_to(&after.1.rotation) < 1e-7);
    assert!(before.1.rotation.angle() > 0.05);
    run_until(&mut world, 0.3);
    let end = state(&world);
    assert!(
        (end.0 + 0.1).abs() < 1e-12 && (end.1 - 4.9).abs() < 1e-12,
        "{end:?}"
    );
}

/// A body that is held falls once it is free, and stays where it is once it is held again; the books count it only while
/// it is free.
#[test]
fn bodies_are_driven_and_set_free() {
    let mut world = World::new(parameters(1e6, 0.5, 0.3)).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z()));
    let id = world
        .add_driven_body(spec, linear(Vector3::x(), 0.0, 9.0))
        .unwrap();
    run_until(&mut world, 0.1);
    assert_eq!(world.ledger().final_energy(), 0.0);
    world.drive_body(id, None).unwrap();
    assert_eq!(world.body_drive(id), None);
    let (began, mass) = (world.time(), world.mass(id).unwrap());
    assert!((world.ledger().kinetic - 0.5 * mass).abs() < 1e-9);
    run_until(&mut world, began + 0.2);
    let fall = world.time() - began;
    let place = world.position(id).unwrap();
    assert!((place.z - (1.0 - 0.5 * G * fall * fall)).abs() < 1e-4);
    assert!((place.x - world.time()).abs() < 1e-9, "{place}");
    assert!(world.ledger().error().abs() < 1e-4 * mass);
    world.drive_body(id, Some(Drive::Fixed)).unwrap();
    assert_eq!(world.body_drive(id), Some(Drive::Fixed));
    run_until(&mut world, began + 0.4);
    assert_eq!(world.position(id), Some(place));
    assert!(world.ledger().error().abs() < 1e-4 * mass);
    let refused = world.drive_body(7, None).unwrap_err().to_string();
    assert!(refused.contains("body 7"), "{refused}");
}

/// A cube at rest on a floor stays there under gravity that is turned as far as friction allows, and slides under more; the
/// books close.
#[test]
fn gravity_can_be_turned() {
    let mut p = parameters(1e7, 0.5, 0.6);
    p.sleeping.enabled = true;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let place = at(Vector3::z() * half_edge());
    let cube = world
        .add_body(BodySpec::at_rest(shape, DENSITY, place))
        .unwrap();
    while !world.is_asleep(cube) {
        world.step().unwrap();
        assert!(world.time() < 5.0);
    }
    let turned = |angle: f64| Vector3::new(angle.sin(), 0.0, -angle.cos()) * G;
    let start = world.time();
    world.set_gravity(turned(0.7)).unwrap();
    assert!(!world.is_asleep(cube));
    run_until(&mut world, start + 0.2);
    let expected = (turned(0.7).x + 0.5 * turned(0.7).z) * (world.time() - start);
    let speed = world.velocity(cube).unwrap().x;
    assert!((speed / expected - 1.0).abs() < 0.03, "{speed} {expected}");
    let ledger = world.ledger();
    assert!(ledger.error_relative().abs() < 0.02, "{ledger:?}");
    assert!(world.set_gravity(Vector3::repeat(f64::NAN)).is_err());
    assert_eq!(world.parameters().gravity, turned(0.7));
}

/// A block whose top was pulled is held at its new length, and pulled on from there.
#[test]
fn nodes_are_held_where_they_are() {
    let mesh = TetMesh::block([1, 1, 2], &Vector3::new(D, D, 2.0 * D)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e5, 0.3).unwrap().into(),
        density: DENSITY,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let end = |offset: f64| Selection::Plane {
        normal: Vector3::z(),
        offset,
        tolerance: 1e-9,
    };
    let heights: Vec<f64> = model.nodes().iter().map(|x| x.z).collect();
    let [low, high] = [f64::min, f64::max].map(|f| heights.iter().copied().fold(heights[0], f));
    let pulled = |velocity: f64| {
        let mut boundary = Boundary::default();
        let pull = linear(Vector3::z() * velocity, 0.0, 0.1);
        boundary.fix(&model, &end(low), [true; 3]).unwrap();
        boundary.drive(&model, &end(high), [true; 3], pull).unwrap();
        boundary
    };
    let mut p = parameters(1e6, 0.5, 0.3);
    p.gravity = Vector3::zeros();
    let mut world = World::new(p).unwrap();
    let added = world
        .add_model("bar", model.clone(), ContactStiffness::Law)
        .unwrap();
    let spec = DeformableSpec {
        boundary: pulled(0.1),
        ..DeformableSpec::at_rest(added, at(Vector3::zeros()))
    };
    let id = world.add_deformable(spec).unwrap();
    run_until(&mut world, 0.15);
    let top = |world: &World| {
        let nodes = world.deformable(id).unwrap().positions().to_vec();
        let of_top = nodes.iter().zip(&heights).filter(|(_, z)| **z == high);
        of_top.map(|(x, _)| x.z).fold(f64::INFINITY, f64::min)
    };
    assert!((top(&world) - high - 0.01).abs() < 1e-9);
    world.restart_clock();
    let mut again = world.clone();
    run_until(&mut again, 0.15);
    assert!((top(&again) - high - 0.02).abs() < 1e-9);
    let places = world.deformable(id).unwrap().positions().to_vec();
    let back = pulled(-0.05).placed(&places).unwrap().counted_from(0.0);
    world.set_boundary(id, back).unwrap();
    world.restart_ledger();
    assert!((top(&world) - high - 0.01).abs() < 1e-9);
    run_until(&mut world, 0.15);
    assert!((top(&world) - high - 0.005).abs() < 1e-9);
    assert!(world.ledger().error_relative().abs() < 0.02);
    assert!(pulled(0.1).placed(&places[1..3]).is_err());
}
