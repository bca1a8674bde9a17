//! What comes into a batch and goes.

use std::mem::MaybeUninit;

use femdem_solve::contact::ContactError;
use femdem_solve::mesh::Matrix3;

use super::{Batch, Body, heavy};
use crate::border::{Failure, FemdemStatus, border, given, list, place};
use crate::handles::{FemdemBatch, FemdemShape};
use crate::law::{FemdemLaw, material};
use crate::plain::{FemdemBox, FemdemPlane};
use crate::threads::Threads;
use crate::wall::{FemdemSides, Sheet};

/// Makes an empty batch with a law for all materials.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_new(
    law: Option<&FemdemLaw>,
    batch: Option<&mut MaybeUninit<FemdemBatch>>,
) -> FemdemStatus {
    border(|| {
        let batch = place("batch", batch)?;
        let law = given("law", law)?.law()?;
        batch.write(FemdemBatch::new(Batch::new(law)));
        Ok(())
    })
}

/// Gives a batch threads of its own; 0: those of the process again. Results are the same bits for any number.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_set_threads(batch: FemdemBatch, threads: u32) -> FemdemStatus {
    border(|| {
        batch.with(|own| {
            own.threads = Threads::new(threads)?;
            Ok(())
        })
    })
}

/// Gives two materials, from 0 to 255, or a material and itself, a law of their own; null: that of the batch again.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_set_law(
    batch: FemdemBatch,
    material_a: u32,
    material_b: u32,
    law: Option<&FemdemLaw>,
) -> FemdemStatus {
    border(|| {
        let pair = [material(material_a)?, material(material_b)?];
        let law = law.map(FemdemLaw::law).transpose()?;
        batch.with(|own| {
            let mut laws = own.batch.laws().clone();
            laws.set(pair, law);
            own.batch.set_laws(laws);
            Ok(())
        })
    })
}

/// Adds a body with the mass and the inertia of a density in kg/m^3; 0: a body that contacts do not move. Its number is the
/// lowest that is free.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_add_body(
    batch: FemdemBatch,
    shape: FemdemShape,
    density: f64,
    material_id: u32,
    body: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let body = place("body", body)?;
        let (form, of) = (shape.form()?, material(material_id)?);
        batch.with(|own| {
            body.write(own.add_body(&form, density, of)?);
            Ok(())
        })
    })
}

/// Gives a body another mass in kg and another inertia about its centroid: nine numbers in kg m^2, row by row, in its own axes.
/// Dashpots and the stable step need them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_batch_set_mass(
    batch: FemdemBatch,
    body: u32,
    mass: f64,
    inertia: *const f64,
    count: usize,
) -> FemdemStatus {
    border(|| {
        if count != 9 {
            return Err(Failure::size("inertia", count, 9, "three rows of three"));
        }
        // SAFETY: as the caller promises.
        let inertia = Matrix3::from_row_slice(unsafe { list("inertia", inertia, count)? });
        batch.with(|own| {
            own.body(body)?.own = heavy(mass, &inertia)?;
            Ok(())
        })
    })
}

/// Removes a body with its contacts. Its number is given to the next body, unless a lower one is free.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_remove_body(batch: FemdemBatch, body: u32) -> FemdemStatus {
    border(|| {
        batch.with(|own| {
            own.batch.remove_body(body)?;
            Ok(())
        })
    })
}

/// Ends the contacts of a body with their friction, because it was put somewhere else.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_forget_contacts(batch: FemdemBatch, body: u32) -> FemdemStatus {
    border(|| {
        batch.with(|own| {
            own.batch.moved_by_hand(body)?;
            Ok(())
        })
    })
}

/// Adds a plane wall.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_add_plane(
    batch: FemdemBatch,
    plane: Option<&FemdemPlane>,
    material_id: u32,
    wall: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let wall = place("wall", wall)?;
        let (made, of) = (given("plane", plane)?.wall()?, material(material_id)?);
        batch.with(|own| {
            wall.write(own.add_wall(made, of)?);
            Ok(())
        })
    })
}

/// Adds the six walls of a box. `sides` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_add_box(
    batch: FemdemBatch,
    inside: Option<&FemdemBox>,
    material_id: u32,
    sides: Option<&mut MaybeUninit<FemdemSides>>,
) -> FemdemStatus {
    border(|| {
        let (made, of) = (given("inside", inside)?.walls()?, material(material_id)?);
        let add = |own: &mut Batch| {
            let walls = made.into_iter().map(|wall| own.add_wall(wall, of));
            walls.collect::<Result<Vec<u32>, Failure>>()
        };
        let walls = batch.with(add)?;
        if let Some(sides) = sides {
            sides.write(FemdemSides::of(&walls));
        }
        Ok(())
    })
}

/// Adds a wall of triangles, of a thickness in m behind them: bodies are where the triangles are counter-clockwise. Vertices
/// and triangles as in femdem_shape_surface.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_batch_add_sheet(
    batch: FemdemBatch,
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
        batch.with(|own| {
            wall.write(own.add_wall(made, of)?);
            Ok(())
        })
    })
}

/// Removes a wall with its contacts.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_remove_wall(batch: FemdemBatch, wall: u32) -> FemdemStatus {
    border(|| {
        batch.with(|own| {
            own.batch.remove_wall(wall)?;
            Ok(())
        })
    })
}

impl Batch {
    /// A body by its number.
    fn body(&mut self, id: u32) -> Result<&mut Body, Failure> {
        let no_such = ContactError::NoSuch {
            what: "body",
            index: id as usize,
            count: self.batch.len(),
        };
        let found = self.bodies.get_mut(id as usize);
        let found = found.filter(|_| self.batch.contains(id));
        found.ok_or_else(|| no_such.into())
    }
}
