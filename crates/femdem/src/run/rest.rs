//! Whether a simulation is at rest, and the end of a run at rest.

use femdem_mesh::Vector3;
use femdem_pack::Settling;
use femdem_solve::World;
use serde::{Deserialize, Serialize};

use super::contacts::ContactForces;
use super::{BoundaryEntry, ContactLine, ControlEntry, LoadEntry, Run, Scenario, Side, Simulation};

/// Largest residual of a body at rest, and its largest kinetic energy over its load times its diameter: as for a settled pack.
const LIMITS: Settling = Settling::USUAL;

/// Largest difference between what walls and supports carry and what weighs on them.
const BALANCE: f64 = 1e-3;

/// The part of the forces on the walls that counts as their load where it is larger than the weight: a press carries
/// many weights.
const OF_WALLS: f64 = 0.01;

/// In this last part of the duration nothing is frozen, so that the end of a run shows no force that a frozen body holds
/// back.
const AWAKE_AT_LAST: f64 = 0.05;

/// How near a simulation is to rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RestSummary {
    /// Whether it is at rest: nothing moves as prescribed, the residual is at most 0.02, the motion at most 1e-6, and the
    /// force balance at most 1e-3.
    pub at_rest: bool,
    /// Whether a wall, a body or nodes move as prescribed now.
    pub driven: bool,
    /// Bodies that are frozen; what they are out of balance by is part of the residual.
    pub frozen: usize,
    /// Largest net force of a rigid body without dashpots, or net moment over its diameter, over the larger of its weight
    /// and its mean contact force; of deformable bodies the largest net force of a node or of a whole body over the mean
    /// contact force or, where nothing touches, the loads.
    pub residual: f64,
    /// Name of the rigid body with the largest residual; `null` without rigid bodies.
    pub worst: Option<String>,
    /// Largest kinetic energy of a body over its diameter times the larger of its weight and its mean contact force or, if it
    /// has neither, the mean force of all contacts; `null` if a body moves where nothing bears a load.
    pub motion: Option<f64>,
    /// Size of the sum of the forces on walls, supports and driven bodies less the weights and loads of all others, over the
    /// larger of those weights and a hundredth of those forces.
    pub force_balance: f64,
}

impl Simulation {
    /// How near the bodies are to rest, by the forces of the last step.
    #[must_use]
    pub fn rest(&self) -> RestSummary {
        let contacts = self.contacts();
        let ids = self.world.body_ids();
        let frozen = ids.filter(|&id| self.world.is_asleep(id)).count();
        let found = self.world.residuals();
        let elements = self.world.deformable_residual().unwrap_or(0.0);
        let residual = found.max_over_load.max(elements);
        let motion = self.motion(&contacts);
        let force_balance = self.force_balance(&self.forces(&contacts));
        let driven = self.world.is_driven(0.0);
        let worst = found.worst_body.and_then(|id| self.member_of(id));
        RestSummary {
            at_rest: !driven
                && residual <= LIMITS.residual
                && motion <= LIMITS.kinetic_energy
                && force_balance <= BALANCE,
            driven,
            frozen,
            residual,
            worst: worst.map(|member| self.name_of(Side::Member(member))),
            motion: motion.is_finite().then_some(motion),
            force_balance,
        }
    }

    /// Largest kinetic energy of a free body over its diameter times its load; a body without any, as a rattler without
    /// weight, has the mean force of all contacts.
    fn motion(&self, contacts: &[ContactLine]) -> f64 {
        let mut forces = vec![(0.0, 0.0); self.members.len()];
        for contact in contacts {
            let a = match contact.a {
                Side::Member(member) => Some(member),
                Side::Wall(_) => None,
            };
            for member in a.into_iter().chain([contact.b]) {
                forces[member].0 += contact.normal_force;
                forces[member].1 += 1.0;
            }
        }
        let g = self.world.parameters().gravity.norm();
        let normal: f64 = contacts.iter().map(|contact| contact.normal_force).sum();
        let mean = normal / f64::max(contacts.len() as f64, 1.0);
        let each = forces.into_iter().enumerate();
        let each = each.filter_map(|(member, (sum, count))| {
            let id = self.members[member].id;
            if self.world.follows_drive(id) == Some(true) {
                return None;
            }
            let (energy, mass) = (self.world.body_kinetic_energy(id)?, self.world.mass(id)?);
            if energy == 0.0 {
                return Some(0.0);
            }
            let load = f64::max(mass * g, sum / f64::max(count, 1.0));
            let load = if load > 0.0 { load } else { mean };
            Some(energy / (load * self.diameter(member)?))
        });
        each.fold(0.0, f64::max)
    }

    /// Size of what walls, supports and driven bodies carry less what weighs on them, over what weighs.
    fn force_balance(&self, forces: &ContactForces) -> f64 {
        let mut weight = self.world.parameters().gravity * self.free_mass();
        let mut carried: Vec<Vector3> = forces.walls.clone();
        carried.extend(self.reactions().iter().map(|force| -force));
        for (member, force) in self.members.iter().zip(&forces.members) {
            if self.world.follows_drive(member.id) == Some(true) {
                carried.push(*force);
            }
        }
        let loads = self.world.deformables().flat_map(|body| body.loads());
        weight += loads.sum::<Vector3>() + self.load_on_rigid();
        let sum: Vector3 = carried.iter().sum();
        let borne: f64 = carried.iter().map(Vector3::norm).sum();
        let missing = (sum - weight).norm();
        if missing == 0.0 {
            0.0
        } else {
            missing / weight.norm().max(OF_WALLS * borne)
        }
    }
}

impl Scenario {
    /// Whether bodies may be frozen at a time, s: not near the end.
    #[must_use]
    pub fn sleeps_at(&self, time: f64) -> bool {
        self.sleeping && time < (1.0 - AWAKE_AT_LAST) * self.duration
    }

    /// Whether prescribed motions or changes of loads are still to come.
    pub(super) fn is_more_to_come(&self, world: &World) -> bool {
        let conditions = self.body.iter().flat_map(|body| &body.boundary);
        let mut loads = conditions.map(BoundaryEntry::settled_from);
        let mut on_bodies = self.load.iter().map(LoadEntry::settled_from);
        let mut controls = self.controls().map(ControlEntry::settled_from);
        world.is_driven(self.duration - world.time())
            || loads.any(|settled| settled > world.time())
            || on_bodies.any(|settled| settled > world.time())
            || controls.any(|settled| settled > world.time())
    }
}

impl Run {
    /// Lets bodies be frozen, or wakes them: nothing is frozen while rest is verified, nor near the end.
    pub(super) fn allow_sleep(&mut self) {
        let world = &self.simulation().world;
        let allowed = self.scenario().sleeps_at(world.time()) && !self.is_verifying();
        if world.parameters().sleeping.enabled != allowed {
            self.simulation_mut().world.set_sleeping(allowed);
        }
    }

    /// Whether prescribed motions or changes of loads are still to come, or bodies.
    pub(super) fn is_more_to_come(&self) -> bool {
        let simulation = self.simulation();
        let world = &simulation.world;
        self.scenario().is_more_to_come(world) || simulation.flow.is_to_come(world.time())
    }
}
