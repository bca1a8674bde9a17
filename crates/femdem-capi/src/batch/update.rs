//! The step of a batch.

use std::mem::MaybeUninit;

use femdem_solve::contact::{ContactError, Motion};

use super::Batch;
use crate::border::{Failure, FemdemStatus, border, given, list, room};
use crate::handles::FemdemBatch;
use crate::plain::{FemdemLoad, FemdemMotion};

/// Writes how many numbers of bodies and of walls have been in use: the lengths of the arrays of femdem_batch_update and
/// femdem_batch_wall_loads. Either may be null.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_slots(
    batch: FemdemBatch,
    bodies: Option<&mut MaybeUninit<usize>>,
    walls: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let slots = batch.with(|own| Ok(own.batch.slots()))?;
        for (to, slots) in [bodies, walls].into_iter().zip(slots) {
            if let Some(to) = to {
                to.write(slots);
            }
        }
        Ok(())
    })
}

/// Finds all contacts where the bodies are now, and writes the load on each.
///
/// Motions and loads are by the numbers of the bodies; what stands at a number not in use is not read. `dt` is the time since
/// the last update in s, 0 in the first. Velocities are those of the half step before, as leapfrog has them: dashpots allow for
/// it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_batch_update(
    batch: FemdemBatch,
    motions: *const FemdemMotion,
    motion_count: usize,
    dt: f64,
    loads: *mut FemdemLoad,
    load_count: usize,
) -> FemdemStatus {
    border(|| {
        batch.with(|own| {
            if load_count != motion_count {
                return Err(Failure::size(
                    "loads",
                    load_count,
                    motion_count,
                    "as many as motions",
                ));
            }
            // SAFETY: as the caller promises.
            own.update(unsafe { list("motions", motions, motion_count)? }, dt)?;
            // SAFETY: as the caller promises; the motions are not in use any more.
            let to = unsafe { room("loads", loads, load_count)? };
            for (to, load) in to.iter_mut().zip(own.batch.loads()) {
                to.write(FemdemLoad::from(load));
            }
            Ok(())
        })
    })
}

/// Puts a wall at a pose of the coordinates in which it was added; its velocity is that of their origin. Both count from the next
/// update on, and stay until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_move_wall(
    batch: FemdemBatch,
    wall: u32,
    motion: Option<&FemdemMotion>,
) -> FemdemStatus {
    border(|| {
        let (frame, [velocity, angular_velocity]) = given("motion", motion)?.checked()?;
        let next = Motion {
            velocity,
            angular_velocity,
            ..Motion::fixed(frame)
        };
        batch.with(|own| {
            *own.wall(wall)? = next;
            Ok(())
        })
    })
}

impl Batch {
    /// Where a wall will be in the next update.
    fn wall(&mut self, wall: u32) -> Result<&mut Motion, Failure> {
        let no_such = ContactError::NoSuch {
            what: "wall",
            index: wall as usize,
            count: self.batch.walls().count(),
        };
        let found = self.next_walls.get_mut(wall as usize);
        let found = found.filter(|_| self.batch.wall(wall).is_some());
        found.ok_or_else(|| no_such.into())
    }
}
