//! Deformable bodies in a world: energy, momentum, mixtures with rigid bodies, friction, checkpoints.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::Wall;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::deformable::{DeformableModel, MaterialRegion};
use femdem_solve::element::Element;
use femdem_solve::material::NeoHookean;
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, Drive, World, WorldParameters};

/// A block of `cells` with the given sides, centred at the origin of its own coordinates.
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

/// Two blocks that collide obliquely beside a rigid one keep momentum and angular momentum.
#[test]
fn collisions_keep_momentum() {
    let mut p = smooth(0.5);
    p.contact.friction = 0.5;
    p.contact.damping_ratio = 0.3;
    let mut world = World::new(p).unwrap();
    let model = block([2, 2, 2], [0.1; 3], Element::T4, 1e6);
    let model = world
        .add_model("cube", model, ContactStiffness::default())
        .unwrap();
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
