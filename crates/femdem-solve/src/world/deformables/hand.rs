//! What a host does with deformable bodies by hand, as with rigid ones.

use super::add::held_energy;
use super::{Deformables, Model, Scratch, State};
use crate::error::{SolveError, check};
use crate::world::World;
use crate::world::time_step::USUAL_MOVE;
use femdem_contact::{BodyId, Partner, Wrench};
use femdem_mesh::Vector3;

impl World {
    /// Forgets the nodes of a body that is being removed, if it is deformable; returns the energy that it had, J.
    pub(in crate::world) fn forget_nodes(&mut self, id: BodyId) -> Option<f64> {
        self.known_deformable(id).ok()?;
        let gravity = self.parameters.gravity;
        let (model, state) = self.deformables.as_deref_mut()?.parts(id);
        let energy = state.energy(model, &gravity);
        *state = State::vacant();
        Some(energy)
    }

    /// Puts the nodes of a deformable body somewhere else (m), with new velocities (m/s). Its contacts end with their
    /// friction; it and what it touched wake. Prescribed nodes stay with their motion, whatever is given for them. Its
    /// materials keep their history, and flow plastically if the new strains make them.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::Parameter`] unless there is one finite position and
    /// velocity for each node, [`SolveError::BodyFailed`] if an element is inverted there. Nothing has changed then.
    pub fn set_nodes(
        &mut self,
        id: BodyId,
        positions: &[Vector3],
        velocities: &[Vector3],
    ) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        self.not_shared("moving bodies by hand")?;
        self.put_nodes(id, [positions, velocities], None)
    }

    /// As [`set_nodes`](Self::set_nodes), with another history of the materials if one is given.
    pub(super) fn put_nodes(
        &mut self,
        id: BodyId,
        nodes: [&[Vector3]; 2],
        history: Option<Vec<f64>>,
    ) -> Result<(), SolveError> {
        let (gravity, time, steps) = (self.parameters.gravity, self.time, self.steps);
        let stored = self.stored_by(Partner::Body(id));
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let (model, state) = deformables.parts(id);
        let mut new = state.clone();
        if let Some(history) = history {
            new.history = history;
        }
        let [positions, velocities] = nodes;
        new.put(model, positions, velocities, time)
            .map_err(|error| error.in_body(id as usize, steps, time))?;
        let flown = new.internal.plastic_work;
        let gained = new.energy(model, &gravity) - state.energy(model, &gravity);
        let broken = new.crack_losses() - state.crack_losses();
        let (fastest, bound) = (new.fastest, new.bound.critical_step().min(new.contact_step));
        *state = new;
        let touched = self.batch.moved_by_hand(id)?;
        deformables.wake(id as usize, &mut self.batch);
        let model = deformables.bodies[id as usize].model;
        let depth = self.batch.deformable_shapes()[model as usize].inradius();
        self.flows.by_hand += gained + flown + broken;
        self.flows.plastic_work -= flown;
        self.newcomers.moved.bodies.insert(id);
        self.step_control.lose();
        self.step_control.see_elements(bound);
        self.step_control.see_launch(USUAL_MOVE * depth / fastest);
        self.book_ended(stored, &touched);
        Ok(())
    }

    /// Loads a deformable body with a force (N) in world axes.
    pub(in crate::world) fn pull_deformable(
        &mut self,
        id: BodyId,
        load: &Wrench,
    ) -> Result<(), SolveError> {
        let torque = load.torque.norm();
        check(
            "torque",
            torque,
            torque == 0.0,
            "0 N m for a deformable body: give forces on its nodes by its boundary",
        )?;
        if let Some(deformables) = self.deformables.as_deref_mut() {
            let (model, state) = deformables.parts(id);
            let pull = load.force / model.model.masses().iter().sum::<f64>();
            if state.pull != pull {
                state.pull = pull;
                deformables.wake(id as usize, &mut self.batch);
            }
        }
        Ok(())
    }

    /// Sets whether a deformable body may touch itself, as one that folds does; else its parts pass through each other. The
    /// body wakes if this changes. Initially it may.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, and those of [`World::step`] for the contacts.
    pub fn set_self_contact(&mut self, id: BodyId, on: bool) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        self.not_shared("changing contacts of bodies with themselves")?;
        if !on {
            self.refuse_adaptive(
                Some(id),
                "to touch itself once it has cracked",
                "no such contacts",
            )?;
        }
        if self.batch.self_contact(id) == on {
            return Ok(());
        }
        let stored = self.stored_within(id);
        let is_new = self.newcomers.has(Partner::Body(id));
        self.batch.set_self_contact(id, on)?;
        self.book_ended(stored, &[id]);
        if on && !is_new {
            // Where its parts lie in each other, they bring energy.
            self.evaluate_if_due()?;
            self.flows.by_hand += self.stored_within(id).elastic;
        }
        Ok(())
    }

    /// Whether a deformable body may touch itself; `false` for one that does not exist.
    #[must_use]
    pub fn self_contact(&self, id: BodyId) -> bool {
        self.batch.self_contact(id)
    }

    pub(in crate::world) fn known_deformable(&self, id: BodyId) -> Result<(), SolveError> {
        if self.batch.is_deformable(id) {
            return Ok(());
        }
        Err(SolveError::NoSuch {
            what: "deformable body",
            index: id as usize,
            count: self.deformable_count(),
        })
    }
}

impl Deformables {
    /// The model and the state of a body that is there.
    pub(in crate::world) fn parts(&mut self, id: BodyId) -> (&Model, &mut State) {
        let state = &mut self.bodies[id as usize];
        (&self.models[state.model as usize], state)
    }
}

impl State {
    /// Kinetic energy, potential energy in gravity (m/s^2), strain energy and that of cracks, J.
    fn energy(&self, model: &Model, gravity: &Vector3) -> f64 {
        let masses = model.model.masses();
        let strain = model.model.with_energy(self.internal, &self.positions);
        let cracks = self.cracks().map_or(0.0, |cracks| cracks.stored);
        self.kinetic_energy(masses) + self.potential(masses, gravity) + strain.energy + cracks
    }

    /// What its cracks have dissipated that is not booked yet, J.
    fn crack_losses(&self) -> f64 {
        self.cracks()
            .map_or(0.0, |cracks| cracks.flows.glue + cracks.flows.friction)
    }

    /// Takes over nodal values.
    pub(super) fn put(
        &mut self,
        model: &Model,
        positions: &[Vector3],
        velocities: &[Vector3],
        time: f64,
    ) -> Result<(), SolveError> {
        let nodes = self.positions.len();
        for (name, values) in [("positions", positions), ("velocities", velocities)] {
            let count = values.len();
            check(name, count as f64, count == nodes, "one for each node")?;
            let sum: f64 = values.iter().map(Vector3::norm).sum();
            check(name, sum, true, "finite in every component")?;
        }
        self.positions.copy_from_slice(positions);
        self.velocities.copy_from_slice(velocities);
        let Self {
            positions,
            velocities,
            ..
        } = self;
        self.boundary.for_held(time, |a, i, place, velocity| {
            positions[a][i] = place;
            velocities[a][i] = velocity;
        });
        let masses = model.model.masses();
        self.held_energy = held_energy(&self.boundary, masses, &self.velocities);
        self.fastest = self
            .velocities
            .iter()
            .map(Vector3::norm)
            .fold(0.0, f64::max);
        self.strain(&model.model, &mut Scratch::default(), time, true)
    }

    /// What stands for a number that is not a deformable body's.
    pub(in crate::world) fn vacant() -> Self {
        Self {
            contact_step: f64::INFINITY,
            rest: super::rest::Rest::of_none(),
            ..Self::default()
        }
    }

    /// Whether its number is not a deformable body's.
    pub(in crate::world) fn is_vacant(&self) -> bool {
        self.positions.is_empty()
    }
}
