//! What a host does with deformable bodies by hand, as with rigid ones.

use super::add::held_energy;
use super::{DeformableId, Deformables, Model, Scratch, State};
use crate::error::{SolveError, check};
use crate::world::World;
use crate::world::time_step::USUAL_MOVE;
use femdem_contact::deform::DeformablePartner;
use femdem_mesh::Vector3;

impl World {
    /// Removes a deformable body and its contacts. What it touched wakes. The index is given to the next deformable body
    /// that is added, unless a lower one is free; until then it names none.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body.
    pub fn remove_deformable(&mut self, id: DeformableId) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        let gravity = self.parameters.gravity;
        let stored = self.stored_softly_by(DeformablePartner::Deformable(id));
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let touched = deformables.batch.remove_body(id)?;
        let touched = deformables.let_go(touched, &self.batch);
        let (model, state) = deformables.parts(id);
        self.flows.by_hand -= state.energy(model, &gravity);
        state.vacate();
        self.newcomers.forget_deformable(id);
        self.step_control.lose();
        self.book_ended(stored, &touched);
        Ok(())
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
        id: DeformableId,
        positions: &[Vector3],
        velocities: &[Vector3],
    ) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        self.put_nodes(id, [positions, velocities], None)
    }

    /// As [`set_nodes`](Self::set_nodes), with another history of the materials if one is given.
    pub(super) fn put_nodes(
        &mut self,
        id: DeformableId,
        nodes: [&[Vector3]; 2],
        history: Option<Vec<f64>>,
    ) -> Result<(), SolveError> {
        let (gravity, time, steps) = (self.parameters.gravity, self.time, self.steps);
        let stored = self.stored_softly_by(DeformablePartner::Deformable(id));
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
        let (fastest, bound) = (new.fastest, new.bound.critical_step().min(new.contact_step));
        *state = new;
        let touched = deformables.batch.moved_by_hand(id)?;
        let touched = deformables.let_go(touched, &self.batch);
        deformables.wake(id as usize);
        let model = deformables.bodies[id as usize].model;
        let depth = deformables.batch.shapes()[model as usize].inradius();
        self.flows.by_hand += gained + flown;
        self.flows.plastic_work -= flown;
        self.newcomers.moved.deformables.insert(id);
        self.step_control.lose();
        self.step_control.see_elements(bound);
        self.step_control.see_launch(USUAL_MOVE * depth / fastest);
        self.book_ended(stored, &touched);
        Ok(())
    }

    /// Loads a deformable body with a force (N) in world axes, distributed by mass as gravity is, until it is changed. The
    /// body wakes if the force changes. The work is [`Ledger::load_work`](crate::Ledger::load_work). Forces on a part of a
    /// body are conditions of its [boundary](World::set_boundary).
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::Parameter`] for a force that is not finite.
    pub fn set_deformable_load(
        &mut self,
        id: DeformableId,
        force: Vector3,
    ) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        check("force", force.norm(), true, "finite, in N")?;
        if let Some(deformables) = self.deformables.as_deref_mut() {
            let (model, state) = deformables.parts(id);
            let pull = force / model.model.masses().iter().sum::<f64>();
            if state.pull != pull {
                state.pull = pull;
                deformables.wake(id as usize);
            }
        }
        Ok(())
    }

    /// Sets whether a deformable body may touch itself, as one that folds does; else its parts pass through each other. The
    /// body wakes if this changes. Initially it may.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, and those of [`World::step`] for the contacts.
    pub fn set_self_contact(&mut self, id: DeformableId, on: bool) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.restored()?;
        let stored = self.stored_within(id);
        let is_new = self.newcomers.has_deformable(id);
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        if deformables.batch.self_contact(id) == on {
            return Ok(());
        }
        deformables.batch.set_self_contact(id, on)?;
        deformables.wake(id as usize);
        self.book_ended(stored, &[]);
        if on && !is_new {
            // Where its parts lie in each other, they bring energy.
            self.evaluate_if_due()?;
            self.flows.by_hand += self.stored_within(id).elastic;
        }
        Ok(())
    }

    /// Whether a deformable body may touch itself; `false` for one that does not exist.
    #[must_use]
    pub fn self_contact(&self, id: DeformableId) -> bool {
        let deformables = self.deformables.as_deref();
        deformables.is_some_and(|d| d.batch.self_contact(id))
    }

    pub(super) fn known_deformable(&self, id: DeformableId) -> Result<(), SolveError> {
        let deformables = self.deformables.as_deref();
        if deformables.is_some_and(|d| d.batch.contains(id)) {
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
    pub(super) fn parts(&mut self, id: DeformableId) -> (&Model, &mut State) {
        let state = &mut self.bodies[id as usize];
        (&self.models[state.model as usize], state)
    }
}

impl State {
    /// Kinetic energy, potential energy in gravity (m/s^2) and strain energy, J.
    fn energy(&self, model: &Model, gravity: &Vector3) -> f64 {
        let masses = model.model.masses();
        let strain = model.model.with_energy(self.internal, &self.positions);
        self.kinetic_energy(masses) + self.potential(masses, gravity) + strain.energy
    }

    /// Takes over nodal values.
    fn put(
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

    /// Leaves nothing but the number of a body that has been removed.
    fn vacate(&mut self) {
        *self = Self {
            model: self.model,
            contact_step: f64::INFINITY,
            rest: super::rest::Rest::of_removed(),
            ..Self::default()
        };
    }

    /// Whether the body was removed.
    pub(in crate::world) fn is_vacant(&self) -> bool {
        self.positions.is_empty()
    }
}
