//! Queries of a world.

use super::{Counters, Deformable, World};
use crate::body::{Body, Shape, ShapeId};
use crate::ledger::Ledger;
use crate::parameters::WorldParameters;
use femdem_contact::{BodyId, Contact, Load, RigidContact, WallShape};
use femdem_mesh::nalgebra::{Rotation3, Translation3, UnitQuaternion};
use femdem_mesh::{Pose, Vector3};
use serde::{Deserialize, Serialize};

/// How far the bodies are from equilibrium. Net forces include gravity and external loads and are taken from all recorded
/// contacts; driven bodies are excluded. Without gravity, net force over weight is infinite for a body with a
/// net force, and 0 for one in balance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// Mean over bodies of net force over weight.
    pub mean_over_weight: f64,
    /// Largest net force over weight.
    pub max_over_weight: f64,
    /// Largest net force over the larger of the body's weight and its mean contact force.
    pub max_over_load: f64,
    /// The body with the largest `max_over_load`.
    pub worst_body: Option<BodyId>,
    /// Largest kinetic energy of a body over m g d.
    pub kinetic_energy_over_mgd: f64,
}

impl World {
    /// The parameters.
    pub fn parameters(&self) -> &WorldParameters {
        &self.parameters
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The present step size, s; 0 before the first step.
    pub fn time_step(&self) -> f64 {
        self.step_control.current()
    }

    /// The stability bound that the step was chosen from, s; infinite without contact.
    pub fn time_step_bound(&self) -> f64 {
        self.step_control.bound()
    }

    /// Number of bodies, rigid and deformable.
    pub fn body_count(&self) -> usize {
        self.batch.len()
    }

    /// The bodies, rigid and deformable, ascending. Their numbers have gaps once bodies were [removed](Self::remove_body).
    pub fn body_ids(&self) -> impl Iterator<Item = BodyId> {
        self.batch.body_ids()
    }

    /// Number of rigid bodies.
    pub fn rigid_count(&self) -> usize {
        self.batch.rigid_count()
    }

    /// The rigid bodies, ascending.
    pub fn rigid_ids(&self) -> impl Iterator<Item = BodyId> {
        self.batch.rigid_ids()
    }

    /// Whether there is such a body, rigid or deformable.
    pub fn has_body(&self, id: BodyId) -> bool {
        self.batch.contains(id)
    }

    /// The shapes, by index.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// A shape, or `None` for an unknown index.
    pub fn shape(&self, id: ShapeId) -> Option<&Shape> {
        self.shapes.get(id as usize)
    }

    /// Depth over which the contact field of a shape rises from its surface, m: the smallest distance of a face from the centroid
    /// for a convex shape.
    pub fn field_depth(&self, id: ShapeId) -> Option<f64> {
        Some(self.batch.shapes().get(id as usize)?.inradius())
    }

    pub(super) fn body(&self, id: BodyId) -> Option<&Body> {
        self.batch.is_rigid(id).then(|| &self.bodies[id as usize])
    }

    /// Pose of a rigid body: from the coordinates of its shape's polyhedron to the world.
    pub fn pose(&self, id: BodyId) -> Option<Pose> {
        let body = self.body(id)?;
        Some(body.pose(&self.shapes[body.shape as usize]))
    }

    /// Centre of mass of a body, m.
    pub fn position(&self, id: BodyId) -> Option<Vector3> {
        let soft = || self.deformable(id).map(|body| body.centroid());
        self.body(id).map(|b| b.position).or_else(soft)
    }

    /// Velocity of a body's centre of mass, m/s.
    pub fn velocity(&self, id: BodyId) -> Option<Vector3> {
        let soft = || {
            self.deformable(id)
                .map(|body| body.momentum() / body.mass())
        };
        self.body(id).map(|b| b.velocity).or_else(soft)
    }

    /// Angular velocity of a rigid body, world axes, rad/s.
    pub fn angular_velocity(&self, id: BodyId) -> Option<Vector3> {
        self.body(id).map(Body::angular_velocity)
    }

    /// Whether a rigid body follows a drive, so that contacts do not move it.
    pub fn follows_drive(&self, id: BodyId) -> Option<bool> {
        Some(self.body(id)?.driven.is_some())
    }

    /// Mass of a body, kg.
    pub fn mass(&self, id: BodyId) -> Option<f64> {
        let soft = || self.deformable(id).map(|body| body.mass());
        self.body(id).map(|b| b.mass).or_else(soft)
    }

    /// Shape of a rigid body.
    pub fn shape_of(&self, id: BodyId) -> Option<ShapeId> {
        self.body(id).map(|b| b.shape)
    }

    /// Whether a body is frozen.
    pub fn is_asleep(&self, id: BodyId) -> bool {
        self.batch.contains(id) && !self.batch.is_awake(id)
    }

    /// Awake rigid bodies, ascending.
    pub fn awake(&self) -> &[BodyId] {
        &self.awake
    }

    /// Number of awake rigid bodies.
    pub fn awake_count(&self) -> usize {
        self.awake.len()
    }

    /// Axis-aligned bounding box of a rigid body, m.
    pub fn bounds(&self, id: BodyId) -> Option<(Vector3, Vector3)> {
        let body = self.body(id)?;
        let frame = &self.motions[id as usize].frame;
        let shape = self.batch.shapes().get(body.shape as usize)?;
        let (low, high) = shape.bounds(&frame.rotation);
        Some((low + frame.position, high + frame.position))
    }

    /// Kinetic energy of a body, J.
    pub fn body_kinetic_energy(&self, id: BodyId) -> Option<f64> {
        let soft = || self.deformable(id).map(|body| body.kinetic_energy());
        self.body(id).map(Body::kinetic_energy).or_else(soft)
    }

    /// Kinetic energy of all bodies except driven ones, J.
    pub fn kinetic_energy(&self) -> f64 {
        let rigid = self.free_bodies().map(|(_, b)| b.kinetic_energy());
        // A sum of nothing is -0.
        0.0 + rigid.sum::<f64>() + self.deformables().map(|d| d.kinetic_energy()).sum::<f64>()
    }

    pub(super) fn free_bodies(&self) -> impl Iterator<Item = (usize, &Body)> {
        self.live_bodies().filter(|(_, b)| b.driven.is_none())
    }

    /// All rigid bodies, driven ones too, without guests.
    pub(super) fn live_bodies(&self) -> impl Iterator<Item = (usize, &Body)> {
        let own = self.rigid_ids().filter(|&id| !self.is_guest(id));
        own.map(|id| (id as usize, &self.bodies[id as usize]))
    }

    /// Linear momentum of all bodies except driven ones, kg m/s.
    pub fn linear_momentum(&self) -> Vector3 {
        let rigid = self.free_bodies().map(|(_, b)| b.velocity * b.mass);
        rigid.sum::<Vector3>() + self.deformables().map(|d| d.momentum()).sum::<Vector3>()
    }

    /// Centre of mass of all bodies except driven ones, m; the origin if there are none.
    pub fn centre_of_mass(&self) -> Vector3 {
        let rigid = self.free_bodies().map(|(_, b)| (b.mass, b.position));
        let soft = self.deformables().map(|d| (d.mass(), d.centroid()));
        let add = |(mass, moment), (m, x): (f64, Vector3)| (mass + m, moment + x * m);
        let (mass, moment) = rigid.chain(soft).fold((0.0, Vector3::zeros()), add);
        if mass > 0.0 { moment / mass } else { moment }
    }

    /// Angular momentum of all bodies except driven ones about a point, kg m^2/s.
    pub fn angular_momentum(&self, about: &Vector3) -> Vector3 {
        let rigid = self.free_bodies().map(|(_, b)| {
            b.orientation * b.momentum + (b.position - about).cross(&(b.velocity * b.mass))
        });
        let deformable = self.deformables().map(|d| d.angular_momentum(about));
        rigid.sum::<Vector3>() + deformable.sum::<Vector3>()
    }

    /// All recorded contacts of rigid and deformable bodies, sorted by pair and patch: a contact for each patch.
    pub fn contacts(&self) -> Vec<Contact> {
        self.batch.contacts()
    }

    /// The contacts of one body, sorted by pair and patch.
    pub fn contacts_of(&self, id: BodyId) -> Vec<Contact> {
        self.batch.contacts_of(id)
    }

    /// The contacts of rigid bodies with each other and with walls, with all that the law knows of them.
    pub fn rigid_contacts(&self) -> Vec<&RigidContact> {
        self.batch.rigid_contacts()
    }

    /// The walls with their indices, ascending. The indices have gaps once walls were [removed](Self::remove_wall).
    pub fn walls(&self) -> impl Iterator<Item = (u32, &WallShape)> {
        self.batch.walls()
    }

    /// A wall, or `None` for an unknown index.
    pub fn wall(&self, wall: u32) -> Option<&WallShape> {
        self.batch.wall(wall)
    }

    /// Present pose of a wall: from its own coordinates to the world.
    pub fn wall_pose(&self, wall: u32) -> Option<Pose> {
        self.batch.wall(wall)?;
        let frame = &self.wall_motions.get(wall as usize)?.frame;
        let rotation = Rotation3::from_matrix_unchecked(frame.rotation);
        Some(Pose::from_parts(
            Translation3::from(frame.position),
            UnitQuaternion::from_rotation_matrix(&rotation),
        ))
    }

    /// The load on a wall, about its origin, from all its recorded contacts.
    pub fn wall_load(&self, wall: u32) -> Option<Load> {
        self.batch.wall(wall)?;
        Some(self.batch.wall_load_of(wall))
    }

    /// Elastic energy of the recorded contacts and that of their attraction, without that of friction springs, of the deformable bodies, and of bonds, J.
    pub fn stored_energy(&self) -> f64 {
        let rigid = self.batch.booked_contacts().map(RigidContact::potential);
        let soft = self.deformable_totals().map(|totals| totals.energy);
        let strain = self.deformables().map(|body| {
            let cracks = body.cracks().map_or(0.0, |cracks| cracks.stored());
            body.internal().energy + cracks
        });
        rigid.chain(soft).chain(strain).sum::<f64>() + self.batch.stored_in_bonds(None)
    }

    /// The load on a rigid body, about its centroid, from all its recorded contacts.
    pub fn load(&self, id: BodyId) -> Option<Load> {
        self.body(id).map(|_| self.batch.load_of(id))
    }

    /// Residual of a rigid body over the larger of its weight and the mean normal force of its contacts and bonds: its net force, or its net moment over
    /// its diameter if that is larger, both without dashpots.
    pub fn body_residual(&self, id: BodyId) -> Option<f64> {
        let body = self.body(id)?;
        let load = self.batch.load_of(id);
        let weight = body.mass * self.parameters.gravity.norm();
        Some(over(
            self.imbalance(id as usize, &load),
            weight.max(mean_force(&load)),
        ))
    }

    /// Net force of a body, or its net moment over its diameter if that is larger, without dashpots, N.
    pub(super) fn imbalance(&self, i: usize, load: &Load) -> f64 {
        let moment = self.net_torque(i, load).norm() / (2.0 * self.bodies[i].radius);
        self.net_force(i, load).norm().max(moment)
    }

    /// Residuals over all free rigid bodies. Deformable bodies are not part of them: see
    /// [`relax`](Self::relax), which measures both.
    pub fn residuals(&self) -> Residuals {
        let mut r = Residuals {
            mean_over_weight: 0.0,
            max_over_weight: 0.0,
            max_over_load: 0.0,
            worst_body: None,
            kinetic_energy_over_mgd: 0.0,
        };
        let g = self.parameters.gravity.norm();
        let mut count = 0.0;
        for (i, body) in self.free_bodies() {
            let load = self.batch.load_of(i as u32);
            let net = self.imbalance(i, &load);
            let weight = body.mass * g;
            let over_load = over(net, weight.max(mean_force(&load)));
            if r.worst_body.is_none() || over_load > r.max_over_load {
                r.max_over_load = over_load;
                r.worst_body = Some(i as u32);
            }
            r.mean_over_weight += over(net, weight);
            r.max_over_weight = r.max_over_weight.max(over(net, weight));
            let scale = weight * 2.0 * body.radius;
            r.kinetic_energy_over_mgd = r
                .kinetic_energy_over_mgd
                .max(over(body.kinetic_energy(), scale));
            count += 1.0;
        }
        if count > 0.0 {
            r.mean_over_weight /= count;
        }
        r
    }

    /// The energy ledger now.
    pub fn ledger(&self) -> Ledger {
        let contacts: Vec<&RigidContact> = self.batch.booked_contacts().collect();
        let soft = self.deformable_totals();
        let friction_springs = contacts.iter().map(|c| c.spring_energy).sum::<f64>()
            + soft.map_or(0.0, |t| t.spring_energy);
        let g = self.parameters.gravity;
        // A sum of nothing is -0.
        let deformable =
            |f: &dyn Fn(Deformable) -> f64| 0.0 + self.deformables().map(f).sum::<f64>();
        Ledger {
            initial: self.initial_energy,
            work_in: self.flows.work_in,
            by_hand: self.flows.by_hand,
            load_work: self.flows.load_work,
            lent: self.flows.cracks.lent + self.flows.bonds.lent,
            fidelity: self.flows.fidelity,
            kinetic: self.kinetic_energy(),
            potential: self
                .free_bodies()
                .map(|(_, b)| -b.mass * g.dot(&b.position))
                .sum::<f64>()
                + deformable(&|d| d.potential(&g)),
            elastic: contacts.iter().map(|c| c.potential()).sum::<f64>()
                + self.flows.pending.map_or(0.0, |pending| pending.taken)
                + soft.map_or(0.0, |t| t.energy),
            strain: deformable(&|d| d.internal().energy),
            friction_springs,
            bonds: self.batch.stored_in_bonds(None),
            cracks: deformable(&|d| d.cracks().map_or(0.0, |cracks| cracks.stored())),
            dissipated_friction: self.flows.cracks.friction + self.flows.bonds.friction
                - self.flows.friction_work
                - friction_springs,
            dissipated_damping: 0.0 - self.flows.damping_work,
            dissipated_medium: 0.0 - self.flows.medium_work,
            dissipated_viscous: 0.0 - self.flows.viscous_work,
            dissipated_plastic: 0.0 - self.flows.plastic_work,
            dissipated_bridges: self.flows.broken,
            dissipated_fracture: self.flows.cracks.glue,
            dissipated_bonds: self.flows.bonds.glue,
            dissipated_release: self.flows.cracks.released + self.flows.bonds.released,
            dissipated_step: self.flows.step_loss,
            frozen: self.flows.frozen,
            exchanged: self.flows.exchanged,
        }
    }

    /// Work counters.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }
}

/// A quotient whose denominator may be 0; 0 over 0 is 0.
fn over(part: f64, whole: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / whole }
}

/// Mean normal force over the contacts and bonds of a body, N.
fn mean_force(load: &Load) -> f64 {
    if load.contacts > 0 {
        load.normal_sum / f64::from(load.contacts)
    } else {
        0.0
    }
}
