//! Steps of a world.

use crate::border::{Failure, FemdemStatus, border};
use crate::handles::FemdemWorld;

/// Takes `steps` steps; the world chooses their size. If one fails, those before it stay taken; with FEMDEM_STATUS_FAILED the
/// world is of no further use.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_step(world: FemdemWorld, steps: u64) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let world = &mut own.world;
            Ok(own
                .threads
                .run(|| (0..steps).try_for_each(|_| world.step()))?)
        })
    })
}

/// Takes steps until a time in s is reached, by at most one step more. If one fails, it is as in femdem_world_step.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_step_until(world: FemdemWorld, time: f64) -> FemdemStatus {
    border(|| {
        if !time.is_finite() {
            return Err(Failure::refused("time", time, "finite, in s"));
        }
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| {
                while world.time() < time {
                    world.step()?;
                }
                Ok::<_, femdem_solve::SolveError>(())
            })?)
        })
    })
}
