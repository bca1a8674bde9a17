//! Bodies that touch in several places: each is a contact of its own.

use super::{block, smooth};
use femdem_contact::{Wall, restitution};
use femdem_fem::element::Element;
use femdem_fem::material::NeoHookean;
use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
use femdem_mesh::{Point3, Pose, Rotation, TetMesh, Vector3};
use femdem_solve::{BodySpec, ContactStiffness, DeformableSpec, Drive, World};

/// A block of 0.4 x 0.08 x 0.16 m with a slot of 0.16 m from above: two jaws on a base.
fn clamp(young: f64) -> DeformableModel {
    let sides = Vector3::new(0.4, 0.08, 0.16);
    let mesh = TetMesh::block([10, 2, 4], &sides).unwrap();
    let points: Vec<Point3> = mesh.points().iter().map(|p| p - 0.5 * sides).collect();
    let stays = |tet: &&[u32; 4]| {
        let centre: Vector3 = tet.iter().map(|i| points[*i as usize].coords * 0.25).sum();
        centre.x.abs() > 0.08 || centre.z < -0.04
    };
    let kept: Vec<[u32; 4]> = mesh.tets().iter().filter(stays).copied().collect();
    let mut used: Vec<u32> = kept.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let number = |node: u32| used.binary_search(&node).unwrap() as u32;
    let tets = kept.iter().map(|tet| tet.map(number)).collect();
    let points = used.iter().map(|i| points[*i as usize]).collect();
    let mesh = TetMesh::new(points, tets).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(young, 0.25).unwrap().into(),
        density: 1000.0,
    };
    DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap()
}

/// A block, rigid or not, that is pressed between the jaws and swings from one to the other.
fn held_block(deforms: bool, zeta: f64) -> World {
    let mut p = smooth(0.5);
    p.contact.damping_ratio = zeta;
    let mut world = World::new(p).unwrap();
    let model = clamp(1e8);
    let mut boundary = Boundary::default();
    let ends = [0.2, -0.2].map(|offset| Selection::Plane {
        normal: Vector3::x(),
        offset,
        tolerance: 1e-6,
    });
    let base = Selection::Box {
        lower: Vector3::repeat(-1.0),
        upper: Vector3::new(1.0, 1.0, -0.039),
    };
    for fixed in ends.iter().chain([&base]) {
        boundary.fix(&model, fixed, [true; 3]).unwrap();
    }
    let soft = ContactStiffness::Penalty(1e6);
    let model = world.add_model("clamp", model, soft).unwrap();
    let pose = Pose::identity();
    world
        .add_deformable(DeformableSpec {
            boundary,
            ..DeformableSpec::at_rest(model, pose)
        })
        .unwrap();
    let sides = [0.162, 0.06, 0.06];
    let pose = Pose::translation(0.0, 0.0, 0.03);
    let velocity = Vector3::x() * 0.02;
    if deforms {
        let model = block([6, 2, 2], sides, Element::T4, 1e8);
        let model = world.add_model("block", model, soft).unwrap();
        world
            .add_deformable(DeformableSpec {
                velocity,
                ..DeformableSpec::at_rest(model, pose)
            })
            .unwrap();
    } else {
        let sides = Vector3::from(sides);
        let mesh = TetMesh::block([1, 1, 1], &sides).unwrap();
        let shape = world.add_shape("block", &mesh.surface().unwrap()).unwrap();
        let pose = pose * Pose::from_parts((-0.5 * sides).into(), pose.rotation);
        world
            .add_body(BodySpec {
                velocity,
                ..BodySpec::at_rest(shape, 1000.0, pose)
            })
            .unwrap();
    }
    world
}

/// A body between the jaws of another has a contact with each, with its own force and dashpot: their forces cancel, but
/// not what they dissipate.
#[test]
fn a_block_in_a_clamp_has_two_contacts() {
    for deforms in [false, true] {
        let swing = |zeta: f64| {
            let mut world = held_block(deforms, zeta);
            world.step().unwrap();
            let contacts: Vec<_> = world.deformable_contacts().copied().collect();
            assert_eq!(contacts.len(), 2, "{contacts:?}");
            assert_eq!([0, 1].map(|k| contacts[k].patch), [0, 1]);
            let [a, b] = [0, 1].map(|k| (contacts[k].normal, contacts[k].normal_force));
            assert!(
                (a.0 + b.0).norm() < 0.02 && a.0.x.abs() > 0.99,
                "{contacts:?}"
            );
            assert!((a.1 / b.1 - 1.0).abs() < 0.2 && a.1 > 50.0, "{contacts:?}");
            let sides = (contacts[0].point.x, contacts[1].point.x);
            assert!((sides.0 + sides.1).abs() < 0.01 && sides.0.abs() > 0.07);
            let place = |world: &World| world.position(1).unwrap().x;
            let mut most = 0.0_f64;
            while world.time() < 0.04 {
                world.step().unwrap();
                if world.time() > 0.035 {
                    most = most.max(place(&world).abs());
                }
            }
            assert!(world.ledger().error_relative().abs() < 1e-3);
            most
        };
        let (free, damped) = (swing(0.0), swing(0.6));
        assert!(free > 2e-5, "{deforms}: {free}");
        assert!(damped < 0.05 * free, "{deforms}: {damped} of {free}");
    }
}

/// A block much stiffer than its contact comes back with the restitution of its damping ratio, from a wall, a rigid body and
/// its like, whatever its mesh.
#[test]
fn stiff_blocks_have_the_restitution_of_their_damping_ratio() {
    let speed = 0.1;
    for (zeta, cells) in [(0.3, 1), (0.3, 4), (0.6, 2)] {
        for partner in 0..3 {
            let mut p = smooth(0.5);
            p.contact.damping_ratio = zeta;
            let mut world = World::new(p).unwrap();
            let model = block([cells; 3], [0.1; 3], Element::T4, 1e9);
            let law = ContactStiffness::Law;
            let model = world.add_model("block", model, law).unwrap();
            let from = |z: f64| DeformableSpec {
                velocity: Vector3::z() * (-speed * z.signum()),
                ..DeformableSpec::at_rest(model, Pose::translation(0.0, 0.0, z))
            };
            world.add_deformable(from(0.0501)).unwrap();
            match partner {
                0 => {
                    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
                    world.add_wall(floor, Drive::Fixed).unwrap();
                }
                1 => {
                    let sides = Vector3::repeat(0.1);
                    let mesh = TetMesh::block([1; 3], &sides).unwrap();
                    let surface = mesh.surface().unwrap();
                    let shape = world.add_shape("block", &surface).unwrap();
                    let spec = BodySpec {
                        velocity: Vector3::z() * speed,
                        ..BodySpec::at_rest(shape, 1000.0, Pose::translation(-0.05, -0.05, -0.1001))
                    };
                    world.add_body(spec).unwrap();
                }
                _ => {
                    world.add_deformable(from(-0.0501)).unwrap();
                }
            }
            let touches = |world: &World| world.deformable_contacts().next().is_some();
            while !touches(&world) {
                world.step().unwrap();
            }
            while touches(&world) {
                world.step().unwrap();
            }
            let body = world.deformable(0).unwrap();
            let back = body.momentum().z / 1.0 / speed;
            let expected = restitution(zeta);
            assert!(
                (back / expected - 1.0).abs() < 0.02,
                "{zeta} {cells} {partner}: {back} {expected}"
            );
        }
    }
}

/// A stiff body that falls on two feet at once rebounds as one on a single foot does.
#[test]
fn two_feet_rebound_as_one_does() {
    for zeta in [0.3, 0.6] {
        let mut p = smooth(0.5);
        p.contact.damping_ratio = zeta;
        let mut world = World::new(p).unwrap();
        let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
        world.add_wall(floor, Drive::Fixed).unwrap();
        let model = clamp(1e10);
        let law = ContactStiffness::Law;
        let model = world.add_model("bridge", model, law).unwrap();
        let over = Rotation::from_axis_angle(&Vector3::y_axis(), std::f64::consts::PI);
        let pose = Pose::from_parts((Vector3::z() * 0.08001).into(), over);
        world
            .add_deformable(DeformableSpec {
                velocity: -Vector3::z() * 0.1,
                ..DeformableSpec::at_rest(model, pose)
            })
            .unwrap();
        let patches = |world: &World| world.deformable_contacts().count();
        while patches(&world) == 0 {
            world.step().unwrap();
        }
        assert_eq!(patches(&world), 2);
        while patches(&world) > 0 {
            world.step().unwrap();
        }
        let body = world.deformable(0).unwrap();
        let mass: f64 = body.model().masses().iter().sum();
        let back = body.momentum().z / mass / 0.1;
        let expected = restitution(zeta);
        assert!(
            (back / expected - 1.0).abs() < 0.02,
            "{zeta}: {back} {expected}"
        );
    }
}
