//! Kicks of the deformable bodies.

use super::each::on_each;
use super::fracture::Breakable;
use super::{Deformables, State, centroid};
use crate::ledger::Flows;
use crate::parameters::{Medium, WorldParameters};
use crate::world::World;
use crate::world::medium::{relaxation, resist};
use crate::world::periodic::Streaming;
use femdem_contact::ContactBatch;
use femdem_contact::deform::NodalLoads;
use femdem_fem::DeformableModel;
use femdem_mesh::Vector3;

/// Everything that kicks bodies beside the forces on their nodes, and the duration.
pub(super) struct Kick<'a> {
    batch: &'a ContactBatch,
    gravity: &'a Vector3,
    medium: &'a Medium,
    /// Motion of the medium, if it moves.
    streaming: Option<Streaming>,
    /// s.
    h: f64,
}

/// What the second kick of a step does to a body.
struct Kicked {
    flows: Flows,
    /// The largest next step, s.
    step: f64,
    /// Work of what holds its nodes, J.
    held: f64,
    /// Kinetic energy after it, J.
    energy: f64,
}

impl Kicked {
    fn none() -> Self {
        Self {
            flows: Flows::default(),
            step: f64::INFINITY,
            held: 0.0,
            energy: 0.0,
        }
    }
}

impl<'a> Kick<'a> {
    pub fn new(
        batch: &'a ContactBatch,
        parameters: &'a WorldParameters,
        streaming: Option<Streaming>,
        h: f64,
    ) -> Self {
        Self {
            batch,
            streaming,
            gravity: &parameters.gravity,
            medium: &parameters.medium,
            h,
        }
    }

    /// Adds the impulse to the nodes of body `i`; returns the work.
    pub fn apply(&self, i: usize, body: &mut State, model: &DeformableModel) -> Flows {
        let i = i as u32;
        // Its cracks hold what contacts do to its nodes.
        let breakable = body.breakable.take();
        let cracks = breakable.as_deref().and_then(Breakable::cracks);
        let contact = match cracks {
            Some(cracks) => cracks.loads(self.batch.nodal_loads(i)),
            None => self.batch.nodal_loads(i),
        };
        let plain = *self.medium == Medium::default();
        let (masses, gravity) = (model.masses(), self.gravity + body.pull);
        let loaded = body.pull != Vector3::zeros();
        let before = if loaded {
            body.momentum(masses)
        } else {
            Vector3::zeros()
        };
        let mut flows = if !plain || !body.boundary.is_free() {
            let at = |s: &Streaming| s.at(&centroid(&body.positions, masses));
            let streaming = self.streaming.as_ref().map(at).unwrap_or_default();
            body.kick(
                &contact,
                masses,
                &gravity,
                (self.medium, &streaming),
                self.h,
            )
        } else if self.batch.touches(i) {
            body.kick_touching(&contact, &gravity, self.h)
        } else {
            body.kick_alone(&gravity, self.h);
            Flows::default()
        };
        if loaded {
            let mean = (before + body.momentum(masses)) * 0.5;
            flows.load_work += body.pull.dot(&mean) * self.h;
        }
        body.breakable = breakable;
        flows
    }
}

impl World {
    /// The second half of a step: adds the impulse of `h` (s) to all nodes, sets held and driven ones to their velocities at
    /// the end of the step, and books the work. Computes the largest next step while the forces are in the cache. Returns
    /// the kinetic energy, J.
    pub(in crate::world) fn kick_deformables(
        &mut self,
        h: f64,
        streaming: Option<Streaming>,
    ) -> f64 {
        let time = self.time;
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return 0.0;
        };
        let Deformables { models, bodies, .. } = deformables;
        let batch = &self.batch;
        let kick = Kick::new(batch, &self.parameters, streaming, h);
        let results = on_each(bodies, |i, body| {
            if body.is_vacant() || batch.is_guest(i as u32) {
                return Kicked::none();
            }
            let model = &models[body.model as usize].model;
            let mut kicked = Kicked::none();
            if !body.rest.asleep {
                kicked.flows = kick.apply(i, body, model);
                kicked.step = body.largest_step(batch, i as u32);
            }
            kicked.held = body.hold(time, model.masses());
            kicked.energy = body.kinetic_energy(model.masses());
            kicked
        });
        let steps = results.iter().map(|kicked| kicked.step);
        deformables.bound = Some(steps.fold(f64::INFINITY, f64::min));
        for kicked in &results {
            self.book_kick(&kicked.flows);
        }
        for kicked in &results {
            self.flows.work_in += kicked.held;
        }
        results.iter().map(|kicked| kicked.energy).sum()
    }

    pub(super) fn book_kick(&mut self, flows: &Flows) {
        self.flows.damping_work += flows.damping_work;
        self.flows.friction_work += flows.friction_work;
        self.flows.work_in += flows.work_in;
        self.flows.load_work += flows.load_work;
        self.flows.medium_work += flows.medium_work;
    }
}

impl State {
    /// Half a kick of a body without contacts, boundary and medium.
    fn kick_alone(&mut self, gravity: &Vector3, h: f64) {
        let nodes = self.strain_forces.iter().zip(&self.inverse_masses);
        for (v, (force, w)) in self.velocities.iter_mut().zip(nodes) {
            *v += force * (h * w) + gravity * h;
        }
    }

    /// As [`kick`](Self::kick), without boundary and medium.
    fn kick_touching(&mut self, contact: &NodalLoads, gravity: &Vector3, h: f64) -> Flows {
        let mut flows = Flows::default();
        let nodes = self.strain_forces.iter().zip(&self.inverse_masses);
        let parts = contact.damping.iter().zip(contact.friction);
        let forces = contact.forces.iter().zip(parts);
        for ((v, (force, w)), (by_contact, (damping, friction))) in
            self.velocities.iter_mut().zip(nodes).zip(forces)
        {
            let before = *v;
            *v += (force + by_contact) * (h * w) + gravity * h;
            let way = (before + *v) * (0.5 * h);
            flows.damping_work += damping.dot(&way);
            flows.friction_work += friction.dot(&way);
        }
        flows
    }

    /// Half a kick in a medium that moves with the velocity `streaming` (m/s). Works are the forces times the mean of the velocities before and after. Held and driven
    /// components keep their velocity: their support balances all forces, and the medium does not act on
    /// them.
    fn kick(
        &mut self,
        contact: &NodalLoads,
        masses: &[f64],
        gravity: &Vector3,
        (medium, streaming): (&Medium, &Vector3),
        h: f64,
    ) -> Flows {
        let mut flows = Flows::default();
        let mut held = self.boundary.held().peekable();
        let (decay, reach) = relaxation(medium.drag, h);
        for (a, v) in self.velocities.iter_mut().enumerate() {
            let (before, m) = (*v, masses[a]);
            let mut force = self.strain_forces[a] + self.loads[a] + contact.forces[a] + gravity * m;
            if *medium == Medium::default() {
                *v += force * (h / m);
            } else {
                let through = before - streaming;
                let resisted = resist(&force, &through, medium.local_damping);
                *v = streaming + through * decay + resisted * (reach / m);
            }
            while let Some((_, i)) = held.next_if(|&(node, _)| node as usize == a) {
                v[i] = before[i];
                flows.work_in -= force[i] * before[i] * h;
                force[i] = 0.0;
            }
            let way = (before + *v) * (0.5 * h);
            flows.work_in += self.loads[a].dot(&way);
            flows.damping_work += contact.damping[a].dot(&way);
            flows.friction_work += contact.friction[a].dot(&way);
            if *medium != Medium::default() {
                let gained = 0.5 * m * (v.norm_squared() - before.norm_squared());
                flows.medium_work += gained - force.dot(&way);
            }
        }
        flows
    }
}
