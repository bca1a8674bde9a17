//! Worlds for the tests of this crate.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "every test file uses its own part, and helpers of tests fail the test"
)]

pub mod ranks;

use femdem_contact::{BodyId, ContactParameters, Field, Wall};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Translation3, Vector3};
use femdem_mesh::{Polyhedron, Pose, Rotation, TetMesh};
use femdem_solve::{BodySpec, Drive, World, WorldParameters};

pub const DENSITY: f64 = 2560.0;
pub const G: f64 = 9.81;
/// Circumscribed diameter of the test bodies, m.
pub const D: f64 = 0.1;

pub fn solid(id: &str) -> Polyhedron {
    id.parse::<CatalogueShape>().unwrap().polyhedron(D).unwrap()
}

/// Distance of a cube's centroid from its faces, m.
pub fn half_edge() -> f64 {
    0.5 * D / 3.0_f64.sqrt()
}

/// Parameters without sleep.
pub fn parameters(penalty: f64, friction: f64, damping_ratio: f64) -> WorldParameters {
    let mut p = WorldParameters {
        contact: ContactParameters {
            penalty,
            friction,
            damping_ratio,
            ..ContactParameters::default()
        },
        ..WorldParameters::default()
    };
    p.sleeping.enabled = false;
    p
}

/// As [`parameters`], without gravity.
pub fn weightless(penalty: f64, friction: f64, damping_ratio: f64) -> WorldParameters {
    WorldParameters {
        gravity: Vector3::zeros(),
        ..parameters(penalty, friction, damping_ratio)
    }
}

pub fn at(position: Vector3<f64>) -> Pose {
    Pose::from_parts(Translation3::from(position), Rotation::identity())
}

pub fn pose(position: Vector3<f64>, rotation: Rotation) -> Pose {
    Pose::from_parts(Translation3::from(position), rotation)
}

/// Adds a meshed shape with the body field; its surface is the mesh's skin.
pub fn add_mesh(world: &mut World, name: &str, mesh: &TetMesh) -> u32 {
    let surface = mesh.surface().unwrap();
    world
        .add_mesh_shape(name, &surface, mesh, Field::Body)
        .unwrap()
}

/// A number in [-1, 1] from an index: variety, not quality.
pub fn noise(i: u64) -> f64 {
    let x = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((x >> 11) as f64 / (1u64 << 52) as f64) - 1.0
}

/// A rotation from an index, without trigonometric functions.
pub fn turned(i: u64) -> Rotation {
    let q = femdem_mesh::nalgebra::Quaternion::new(
        noise(4 * i) + 0.1,
        noise(4 * i + 1),
        noise(4 * i + 2),
        noise(4 * i + 3),
    );
    Rotation::new_normalize(q)
}

pub fn run_until(world: &mut World, time: f64) {
    while world.time() < time {
        world.step().unwrap();
    }
}

/// A floor through the origin.
pub fn add_floor(world: &mut World, drive: Drive) -> u32 {
    let floor = Wall::half_space("floor", Vector3::z(), 0.0).unwrap();
    world.add_wall(floor, drive).unwrap()
}

/// Four upright walls about a square of `side`, from the origin.
pub fn add_sides(world: &mut World, side: f64, drive: Drive) {
    let walls = Wall::closed_box(Vector3::zeros(), Vector3::repeat(side)).unwrap();
    for wall in walls.into_iter().take(4) {
        world.add_wall(wall, drive).unwrap();
    }
}

/// A loose heap of `count` bodies of five shapes above the floor, `wide` to a row.
pub fn add_heap(world: &mut World, count: u64, wide: u64) -> Vec<BodyId> {
    let shapes: Vec<u32> = ["P1", "P5", "A1", "P3", "A10"]
        .iter()
        .map(|s| world.add_shape(s, &solid(s)).unwrap())
        .collect();
    (0..count)
        .map(|i| {
            let cell = [i % wide, i / wide % wide, i / (wide * wide)];
            let position = Vector3::from(cell.map(|c| (1.05 * c as f64 + 0.55) * D));
            let pose = Pose::from_parts(Translation3::from(position), turned(i));
            let spec = BodySpec::at_rest(shapes[i as usize % 5], DENSITY, pose);
            world.add_body(spec).unwrap()
        })
        .collect()
}
