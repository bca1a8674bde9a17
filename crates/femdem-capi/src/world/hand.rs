//! What the caller changes between steps.

use femdem_solve::contact::Wrench;

use crate::border::{FemdemStatus, border, given};
use crate::handles::FemdemWorld;
use crate::plain::{FemdemLoad, FemdemPose, FemdemVelocity};

/// Puts a body somewhere else; it keeps its velocity, and its contacts end.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_pose(
    world: FemdemWorld,
    body: u32,
    pose: Option<&FemdemPose>,
) -> FemdemStatus {
    border(|| {
        let pose = given("pose", pose)?.checked()?;
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| world.set_pose(body, pose))?)
        })
    })
}

/// Gives a body another velocity; its contacts keep their friction.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_velocity(
    world: FemdemWorld,
    body: u32,
    velocity: Option<&FemdemVelocity>,
) -> FemdemStatus {
    border(|| {
        let [linear, angular] = given("velocity", velocity)?.parts();
        world.with(|own| Ok(own.world.set_velocity(body, linear, angular)?))
    })
}

/// Loads a body, besides gravity, until it is given another load.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_load(
    world: FemdemWorld,
    body: u32,
    load: Option<&FemdemLoad>,
) -> FemdemStatus {
    border(|| {
        let load = given("load", load)?;
        let load = Wrench {
            force: load.force.into(),
            torque: load.torque.into(),
        };
        world.with(|own| Ok(own.world.set_load(body, load)?))
    })
}

/// Removes a body with its contacts. Its number is given to the next body, unless a lower one is free.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_remove_body(world: FemdemWorld, body: u32) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| world.remove_body(body))?)
        })
    })
}

/// Removes a wall with its contacts.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_remove_wall(world: FemdemWorld, wall: u32) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| world.remove_wall(wall))?)
        })
    })
}
