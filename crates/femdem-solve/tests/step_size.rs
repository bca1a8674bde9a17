//! Step sizes that are not determined by contacts alone: of finely faceted bodies, of fast ones, and without
//! free bodies.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{
    D, DENSITY, G, add_floor, at, half_edge, parameters, run_until, solid, weightless,
};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::TetMesh;
use femdem_mesh::nalgebra::Vector3;
use femdem_mesh::shapes::{Shape, Sphere};
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, Drive, World};

/// A sphere of 20 * 4^level facets, its centre at the given height over a floor.
fn ball(level: u32, height: f64) -> World {
    let surface = Shape::from(Sphere { level }).polyhedron(D).unwrap();
    let mut p = parameters(1e6, 0.6, 0.0);
    p.time_step.safety = 0.2;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("sphere", &surface).unwrap();
    let place = at(Vector3::z() * height);
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, place))
        .unwrap();
    world
}

/// The step before any contact does not depend on the size of facets, and the ledger of a fall and a bounce
/// closes.
#[test]
fn a_finely_faceted_body_steps_as_a_coarse_one() {
    let mut first = Vec::new();
    for level in 1..=4 {
        let mut world = ball(level, 0.5 * D + 0.1);
        world.step().unwrap();
        first.push(world.time_step());
        run_until(&mut world, 0.25);
        let ledger = world.ledger();
        let turned_over = DENSITY * D.powi(3) * std::f64::consts::FRAC_PI_6 * G * 0.1;
        let missed = ledger.error().abs() / turned_over;
        assert!(missed < 0.015, "level {level}: {missed}");
    }
    let (least, most) = first
        .iter()
        .skip(1)
        .fold((f64::INFINITY, 0.0_f64), |(l, m), dt| {
            (l.min(*dt), m.max(*dt))
        });
    assert!(most < 1.3 * least, "{first:?}");
}

/// A body that falls for long lands: its speed shortens the step before it crosses a fraction of its own
/// size.
#[test]
fn a_long_fall_ends_on_the_floor() {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let place = at(Vector3::z() * (half_edge() + 3.0));
    world
        .add_body(BodySpec::at_rest(shape, DENSITY, place))
        .unwrap();
    let slow = {
        world.step().unwrap();
        world.time_step()
    };
    run_until(&mut world, 0.7);
    let speed = world.velocity(0).unwrap().norm();
    assert!(world.time_step() < 0.9 * slow);
    // A tenth of its radius, with a margin for the step that has just ended.
    assert!(speed * world.time_step() <= 0.101 * 0.5 * D);
    run_until(&mut world, 3.0);
    let height = world.position(0).unwrap().z;
    assert!((height / half_edge() - 1.0).abs() < 0.02, "{height}");
}

/// A world without free bodies advances in time.
#[test]
fn driven_bodies_alone() {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    for _ in 0..3 {
        world.step().unwrap();
    }
    assert!(world.time() > 0.0 && world.time().is_finite());
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let drive = Drive::Linear {
        velocity: Vector3::z(),
        start: 0.0,
        end: 10.0,
    };
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::zeros()));
    world.add_driven_body(spec, drive).unwrap();
    let start = world.time();
    for _ in 0..20 {
        world.step().unwrap();
    }
    let way = world.position(0).unwrap().z;
    assert!(
        way > 0.0 && (way / (world.time() - start) - 1.0).abs() < 1e-9,
        "{way}"
    );
}

/// A body launched with a fast spin takes steps that its spin allows.
#[test]
fn a_spinning_launch() {
    let mut world = World::new(parameters(1e6, 0.6, 0.6)).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = BodySpec {
        angular_velocity: Vector3::z() * 500.0,
        ..BodySpec::at_rest(shape, DENSITY, at(Vector3::z()))
    };
    world.add_body(spec).unwrap();
    run_until(&mut world, 0.05);
    let spin = world.angular_velocity(0).unwrap();
    assert!((spin - Vector3::z() * 500.0).norm() < 1e-9, "{spin}");
    // A tenth of the radius, at one and a half times the speed of the farthest point.
    assert!(world.time_step() <= 0.1 / (1.5 * 500.0));
}

/// A body that was launched fast and has been slowed down no longer shortens the step.
#[test]
fn a_launch_is_forgotten() {
    let mut p = weightless(1e6, 0.6, 0.6);
    p.medium.drag = 50.0;
    let mut world = World::new(p).unwrap();
    let shape = world.add_shape("P5", &solid("P5")).unwrap();
    let spec = BodySpec::at_rest(shape, DENSITY, at(Vector3::z()));
    let slow = {
        let mut still = World::new(p).unwrap();
        let shape = still.add_shape("P5", &solid("P5")).unwrap();
        still.add_body(BodySpec { shape, ..spec }).unwrap();
        still.step().unwrap();
        still.time_step()
    };
    let velocity = Vector3::x() * 2000.0;
    world.add_body(BodySpec { velocity, ..spec }).unwrap();
    world.step().unwrap();
    // A tenth of its radius, although that is far below the stability bound.
    assert!(world.time_step() <= 0.1 * 0.5 * D / 2000.0);
    run_until(&mut world, 0.5);
    assert!(world.velocity(0).unwrap().norm() < 1e-3);
    assert!((world.time_step() / slow - 1.0).abs() < 1e-12);
}

/// A body at rest that is approached by a fast wall, or a driven body, is pushed and not passed through.
#[test]
fn what_is_driven_fast_is_not_let_through() {
    let drive = Drive::Linear {
        velocity: Vector3::z() * 40.0,
        start: 0.0,
        end: 10.0,
    };
    for by_wall in [true, false] {
        let mut world = World::new(weightless(1e7, 0.6, 0.6)).unwrap();
        let shape = world.add_shape("P5", &solid("P5")).unwrap();
        let far = at(Vector3::z() * -1.0);
        if by_wall {
            add_floor(&mut world, drive);
        } else {
            let paddle = BodySpec::at_rest(shape, DENSITY, far);
            world.add_driven_body(paddle, drive).unwrap();
        }
        let body = world
            .add_body(BodySpec::at_rest(
                shape,
                DENSITY,
                at(Vector3::z() * (half_edge() + 1e-3)),
            ))
            .unwrap();
        let mut pushed = false;
        while world.time() < 0.1 {
            world.step().unwrap();
            assert!(world.time_step() * 40.0 <= 0.1 * 0.5 * D);
            pushed |= world.velocity(body).unwrap().z > 39.0;
        }
        assert!(pushed, "{by_wall}");
    }
}

/// A thin driven plate, whose field is steep, does not eject bodies that it meets.
#[test]
fn the_first_contact_with_a_thin_plate() {
    let mut p = weightless(1e7, 0.0, 0.0);
    p.time_step.safety = 0.25;
    let mut world = World::new(p).unwrap();
    let cube = world.add_shape("P5", &solid("P5")).unwrap();
    let body = world
        .add_body(BodySpec {
            velocity: -Vector3::z(),
            ..BodySpec::at_rest(cube, DENSITY, at(Vector3::z() * (half_edge() + 2e-3)))
        })
        .unwrap();
    world.step().unwrap();
    let thick = world.time_step();
    let plate = TetMesh::block([1, 1, 1], &Vector3::new(0.2, 0.2, 1e-3)).unwrap();
    let plate = world.add_shape("plate", &plate.surface().unwrap()).unwrap();
    let place = at(Vector3::new(-0.1, -0.1, -1e-3));
    let spec = BodySpec::at_rest(plate, DENSITY, place);
    world.add_driven_body(spec, Drive::Fixed).unwrap();
    world.step().unwrap();
    assert!(world.time_step() < 0.4 * thick);
    run_until(&mut world, 0.02);
    let speed = world.velocity(body).unwrap().z;
    assert!((speed - 1.0).abs() < 0.02, "{speed}");
}

/// A soft body, whose elements allow long steps, is thrown fast at the floor and rebounds from it.
#[test]
fn fast_nodes_do_not_go_through_the_floor() {
    let mut p = weightless(1e6, 0.0, 0.0);
    p.time_step.safety = 0.5;
    let mut world = World::new(p).unwrap();
    add_floor(&mut world, Drive::Fixed);
    let mesh = TetMesh::block([1, 1, 1], &Vector3::new(1.0, 1.0, 0.02)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e5, 0.0).unwrap().into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let inradius = 0.01;
    let model = world
        .add_model("sheet", model, ContactStiffness::Penalty(1e6))
        .unwrap();
    let spec = DeformableSpec {
        velocity: -Vector3::z() * 8.0,
        ..DeformableSpec::at_rest(model, at(Vector3::z() * 0.03))
    };
    world.add_deformable(spec).unwrap();
    world.step().unwrap();
    assert!(world.time_step() * 8.0 <= 0.1 * inradius * 1.001);
    run_until(&mut world, 0.05);
    let body = world.deformable(0).unwrap();
    assert!(body.momentum().z > 0.0 && body.centroid().z > 0.0);
}

/// A step that would leave no finite time is refused, and says what to give.
#[test]
fn time_stays_finite() {
    let mut p = weightless(1e6, 0.6, 0.6);
    p.time_step.largest = Some(1e308);
    let mut world = World::new(p).unwrap();
    let refused = (0..4).find_map(|_| world.step().err()).unwrap();
    assert!(
        refused.to_string().contains("time_step.largest"),
        "{refused}"
    );
    assert!(world.time().is_finite());
}
