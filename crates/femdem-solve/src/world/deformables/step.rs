//! Kick, drift and forces of the deformable bodies.

use super::each::{on_each, on_each_with};
use super::kick::Kick;
use super::{Deformables, RENEW, Scratch, State};
use crate::error::SolveError;
use crate::ledger::Flows;
use crate::world::World;
use crate::world::periodic::Streaming;
use crate::world::ranks::Share;
use crate::world::time_step::LARGEST_MOVE;
use crate::world::time_step::USUAL_MOVE;
use femdem_contact::deform::NodalState;
use femdem_contact::{BodyId, ContactBatch, stable_step};
use femdem_fem::element::ElementFailure;
use femdem_fem::{DeformableModel, InternalState};
use femdem_mesh::Vector3;

impl World {
    /// The largest step that is stable for the deformable bodies with their contacts, s; infinite
    /// without any.
    pub(in crate::world) fn deformable_bound(&self) -> f64 {
        let Some(deformables) = self.deformables.as_deref() else {
            return f64::INFINITY;
        };
        if let Some(bound) = deformables.bound {
            return bound;
        }
        // Before the first kick, and after bodies have woken.
        let bodies = (0..).zip(&deformables.bodies);
        let awake = bodies.filter(|(i, body)| !(body.rest.asleep || self.is_guest(*i)));
        let steps = awake.map(|(i, body)| body.largest_step(&self.batch, i));
        steps.fold(f64::INFINITY, f64::min)
    }

    /// The first half of a step, up to the present time: kick, drift, and the forces of the elements. Done
    /// body by body, so that each is read from memory once.
    pub(in crate::world) fn advance_deformables(
        &mut self,
        dt: f64,
        streaming: Option<Streaming>,
    ) -> Result<(), SolveError> {
        let (time, steps, renew) = (self.time, self.steps, self.renews_bounds());
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let Deformables { models, bodies, .. } = deformables;
        let share = self.share.as_deref();
        let (batch, is_shared) = (&self.batch, share.is_some_and(Share::is_of_many));
        let kick = Kick::new(batch, &self.parameters, streaming, 0.5 * dt);
        let results = on_each_with(bodies, Scratch::default, |scratch, i, body| {
            if body.rest.asleep || batch.is_guest(i as BodyId) {
                return (Flows::default(), Ok(InternalState::default()));
            }
            let model = &models[body.model as usize].model;
            body.aim(dt, time);
            let flows = kick.apply(i, body, model);
            body.drift(dt, time);
            let depth = batch.deformable_shapes()[body.model as usize].inradius();
            let strain = body.strain(model, scratch, time, renew);
            let checked = strain.and_then(|()| body.check_speed(dt, time, depth, is_shared));
            (flows, checked.map(|()| body.internal))
        });
        for (body, (flows, strain)) in results.into_iter().enumerate() {
            self.book_kick(&flows);
            let internal = strain.map_err(|e| e.in_body(self.named(body), steps, time))?;
            self.book_strain(&internal, dt);
        }
        self.book_cracks();
        Ok(())
    }

    /// The number in the whole of a body.
    pub(super) fn named(&self, body: usize) -> usize {
        let share = self.share.as_deref();
        share.map_or(body, |share| share.named(body))
    }

    /// Forces of the elements at the present positions. `dt` is the time since the last call.
    pub(in crate::world) fn strain_deformables(&mut self, dt: f64) -> Result<(), SolveError> {
        let (time, steps, renew) = (self.time, self.steps, self.renews_bounds());
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let Deformables { models, bodies, .. } = deformables;
        let batch = &self.batch;
        let results = on_each_with(bodies, Scratch::default, |scratch, i, body| {
            if body.is_vacant() || batch.is_guest(i as BodyId) {
                return Ok(InternalState::default());
            }
            let model = &models[body.model as usize].model;
            let strain = body.strain(model, scratch, time, renew);
            strain.map(|()| body.internal)
        });
        for (body, strain) in results.into_iter().enumerate() {
            let internal = strain.map_err(|e| e.in_body(self.named(body), steps, time))?;
            self.book_strain(&internal, dt);
        }
        self.book_cracks();
        Ok(())
    }

    /// Books what the material of a body took in `dt` (s).
    fn book_strain(&mut self, internal: &InternalState, dt: f64) {
        self.flows.viscous_work -= internal.viscous_power * dt;
        self.flows.plastic_work -= internal.plastic_work;
    }

    fn renews_bounds(&self) -> bool {
        self.steps.is_multiple_of(RENEW) || !self.loaded
    }

    /// Forces of the contacts at the present positions. `dt` is the time since the last call.
    pub(in crate::world) fn touch_deformables(&mut self, dt: f64) -> Result<(), SolveError> {
        let renew = self.renews_bounds();
        self.meet_deformables(dt)?;
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        if renew && dt > 0.0 {
            deformables.adapt(&self.batch, dt)?;
        }
        self.wake_touched();
        Ok(())
    }

    /// Evaluates the contacts of the deformable bodies. `dt` is the time since the last call.
    pub(in crate::world) fn meet_deformables(&mut self, dt: f64) -> Result<(), SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        deformables.bound = None;
        let nodes: Vec<NodalState> = deformables.bodies.iter().map(State::nodes).collect();
        let (bodies, walls) = (&self.motions, &self.wall_motions);
        let updated = self.batch.update_deformables(&nodes, bodies, walls, dt);
        updated.map_err(|error| error.with_bodies(|body| self.named(body)))?;
        self.map_cracks();
        Ok(())
    }

    /// Wakes rigid bodies that touch an awake deformable one; they do not count as quiet meanwhile.
    fn wake_touched(&mut self) {
        let mut touched = self.batch.rigid_beside_awake();
        touched.retain(|&i| !(self.batch.is_awake(i) || self.is_guest(i)));
        self.wake(&touched);
    }
}

impl Deformables {
    /// The step, s, in which no node moves by more than [`USUAL_MOVE`] times the depth of its body, relative
    /// to what it may meet. `met(x, r)` is the largest speed, m/s, of driven walls and bodies that may be met
    /// within `r` (m) of `x` (m).
    pub(in crate::world) fn usual_step(
        &self,
        batch: &ContactBatch,
        met: impl Fn(&Vector3, f64) -> f64,
    ) -> f64 {
        let own = (0..).zip(&self.bodies);
        let own = own.filter(|(i, body)| !(body.is_vacant() || batch.is_guest(*i)));
        let bodies = own.map(|(_, body)| {
            let shape = &batch.deformable_shapes()[body.model as usize];
            let centre = body.positions[0];
            let speed = body.fastest + met(&centre, 2.0 * shape.radius());
            USUAL_MOVE * shape.inradius() / speed
        });
        bodies.fold(f64::INFINITY, f64::min)
    }

    /// Updates the bounds of the step for the present contacts, for steps of `dt` (s).
    fn adapt(&mut self, batch: &ContactBatch, dt: f64) -> Result<(), SolveError> {
        let models = &self.models;
        let each = on_each(&mut self.bodies, |i, body| {
            if body.rest.asleep || batch.is_guest(i as BodyId) {
                return Ok(());
            }
            let model = &models[body.model as usize].model;
            body.adapt(model, batch, i as u32, dt)
        });
        Ok(each.into_iter().collect::<Result<(), _>>()?)
    }
}

impl State {
    /// What the contact stage sees.
    pub(super) fn nodes(&self) -> NodalState<'_> {
        NodalState {
            positions: &self.positions,
            velocities: &self.velocities,
            inverse_masses: &self.inverse_masses,
        }
    }

    /// The largest step that is stable for body `i` with its contacts, s.
    pub(super) fn largest_step(&self, batch: &ContactBatch, i: BodyId) -> f64 {
        if !batch.touches(i) && self.cracks().is_none() {
            return self.bound.critical_step();
        }
        // The squared frequencies of elements and contacts add at most, even where they act on different
        // motions.
        let loads = self.contact_loads(batch, i);
        let stiffness = loads.stiffness.iter().zip(&self.inverse_masses);
        let contact = stiffness.map(|(k, w)| 2.0 * k * w).fold(0.0, f64::max);
        let rate = loads.rates.iter().copied().fold(0.0, f64::max);
        let apart = stable_step(
            self.bound.frequency2 + contact,
            self.bound.viscous_rate + rate,
        );
        apart.max(self.nodal.step(&self.bound, self.contact(batch, i)))
    }

    /// Stiffness over mass of the nodes of body `i` due to its contacts, 1/s^2, and their damping rates, 1/s.
    fn contact<'a>(
        &'a self,
        batch: &'a ContactBatch,
        i: BodyId,
    ) -> impl Fn(usize) -> (f64, f64) + 'a {
        let loads = self.contact_loads(batch, i);
        move |a| {
            let stiffness = 2.0 * loads.stiffness[a] * self.inverse_masses[a];
            (stiffness, loads.rates[a])
        }
    }

    /// Updates the bound by nodes for the contacts of body `i`, for steps of `dt` (s).
    fn adapt(
        &mut self,
        model: &DeformableModel,
        batch: &ContactBatch,
        i: BodyId,
        dt: f64,
    ) -> Result<(), ElementFailure> {
        if !batch.touches(i) && self.cracks().is_none() {
            return Ok(());
        }
        let mut nodal = std::mem::take(&mut self.nodal);
        let adapted = nodal.adapt(model, &self.bound, self.contact(batch, i), dt);
        self.nodal = nodal;
        adapted
    }

    /// Forces of the elements and of the boundary; the history advances.
    pub(super) fn strain(
        &mut self,
        model: &DeformableModel,
        scratch: &mut Scratch,
        time: f64,
        renew: bool,
    ) -> Result<(), SolveError> {
        scratch.history.resize(self.history.len(), 0.0);
        self.internal = model.forces_without_energy(
            &self.positions,
            &self.velocities,
            &self.history,
            &mut scratch.history,
            &mut self.strain_forces,
            &mut scratch.work,
        )?;
        std::mem::swap(&mut self.history, &mut scratch.history);
        if !self.boundary.is_free() {
            self.loads.fill(Vector3::zeros());
            self.boundary
                .add_forces(model, time, &self.positions, &mut self.loads)?;
        }
        self.join_cracks(time, renew);
        if renew {
            self.bound = model.stable_frequency2(&self.positions, &self.history)?;
        }
        Ok(())
    }

    /// Sets prescribed components to their mean velocity towards their places at time `end`: both halves of
    /// the step then book the work along that path.
    fn aim(&mut self, dt: f64, end: f64) {
        let (positions, velocities) = (&self.positions, &mut self.velocities);
        self.boundary.for_held(end, |a, i, place, _| {
            velocities[a][i] = (place - positions[a][i]) / dt;
        });
    }

    /// Moves the nodes; prescribed ones go to their places at time `end`.
    fn drift(&mut self, dt: f64, end: f64) {
        let Self {
            positions,
            velocities,
            ..
        } = self;
        let mut fastest2 = 0.0_f64;
        for (x, v) in positions.iter_mut().zip(velocities.iter()) {
            *x += v * dt;
            // A plain comparison: f64::max also handles NaN.
            let speed2 = v.norm_squared();
            fastest2 = if speed2 > fastest2 { speed2 } else { fastest2 };
        }
        self.fastest = fastest2.sqrt();
        self.boundary
            .for_held(end, |a, i, place, _| self.positions[a][i] = place);
    }

    /// Refuses a step that has moved a node far over the depth of the body (m): it may have passed something
    /// unnoticed. Prescribed motions may be as fast as they like, but not over ranks, which have to know what is near.
    fn check_speed(
        &self,
        dt: f64,
        end: f64,
        depth: f64,
        is_shared: bool,
    ) -> Result<(), SolveError> {
        let moves = self.fastest * dt / depth;
        if moves <= LARGEST_MOVE || (!is_shared && self.boundary.is_driven(end - dt, dt)) {
            return Ok(());
        }
        Err(SolveError::Fem(
            ElementFailure::TooFast {
                speed: self.fastest,
                moves,
                step: LARGEST_MOVE * depth / self.fastest,
            }
            .into(),
        ))
    }

    /// Velocities of prescribed nodes at time `time`; returns the kinetic energy that they gained
    /// since the last call, J.
    pub(super) fn hold(&mut self, time: f64, masses: &[f64]) -> f64 {
        let mut energy = 0.0;
        let velocities = &mut self.velocities;
        self.boundary.for_held(time, |a, i, _, velocity| {
            velocities[a][i] = velocity;
            energy += 0.5 * masses[a] * velocity * velocity;
        });
        let gained = energy - self.held_energy;
        self.held_energy = energy;
        gained
    }
}
