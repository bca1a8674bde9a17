//! Deformable bodies in a world that is shared out: see [`ranks`](crate::world::ranks).

use super::{Deformables, Model, State};
use crate::world::World;
use femdem_contact::BodyId;
use femdem_mesh::Vector3;

/// What a tetrahedron costs in a step, ns: the others of the same model cost as much, and contacts are few beside them.
const COST: u64 = 150;

/// Numbers of a node: position and velocity.
const NUMBERS: usize = 6;

impl World {
    /// The deformable bodies that belong to no other rank, with their models.
    pub(in crate::world) fn own_nodes(&self) -> impl Iterator<Item = (BodyId, &State, &Model)> {
        let deformables = self.deformables.as_deref();
        let all = deformables.into_iter().flat_map(|deformables| {
            let states = (0..).zip(&deformables.bodies);
            states.map(|(id, state)| (id, state, &deformables.models[state.model as usize]))
        });
        all.filter(|(id, state, _)| !state.is_vacant() && !self.is_guest(*id))
    }

    /// The state of a deformable body.
    pub(in crate::world) fn nodes_of(&self, id: BodyId) -> Option<&State> {
        let state = self.deformables.as_deref()?.bodies.get(id as usize);
        state.filter(|state| !state.is_vacant())
    }
}

impl Deformables {
    /// The state of a body.
    pub(in crate::world) fn nodes_mut(&mut self, id: BodyId) -> Option<&mut State> {
        let state = self.bodies.get_mut(id as usize);
        state.filter(|state| !state.is_vacant())
    }

    /// Takes the state of a body out.
    pub(in crate::world) fn take(&mut self, id: BodyId) -> Option<State> {
        let state = self.nodes_mut(id)?;
        Some(std::mem::replace(state, State::vacant()))
    }

    /// Makes place for so many numbers, without bodies.
    pub(in crate::world) fn empty(&mut self, count: usize) {
        self.bodies.clear();
        self.reach(count);
        self.bound = None;
    }

    /// Puts the state of a body in.
    pub(in crate::world) fn give(&mut self, id: BodyId, state: State) {
        self.bodies[id as usize] = state;
    }
}

impl Model {
    /// What a body of it costs in a step, ns.
    pub(in crate::world) fn costs(&self) -> u64 {
        COST * self.model.mesh().tets().len() as u64
    }
}

impl State {
    /// The mean of its nodes, m.
    pub(in crate::world) fn middle(&self) -> Vector3 {
        let sum: Vector3 = self.positions.iter().sum();
        sum / self.positions.len().max(1) as f64
    }

    /// Largest distance of a node from their mean, m.
    pub(in crate::world) fn radius(&self) -> f64 {
        let middle = self.middle();
        let far = self.positions.iter().map(|x| (x - middle).norm());
        far.fold(0.0, f64::max)
    }

    /// How many numbers [`add_numbers`](Self::add_numbers) adds.
    pub(in crate::world) fn count_of_numbers(&self) -> usize {
        NUMBERS * self.positions.len()
    }

    /// Adds the positions and the velocities of the nodes: what contacts see of a body elsewhere, 48 bytes a node.
    pub(in crate::world) fn add_numbers(&self, bytes: &mut Vec<u8>) {
        let numbers = self.positions.iter().chain(&self.velocities).flatten();
        bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
    }

    /// Takes over the numbers that were [added](Self::add_numbers) elsewhere.
    pub(in crate::world) fn take_numbers(&mut self, numbers: impl Iterator<Item = f64>) {
        let own = self.positions.iter_mut().chain(&mut self.velocities);
        for (own, number) in own.flatten().zip(numbers) {
            *own = number;
        }
    }

    /// Sets all velocities to zero.
    pub(in crate::world) fn stop(&mut self) {
        self.velocities.fill(Vector3::zeros());
        self.fastest = 0.0;
    }
}
