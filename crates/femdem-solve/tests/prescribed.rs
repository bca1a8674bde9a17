//! Nodes that are held or driven: their paths, the work on them, and their contacts.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{DENSITY, add_floor, at, parameters, run_until, solid, weightless};
use femdem_fem::element::Element;
use femdem_fem::material::{
    AnyMaterial, Deformation, Material, NeoHookean, Response, Tangent, difference_tangent,
};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, Drive, Medium, World};
use std::sync::Arc;

const SIDE: f64 = 0.1;

/// A cube of side [`SIDE`] in the octant above the origin.
fn cube(material: AnyMaterial) -> DeformableModel {
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(SIDE)).unwrap();
    let region = MaterialRegion {
        material,
        density: 1000.0,
    };
    DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap()
}

fn rubber() -> AnyMaterial {
    NeoHookean::new(1e6, 0.25).unwrap().into()
}

fn add_model(world: &mut World) -> u32 {
    let (model, stiffness) = (cube(rubber()), ContactStiffness::default());
    world.add_model("cube", model, stiffness).unwrap()
}

fn level(offset: f64) -> Selection {
    Selection::Plane {
        normal: Vector3::z(),
        offset,
        tolerance: 1e-9,
    }
}

fn steadily(velocity: Vector3) -> Drive {
    Drive::Linear {
        velocity,
        start: 0.0,
        end: 100.0,
    }
}

/// Adds a cube with its reference corner at `place`.
fn add(world: &mut World, place: Vector3, boundary: Boundary) {
    let model = add_model(world);
    let spec = DeformableSpec {
        boundary,
        ..DeformableSpec::at_rest(model, at(place))
    };
    world.add_deformable(spec).unwrap();
}

/// A cube whose nodes are all driven rubs along the floor, pressed 1 mm into it: the drive supplies what
/// friction and damping dissipate.
#[test]
fn driven_nodes_that_rub_close_the_books() {
    let mut p = parameters(1e6, 0.5, 0.6);
    p.time_step.safety = 0.2;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let mut boundary = Boundary::default();
    let model = cube(rubber());
    let [push, pull] = [1e-2, -1e-2].map(|z| Vector3::new(0.5, 0.0, z));
    let press = |velocity, start: f64, end: f64| Drive::Linear {
        velocity,
        start,
        end,
    };
    boundary
        .drive(&model, &Selection::All, [true; 3], press(-pull, 0.0, 0.0))
        .unwrap();
    for (components, drive) in [
        ([true, true, false], steadily(push)),
        ([false, false, true], press(pull, 0.0, 0.1)),
    ] {
        boundary
            .drive(&model, &Selection::All, components, drive)
            .unwrap();
    }
    add(&mut world, Vector3::zeros(), boundary);
    run_until(&mut world, 0.2);
    let ledger = world.ledger();
    assert!(ledger.dissipated_friction > 0.1, "{ledger:?}");
    let missed = ledger.error().abs();
    assert!(missed < 2e-3 * ledger.dissipated_friction, "{ledger:?}");
    // mu N times the sliding distance.
    let normal: f64 = world.wall_load(0).unwrap().normal_sum;
    let rubbed = 0.5 * normal * 0.5 * 0.15;
    assert!(
        (ledger.dissipated_friction / rubbed - 1.0).abs() < 0.1,
        "{rubbed} {ledger:?}"
    );
}

/// Driven nodes follow their path in any medium, which takes no energy from them.
#[test]
fn the_medium_does_not_resist_a_drive() {
    let mut p = weightless(1e6, 0.5, 0.6);
    p.medium = Medium {
        drag: 20.0,
        local_damping: 0.5,
    };
    let mut world = World::new(p).unwrap();
    let mut boundary = Boundary::default();
    boundary
        .drive(
            &cube(rubber()),
            &Selection::All,
            [true; 3],
            steadily(Vector3::x()),
        )
        .unwrap();
    add(&mut world, Vector3::zeros(), boundary);
    run_until(&mut world, 0.1);
    let ledger = world.ledger();
    let kinetic = 0.5 * 1000.0 * SIDE.powi(3);
    assert!((ledger.kinetic / kinetic - 1.0).abs() < 1e-9);
    assert_eq!(ledger.dissipated_medium, 0.0);
    assert!(ledger.error().abs() < 1e-9 * kinetic, "{ledger:?}");
}

/// A cube that falls along a rail, held across it, in a medium with drag.
#[test]
fn components_that_are_free_feel_the_medium() {
    let mut p = parameters(1e6, 0.5, 0.6);
    p.medium.drag = 5.0;
    let mut world = World::new(p).unwrap();
    let mut boundary = Boundary::default();
    boundary
        .fix(&cube(rubber()), &Selection::All, [true, true, false])
        .unwrap();
    add(&mut world, Vector3::zeros(), boundary);
    run_until(&mut world, 0.3);
    let expected = -crate::common::G / 5.0 * (1.0 - (-5.0 * world.time()).exp());
    let speed = world.deformable(0).unwrap().velocities()[0].z;
    assert!((speed / expected - 1.0).abs() < 1e-3, "{speed} {expected}");
    let ledger = world.ledger();
    assert!(
        ledger.error().abs() < 1e-3 * ledger.dissipated_medium,
        "{ledger:?}"
    );
}

/// A wall that turns about a far point lifts the only deformable body.
#[test]
fn a_turning_wall_meets_what_deforms() {
    let mut world = World::new(weightless(1e6, 0.0, 0.0)).unwrap();
    let drive = Drive::Turn {
        axis: -Vector3::y(),
        point: Vector3::zeros(),
        rate: 1.0,
        start: 0.0,
        end: 10.0,
    };
    add_floor(&mut world, drive);
    add(&mut world, Vector3::new(1.0, 0.0, 0.2), Boundary::default());
    run_until(&mut world, 0.4);
    let up = world.wall_pose(0).unwrap().rotation * Vector3::z();
    let body = world.deformable(0).unwrap();
    let heights = body.positions().iter().map(|x| up.dot(x));
    let lowest = heights.fold(f64::INFINITY, f64::min);
    assert!(lowest > -0.05 * SIDE, "{lowest}");
    assert!(body.momentum().z > 0.5 * 1000.0 * SIDE.powi(3));
}

/// A model without a body changes nothing.
#[test]
fn a_model_alone() {
    let mut places = Vec::new();
    for with_model in [false, true] {
        let mut world = World::new(parameters(1e6, 0.5, 0.6)).unwrap();
        add_floor(&mut world, Drive::Fixed);
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let place = at(Vector3::z() * 0.03);
        world
            .add_body(BodySpec::at_rest(shape, DENSITY, place))
            .unwrap();
        world.step().unwrap();
        if with_model {
            add_model(&mut world);
        }
        assert!(!world.is_slowing() && world.wall_load(0).is_some());
        run_until(&mut world, 0.05);
        places.push(world.position(0).unwrap());
    }
    assert_eq!(places[0], places[1]);
}

/// A rigid body that is decelerated by a deformable one is slowing.
#[test]
fn a_body_braked_by_a_deformable_one_is_slowing() {
    let mut world = World::new(weightless(1e6, 0.0, 0.0)).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let mut boundary = Boundary::default();
    boundary
        .fix(&cube(rubber()), &level(0.0), [true; 3])
        .unwrap();
    let corner = Vector3::new(-0.5 * SIDE, -0.5 * SIDE, -SIDE);
    add(&mut world, corner, boundary);
    let mut spec = BodySpec::at_rest(
        shape,
        DENSITY,
        at(Vector3::z() * (crate::common::half_edge() + 1e-3)),
    );
    spec.velocity.z = -0.5;
    let body = world.add_body(spec).unwrap();
    world.step().unwrap();
    assert!(!world.is_slowing());
    while world.velocity(body).unwrap().z < -0.3 {
        world.step().unwrap();
        assert!(world.time() < 0.1);
    }
    assert!(world.is_slowing());
}

/// Motions count from the position and the time at which a body is added. Those of a boundary that replaces
/// another count from the places where that one would be, or from now.
#[test]
fn motions_count_from_where_a_body_is_added() {
    let mut world = World::new(weightless(1e6, 0.5, 0.6)).unwrap();
    run_until(&mut world, 0.1);
    let velocity = Vector3::new(0.3, 0.0, -0.1);
    let model = cube(rubber());
    let mut boundary = Boundary::default();
    boundary
        .drive(&model, &Selection::All, [true; 3], steadily(velocity))
        .unwrap();
    let (place, start) = (Vector3::new(1.0, 2.0, 3.0), world.time());
    add(&mut world, place, boundary);
    let off = |world: &World, since: f64| {
        let body = world.deformable(0).unwrap();
        let nodes = body.positions().iter().zip(model.nodes());
        let way = velocity * (world.time() - since);
        nodes.fold(0.0_f64, |most, (x, rest)| {
            most.max((x - rest - place - way).norm())
        })
    };
    assert!(off(&world, start) < 1e-15);
    run_until(&mut world, 0.15);
    assert!(off(&world, start) < 1e-12);
    // The same boundary again continues as before.
    let same = world.deformable(0).unwrap().boundary().clone();
    world.set_boundary(0, same).unwrap();
    run_until(&mut world, 0.2);
    assert!(off(&world, start) < 1e-12);
    // One given for the present places, counted from now, continues from there.
    let here = world.deformable(0).unwrap().positions().to_vec();
    let mut anew = Boundary::default();
    anew.drive_from(
        &model,
        &Selection::All,
        [true; 3],
        steadily(velocity),
        &here,
    )
    .unwrap();
    let anew = anew.counted_from(world.time());
    world.set_boundary(0, anew).unwrap();
    run_until(&mut world, 0.25);
    assert!(off(&world, start) < 1e-12);
    assert!(world.ledger().error().abs() < 1e-12);
}

/// A law that is defined only in this file.
#[derive(Debug)]
struct Foreign(NeoHookean);

impl Material for Foreign {
    fn name(&self) -> &str {
        "foreign"
    }

    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        self.0.respond(d, old, new)
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        difference_tangent(self, d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.0.wave_modulus()
    }

    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        self.0.stiffness_bound(d, old)
    }
}

/// A world with a custom law continues from its bytes as before, in contact too.
#[test]
fn a_custom_law_goes_on_from_bytes() {
    let law = || Arc::new(Foreign(NeoHookean::new(1e6, 0.25).unwrap()));
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(SIDE)).unwrap();
    let regions = [AnyMaterial::custom(law()), rubber()].map(|material| MaterialRegion {
        material,
        density: 1000.0,
    });
    let region_of = (0..mesh.tets().len()).map(|i| i as u32 % 2).collect();
    let model = DeformableModel::new(&mesh, Element::T4, regions.to_vec(), Some(region_of));
    let mut world = World::new(parameters(1e6, 0.5, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let model = world
        .add_model("cube", model.unwrap(), ContactStiffness::default())
        .unwrap();
    let spec = DeformableSpec {
        velocity: -Vector3::z(),
        ..DeformableSpec::at_rest(model, Pose::translation(0.0, 0.0, 2e-3))
    };
    world.add_deformable(spec).unwrap();
    run_until(&mut world, 2e-3);
    let mut read = World::from_bytes(&world.to_bytes().unwrap()).unwrap();
    read.bind_materials(&[law()]).unwrap();
    for world in [&mut world, &mut read] {
        run_until(world, 8e-3);
        assert!(world.deformable_contacts().count() == 1);
    }
    assert_eq!(world.time_step(), read.time_step());
    assert_eq!(world.state_hash().unwrap(), read.state_hash().unwrap());
}

/// Steps resolve a wall that oscillates fast under a large body, whose contacts would allow longer ones.
#[test]
fn fast_swings_are_resolved() {
    let tapped = |largest: Option<f64>| {
        let frequency: f64 = 50.0;
        let mut p = parameters(1e6, 0.6, 0.6);
        p.time_step.largest = largest;
        let mut world = World::new(p).unwrap();
        let stroke = 6.0 * 9.81 / (2.0 * std::f64::consts::PI * frequency).powi(2);
        let tap = Drive::Tap {
            stroke: Vector3::z() * stroke,
            frequency,
            start: 0.503,
            interval: 0.2,
            taps: 3,
        };
        let floor = add_floor(&mut world, tap);
        let large = CatalogueShape::from(Solid::P5)
            .polyhedron(3_f64.sqrt())
            .unwrap();
        let shape = world.add_shape("P5", &large).unwrap();
        let rest = at(Vector3::z() * 0.497);
        world
            .add_body(BodySpec::at_rest(shape, DENSITY, rest))
            .unwrap();
        let mut highest = 0.0_f64;
        while world.time() < 1.5 {
            world.step().unwrap();
            highest = highest.max(world.wall_pose(floor).unwrap().translation.vector.z);
        }
        (highest / stroke, world.ledger())
    };
    let (chosen, short) = (tapped(None), tapped(Some(1e-4)));
    assert!(chosen.0 > 0.97, "{}", chosen.0);
    let (work, exact) = (chosen.1.work_in, short.1.work_in);
    assert!((work / exact - 1.0).abs() < 0.15, "{work} {exact}");
}
