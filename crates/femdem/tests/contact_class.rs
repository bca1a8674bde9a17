//! The class of contacts against cases whose answer is plain: bodies held at a given depth.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::contact::kernel::{CavityKernel, Scratch};
use femdem::contact::{ConvexShape, Frame, Overlap, PairKernel, Wall};
use femdem::mesh::catalogue::CatalogueShape;
use femdem::mesh::nalgebra::UnitQuaternion;
use femdem::mesh::{Polyhedron, Vector3};
use femdem::{ContactClass, Patch};

fn solid(name: &str) -> (Polyhedron, ConvexShape) {
    let polyhedron = name
        .parse::<CatalogueShape>()
        .unwrap()
        .polyhedron(1.0)
        .unwrap();
    let shape = ConvexShape::new(&polyhedron).unwrap();
    (polyhedron, shape)
}

/// A turn that takes `direction` of the body to -z, followed by one about x by `tilt`.
fn downward(direction: &Vector3, tilt: f64) -> UnitQuaternion<f64> {
    let about_x = |angle| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    let down = UnitQuaternion::rotation_between(direction, &-Vector3::z())
        .unwrap_or_else(|| about_x(std::f64::consts::PI));
    about_x(tilt) * down
}

fn class(overlap: &Overlap) -> ContactClass {
    ContactClass::of_patch(&Patch {
        area: overlap.area,
        volume: overlap.volume,
        energy: overlap.energy,
        force: overlap.force_magnitude(),
        stiffness: overlap.foundation.stiffness,
        diameter: 1.0,
    })
}

/// Classes on a wall and on a face of a solid of the same kind, at a depth over d.
fn classes(name: &str, direction: &Vector3, tilt: f64, depth: f64) -> [ContactClass; 2] {
    let (polyhedron, shape) = solid(name);
    let turn = downward(direction, tilt);
    let lowest = polyhedron
        .vertices()
        .iter()
        .map(|v| (turn * v).z)
        .fold(f64::INFINITY, f64::min);
    let frame = |z: f64, turn: &UnitQuaternion<f64>| Frame {
        position: Vector3::new(0.0, 0.0, z),
        rotation: turn.to_rotation_matrix().into_inner(),
    };
    let body = frame(-lowest - depth, &turn);
    let mut scratch = Scratch::default();
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    let on_wall = CavityKernel::new(1e6).unwrap().evaluate(
        &floor,
        &Frame::identity(),
        &shape,
        &body,
        &mut scratch,
    );
    // The solid below lies with its first face up at z = 0.
    let upward = downward(&-polyhedron.face_normal(0), 0.0);
    let below = frame(-polyhedron.face_offset(0), &upward);
    let on_face =
        PairKernel::new(1e6)
            .unwrap()
            .evaluate(&shape, &below, &shape, &body, &mut scratch);
    [class(&on_wall.unwrap()), class(&on_face.unwrap())]
}

const SOLIDS: [&str; 4] = ["P5", "P3", "A10", "A13"];
const DEPTHS: [f64; 2] = [0.001, 0.008];

#[test]
fn faces_level_or_up_to_two_degrees_off() {
    for name in SOLIDS {
        let normal = solid(name).0.face_normal(0);
        for depth in DEPTHS {
            for tilt in [0.0, 0.003, 0.02] {
                let found = classes(name, &normal, tilt, depth);
                assert_eq!(found, [ContactClass::FaceFace; 2], "{name} {depth} {tilt}");
            }
        }
    }
}

#[test]
fn level_edges() {
    for name in SOLIDS {
        let body = solid(name).0;
        let [a, b] = body.edges()[0];
        let middle = body.vertices()[a as usize].coords + body.vertices()[b as usize].coords;
        for depth in DEPTHS {
            let found = classes(name, &middle.normalize(), 0.0, depth);
            assert_eq!(found, [ContactClass::EdgeFace; 2], "{name} {depth}");
        }
    }
}

#[test]
fn vertices() {
    for name in SOLIDS {
        let vertex = solid(name).0.vertices()[0].coords.normalize();
        for depth in DEPTHS {
            for tilt in [0.0, 0.03] {
                let found = classes(name, &vertex, tilt, depth);
                assert_eq!(found, [ContactClass::Point; 2], "{name} {depth} {tilt}");
            }
        }
    }
}
