//! What comes into a world.

use std::mem::MaybeUninit;

use femdem_solve::contact::{MaterialId, WallShape};
use femdem_solve::{BodySpec, Drive};

use super::Hosted;
use crate::border::{Failure, FemdemStatus, border, given, place};
use crate::handles::{FemdemShape, FemdemWorld};
use crate::law::material;
use crate::plain::{FemdemBox, FemdemMotion, FemdemPlane};
use crate::wall::{FemdemSides, Sheet};

/// Adds a body of a density in kg/m^3. Its number is the lowest that is free.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_add_body(
    world: FemdemWorld,
    shape: FemdemShape,
    density: f64,
    motion: Option<&FemdemMotion>,
    material_id: u32,
    body: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let body = place("body", body)?;
        let motion = given("motion", motion)?;
        let [velocity, angular_velocity] = motion.velocity.parts();
        let (pose, of) = (motion.pose.checked()?, material(material_id)?);
        let form = shape.form()?;
        world.with(|own| {
            let spec = BodySpec {
                shape: 0,
                density,
                pose,
                velocity,
                angular_velocity,
                material: of,
            };
            body.write(own.add_body(&form, spec)?);
            Ok(())
        })
    })
}

impl Hosted {
    fn add_wall(&mut self, wall: impl Into<WallShape>, of: MaterialId) -> Result<u32, Failure> {
        let id = self.world.add_wall(wall, Drive::Fixed)?;
        let world = &mut self.world;
        self.threads.run(|| world.set_wall_material(id, of))?;
        Ok(id)
    }
}

/// Adds a plane wall.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_add_plane(
    world: FemdemWorld,
    plane: Option<&FemdemPlane>,
    material_id: u32,
    wall: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let wall = place("wall", wall)?;
        let (made, of) = (given("plane", plane)?.wall()?, material(material_id)?);
        world.with(|own| {
            wall.write(own.add_wall(made, of)?);
            Ok(())
        })
    })
}

/// Adds the six walls of a box. `sides` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_add_box(
    world: FemdemWorld,
    inside: Option<&FemdemBox>,
    material_id: u32,
    sides: Option<&mut MaybeUninit<FemdemSides>>,
) -> FemdemStatus {
    border(|| {
        let (made, of) = (given("inside", inside)?.walls()?, material(material_id)?);
        let add = |own: &mut Hosted| {
            let walls = made.into_iter().map(|wall| own.add_wall(wall, of));
            walls.collect::<Result<Vec<u32>, Failure>>()
        };
        let walls = world.with(add)?;
        if let Some(sides) = sides {
            sides.write(FemdemSides::of(&walls));
        }
        Ok(())
    })
}

/// Adds a wall of triangles, of a thickness in m behind them: bodies are where the triangles are counter-clockwise. Vertices
/// and triangles as in femdem_shape_surface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_add_sheet(
    world: FemdemWorld,
    vertices: *const f64,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    thickness: f64,
    material_id: u32,
    wall: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let wall = place("wall", wall)?;
        let sheet = Sheet {
            vertices,
            vertex_count,
            triangles,
            triangle_count,
            thickness,
        };
        // SAFETY: as the caller promises.
        let (made, of) = (unsafe { sheet.wall()? }, material(material_id)?);
        world.with(|own| {
            wall.write(own.add_wall(made, of)?);
            Ok(())
        })
    })
}
