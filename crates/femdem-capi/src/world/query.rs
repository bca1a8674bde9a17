//! The state of a world.

use std::mem::MaybeUninit;

use femdem_solve::contact::{BodyId, Load};
use femdem_solve::{SolveError, World};

use super::Hosted;
use crate::border::{Failure, FemdemStatus, answer, border, place};
use crate::handles::FemdemWorld;
use crate::plain::{FemdemContact, FemdemLoad, FemdemMotion, FemdemPose, FemdemVelocity};

/// How far a world has come.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemWorldState {
    /// s.
    pub time: f64,
    /// The present step, s; 0 before the first.
    pub time_step: f64,
    /// The stability bound that it was chosen from, s; infinite without contact.
    pub stable_step: f64,
    /// Largest net force on a body over the larger of its weight and its mean contact force: how far from balance.
    pub residual: f64,
    /// Steps taken.
    pub steps: u64,
    /// Rigid bodies.
    pub body_count: usize,
    /// Deformable bodies.
    pub deformable_count: usize,
    /// Bodies that are not frozen.
    pub awake_count: usize,
    /// Walls.
    pub wall_count: usize,
}

/// Where all energy came from and went, J.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemLedger {
    /// Of all bodies when they were added.
    pub initial: f64,
    /// What the caller has put in by hand.
    pub by_hand: f64,
    /// Work of what is driven.
    pub work_in: f64,
    /// Work of loads.
    pub load_work: f64,
    /// Lent to cracks at their births; it comes back in what they dissipate.
    pub lent: f64,
    /// Kinetic energy now.
    pub kinetic: f64,
    /// Potential energy in gravity now, about the origin.
    pub potential: f64,
    /// Energy of the normal contacts now.
    pub elastic: f64,
    /// Elastic energy inside deformable bodies now.
    pub strain: f64,
    /// Energy of the friction springs now.
    pub friction_springs: f64,
    /// Energy in the cracks of bodies now.
    pub cracks: f64,
    /// Energy in bonds now.
    pub bonds: f64,
    /// Dissipated by friction.
    pub dissipated_friction: f64,
    /// Dissipated by normal dashpots.
    pub dissipated_damping: f64,
    /// Dissipated by drag and local damping.
    pub dissipated_medium: f64,
    /// Dissipated by the viscosity of matter.
    pub dissipated_viscous: f64,
    /// Dissipated by plastic flow.
    pub dissipated_plastic: f64,
    /// Dissipated where liquid bridges broke.
    pub dissipated_bridges: f64,
    /// Dissipated by breaking: less what was lent, this is the energy of fracture.
    pub dissipated_fracture: f64,
    /// Dissipated by breaking bonds.
    pub dissipated_bonds: f64,
    /// Dissipated as the pressure of new cracks fades, by contacts whose field cracks change, and where bonds ended.
    pub dissipated_release: f64,
    /// Dissipated by implicit steps.
    pub dissipated_step: f64,
    /// Kinetic energy removed when bodies were frozen.
    pub frozen: f64,
    /// Exchanged so far.
    pub exchanged: f64,
    /// All that was dissipated.
    pub dissipated: f64,
    /// All energy now, plus what was dissipated, minus all that was put in: the error of the time integration.
    pub error: f64,
    /// The same over the energy that was exchanged.
    pub error_relative: f64,
}

/// Writes how far a world has come.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_state(
    world: FemdemWorld,
    state: Option<&mut MaybeUninit<FemdemWorldState>>,
) -> FemdemStatus {
    border(|| {
        let state = place("state", state)?;
        world.with(|own| {
            let world = &own.world;
            state.write(FemdemWorldState {
                time: world.time(),
                time_step: world.time_step(),
                stable_step: world.time_step_bound(),
                residual: world.residuals().max_over_load,
                steps: world.steps(),
                body_count: world.rigid_count(),
                deformable_count: world.deformable_count(),
                awake_count: world.awake_count(),
                wall_count: world.walls().count(),
            });
            Ok(())
        })
    })
}

/// Writes a hash of all that the next step depends on: equal for the same bits.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_hash(
    world: FemdemWorld,
    hash: Option<&mut MaybeUninit<u64>>,
) -> FemdemStatus {
    border(|| {
        let hash = place("hash", hash)?;
        world.with(|own| {
            hash.write(own.world.state_hash()?);
            Ok(())
        })
    })
}

/// Writes the energy ledger.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_ledger(
    world: FemdemWorld,
    ledger: Option<&mut MaybeUninit<FemdemLedger>>,
) -> FemdemStatus {
    border(|| {
        let to = place("ledger", ledger)?;
        world.with(|own| {
            let ledger = own.world.ledger();
            to.write(FemdemLedger {
                initial: ledger.initial,
                by_hand: ledger.by_hand,
                work_in: ledger.work_in,
                load_work: ledger.load_work,
                lent: ledger.lent,
                kinetic: ledger.kinetic,
                potential: ledger.potential,
                elastic: ledger.elastic,
                strain: ledger.strain,
                friction_springs: ledger.friction_springs,
                cracks: ledger.cracks,
                bonds: ledger.bonds,
                dissipated_friction: ledger.dissipated_friction,
                dissipated_damping: ledger.dissipated_damping,
                dissipated_medium: ledger.dissipated_medium,
                dissipated_viscous: ledger.dissipated_viscous,
                dissipated_plastic: ledger.dissipated_plastic,
                dissipated_bridges: ledger.dissipated_bridges,
                dissipated_fracture: ledger.dissipated_fracture,
                dissipated_bonds: ledger.dissipated_bonds,
                dissipated_release: ledger.dissipated_release,
                dissipated_step: ledger.dissipated_step,
                frozen: ledger.frozen,
                exchanged: ledger.exchanged,
                dissipated: ledger.dissipated(),
                error: ledger.error(),
                error_relative: ledger.error_relative(),
            });
            Ok(())
        })
    })
}

/// Writes the number of bodies, and their numbers, ascending, if `room` is not 0: then it must suffice for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_bodies(
    world: FemdemWorld,
    bodies: *mut u32,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let ids = world.with(|own| Ok(own.world.rigid_ids().collect::<Vec<BodyId>>()))?;
        // SAFETY: as the caller promises.
        unsafe { answer("bodies", ids.into_iter(), (bodies, room), count) }
    })
}

/// Writes the number of bodies, and how they move, in the order of femdem_world_bodies, if `room` is not 0: then it must suffice
/// for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_motions(
    world: FemdemWorld,
    motions: *mut FemdemMotion,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = |own: &mut Hosted| {
            let ids = own.world.rigid_ids();
            Ok(ids
                .filter_map(|id| motion(&own.world, id))
                .collect::<Vec<_>>())
        };
        let all = world.with(all)?;
        // SAFETY: as the caller promises.
        unsafe { answer("motions", all.into_iter(), (motions, room), count) }
    })
}

fn motion(world: &World, id: BodyId) -> Option<FemdemMotion> {
    Some(FemdemMotion {
        pose: FemdemPose::from(world.pose(id)?),
        velocity: FemdemVelocity {
            linear: world.velocity(id)?.into(),
            angular: world.angular_velocity(id)?.into(),
        },
    })
}

/// Writes how a body moves.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_motion(
    world: FemdemWorld,
    body: u32,
    motion: Option<&mut MaybeUninit<FemdemMotion>>,
) -> FemdemStatus {
    border(|| {
        let to = place("motion", motion)?;
        world.with(|own| {
            let found = self::motion(&own.world, body);
            to.write(found.ok_or_else(|| no_such("rigid body", body, own.world.rigid_count()))?);
            Ok(())
        })
    })
}

/// Writes what the contacts do to a body.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_body_load(
    world: FemdemWorld,
    body: u32,
    load: Option<&mut MaybeUninit<FemdemLoad>>,
) -> FemdemStatus {
    border(|| {
        let to = place("load", load)?;
        world.with(|own| {
            let load = own.world.load(body);
            write_load(to, load, || {
                no_such("rigid body", body, own.world.rigid_count())
            })
        })
    })
}

/// Writes what the contacts do to a wall, about its origin.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_wall_load(
    world: FemdemWorld,
    wall: u32,
    load: Option<&mut MaybeUninit<FemdemLoad>>,
) -> FemdemStatus {
    border(|| {
        let to = place("load", load)?;
        world.with(|own| {
            let load = own.world.wall_load(wall);
            write_load(to, load, || {
                no_such("wall", wall, own.world.walls().count())
            })
        })
    })
}

fn write_load(
    to: &mut MaybeUninit<FemdemLoad>,
    load: Option<Load>,
    no_such: impl FnOnce() -> Failure,
) -> Result<(), Failure> {
    to.write(FemdemLoad::from(&load.ok_or_else(no_such)?));
    Ok(())
}

/// Writes the number of contacts, and the contacts, sorted by pair and patch, if `room` is not 0: then it must suffice for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_contacts(
    world: FemdemWorld,
    contacts: *mut FemdemContact,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = world.with(|own| Ok(own.world.contacts()))?;
        let all = all.iter().map(FemdemContact::from);
        // SAFETY: as the caller promises.
        unsafe { answer("contacts", all, (contacts, room), count) }
    })
}

/// Things that there are none of.
pub(super) fn no_such(what: &'static str, index: u32, count: usize) -> Failure {
    let index = index as usize;
    SolveError::NoSuch { what, index, count }.into()
}
