//! Worlds as files and bytes.

use std::ffi::c_char;
use std::mem::MaybeUninit;
use std::path::Path;

use femdem_solve::{World, checkpoint};

use crate::border::{FemdemStatus, answer, border, list, place, text};
use crate::handles::FemdemWorld;

/// The kind of checkpoint.
const KIND: &str = "world";

/// Writes the whole state into a file. The earlier file of that name stays until the new one is complete.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_save(
    world: FemdemWorld,
    path: *const c_char,
) -> FemdemStatus {
    border(|| {
        // SAFETY: as the caller promises.
        let path = Path::new(unsafe { text("path", path)? });
        world.with(|own| Ok(checkpoint::write_file(path, KIND, &own.world)?))
    })
}

/// Makes a world of a file of femdem_world_save. It goes on with the same bits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_load(
    path: *const c_char,
    world: Option<&mut MaybeUninit<FemdemWorld>>,
) -> FemdemStatus {
    border(|| {
        let to = place("world", world)?;
        // SAFETY: as the caller promises.
        let path = Path::new(unsafe { text("path", path)? });
        let mut world: World = checkpoint::read_file(path, KIND)?;
        world.restore()?;
        to.write(FemdemWorld::new(world.into()));
        Ok(())
    })
}

/// Writes how many bytes hold the whole state, and the bytes if `room` is not 0: then it must suffice for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_to_bytes(
    world: FemdemWorld,
    bytes: *mut u8,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let state = world.with(|own| Ok(own.world.to_bytes()?))?;
        // SAFETY: as the caller promises.
        unsafe { answer("bytes", state.into_iter(), (bytes, room), count) }
    })
}

/// Makes a world of the bytes of femdem_world_to_bytes. It goes on with the same bits.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_from_bytes(
    bytes: *const u8,
    count: usize,
    world: Option<&mut MaybeUninit<FemdemWorld>>,
) -> FemdemStatus {
    border(|| {
        let to = place("world", world)?;
        // SAFETY: as the caller promises.
        let made = World::from_bytes(unsafe { list("bytes", bytes, count)? })?;
        to.write(FemdemWorld::new(made.into()));
        Ok(())
    })
}
