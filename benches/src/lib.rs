//! Packs for the benchmarks: bodies dropped from a lattice into a box until they lie still
//! enough to have the contacts of a pack.

use femdem::contact::{ConvexShape, Frame, Wall};
use femdem::mesh::catalogue::CatalogueShape;
use femdem::mesh::nalgebra::Vector3;
use femdem::mesh::{Polyhedron, Pose};
use femdem::solve::{BodySpec, Drive, World, WorldParameters};
use std::error::Error;

/// Circumscribed diameter of all bodies, m.
pub const DIAMETER: f64 = 0.05;

/// Density of all bodies, kg/m^3.
const DENSITY: f64 = 2560.0;

/// Bodies of one layer of the lattice, along either side.
const ROW: u32 = 5;

/// What can go wrong in the set-up.
pub type SetUpError = Box<dyn Error>;

/// A solid of the catalogue at the benchmarks' size.
pub fn solid(id: &str) -> Result<Polyhedron, SetUpError> {
    Ok(id.parse::<CatalogueShape>()?.polyhedron(DIAMETER)?)
}

/// A value in -1..1 that depends on `i` alone.
fn noise(i: u32) -> f64 {
    let x = u64::from(i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// `count` bodies in a box 5.3 diameters wide, `time` seconds after they were let go. All
/// are awake. The penalty is such that a pack of this height overlaps by about 0.25 % of d.
pub fn pack(id: &str, count: u32, time: f64) -> Result<World, SetUpError> {
    let mut parameters = WorldParameters::default();
    parameters.contact.penalty = 1e4 * DENSITY * 9.81 * DIAMETER;
    let mut world = World::new(parameters)?;
    world.set_sleeping(false);
    let shape = world.add_shape(id, &solid(id)?)?;
    let side = 5.3 * DIAMETER;
    let top = Vector3::new(side, side, 100.0 * DIAMETER);
    for wall in Wall::closed_box(Vector3::zeros(), top)? {
        world.add_wall(wall, Drive::Fixed)?;
    }
    for i in 0..count {
        let cell = Vector3::from([i % ROW, i / ROW % ROW, i / ROW / ROW].map(f64::from));
        let position = (cell * 1.05).add_scalar(0.525) * DIAMETER;
        let turn = Vector3::from([3 * i, 3 * i + 1, 3 * i + 2].map(noise)) * 3.0;
        world.add_body(BodySpec::at_rest(shape, DENSITY, Pose::new(position, turn)))?;
    }
    while world.time() < time {
        world.step()?;
    }
    Ok(world)
}

/// The shape of a pack for the kernel, and where its bodies are.
pub fn frames(id: &str, world: &World) -> Result<(ConvexShape, Vec<Frame>), SetUpError> {
    let shape = ConvexShape::new(&solid(id)?)?;
    let bodies = world.body_ids();
    let poses = bodies.filter_map(|i| world.pose(i));
    Ok((shape, poses.map(|p| Frame::from(&p)).collect()))
}
