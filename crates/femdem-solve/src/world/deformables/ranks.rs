//! Deformable bodies in a world that is shared out: see [`ranks`](crate::world::ranks).

use super::{Deformables, Model, ModelId, State};
use crate::error::SolveError;
use crate::world::World;
use femdem_contact::deform::DeformableShape;
use femdem_contact::{BodyId, BodyRecord, ContactBatch};
use femdem_fem::material::AnyMaterial;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What a tetrahedron costs in a step, ns: the others of the same model cost as much, and contacts are few beside them.
const COST: u64 = 150;

/// Numbers of a node: position and velocity.
const NUMBERS: usize = 6;

/// About how many numbers a model has for each tetrahedron.
const NUMBERS_OF_TET: usize = 32;

/// A deformable body as data that travel.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::world) struct Soft {
    pub state: State,
    /// Of one that has cracked, which nothing else has.
    own: Option<Box<OwnModel>>,
}

/// The model of a body alone.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(in crate::world) struct OwnModel {
    model: Model,
    /// Made anew where it comes from elsewhere.
    #[serde(skip)]
    shape: Option<Arc<DeformableShape>>,
}

/// What becomes of a model where bodies are taken out.
pub(in crate::world) enum Kept {
    /// It stays, under this number.
    Shared(ModelId),
    /// It goes with its body.
    Own(Option<Box<OwnModel>>),
}

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

    /// The name of a custom law of a body that may break, or has: models that bodies have alone travel, and custom laws do not.
    pub(in crate::world) fn custom_law_that_breaks(&self) -> Option<&str> {
        let breaks =
            |state: &State, model: &Model| state.breakable.is_some() || model.edge.is_some();
        let mut own = self
            .own_nodes()
            .filter(|(_, state, model)| breaks(state, model));
        own.find_map(|(_, _, model)| {
            let regions = model.model.regions();
            regions.iter().find_map(|region| custom(&region.material))
        })
    }

    /// The number of the tetrahedra of a deformable body.
    pub(in crate::world) fn tets_of(&self, id: BodyId) -> Option<usize> {
        let number = self.nodes_of(id)?.model as usize;
        Some(self.deformables.as_deref()?.models[number].count_of_tets())
    }

    /// The state of a deformable body.
    pub(in crate::world) fn nodes_of(&self, id: BodyId) -> Option<&State> {
        let state = self.deformables.as_deref()?.bodies.get(id as usize);
        state.filter(|state| !state.is_vacant())
    }
}

/// The name of a law from outside.
fn custom(law: &AnyMaterial) -> Option<&str> {
    match law {
        AnyMaterial::Custom(custom) => Some(custom.name()),
        AnyMaterial::Viscous(viscous) => custom(viscous.law()),
        _ => None,
    }
}

impl Deformables {
    /// The state of a body.
    pub(in crate::world) fn nodes_mut(&mut self, id: BodyId) -> Option<&mut State> {
        let state = self.bodies.get_mut(id as usize);
        state.filter(|state| !state.is_vacant())
    }

    /// Takes the models out that are of one body each, and says what has become of all, by their numbers. There are no bodies in the
    /// batch.
    pub(in crate::world) fn take_models(
        &mut self,
        batch: &mut ContactBatch,
    ) -> Result<Vec<Kept>, SolveError> {
        let shapes = batch.deformable_shapes().to_vec();
        let mut kept = Vec::with_capacity(shapes.len());
        for (model, shape) in std::mem::take(&mut self.models).into_iter().zip(shapes) {
            if model.edge.is_some() {
                let shape = Some(shape);
                kept.push(Kept::Own(Some(Box::new(OwnModel { model, shape }))));
            } else {
                kept.push(Kept::Shared(self.models.len() as ModelId));
                self.models.push(model);
            }
        }
        let stays = |index: u32| matches!(kept.get(index as usize), Some(Kept::Shared(_)));
        batch.keep_deformable_shapes(stays)?;
        Ok(kept)
    }

    /// Takes a body out, whose record is given, after its [model](Self::take_models).
    pub(in crate::world) fn take(
        &mut self,
        id: BodyId,
        record: &mut BodyRecord,
        models: &mut [Kept],
    ) -> Option<Soft> {
        let state = self.nodes_mut(id)?;
        let (number, own) = match models.get_mut(state.model as usize)? {
            Kept::Shared(number) => (*number, None),
            Kept::Own(model) => (0, model.take()),
        };
        let mut state = std::mem::replace(state, State::vacant());
        state.model = number;
        record.set_deformable_shape(number);
        Some(Soft { state, own })
    }

    /// Makes place for so many numbers, without bodies.
    pub(in crate::world) fn empty(&mut self, count: usize) {
        self.bodies.clear();
        self.reach(count);
        self.bound = None;
    }

    /// Puts a body in, whose record is given, with the model that it alone has.
    pub(in crate::world) fn give(
        &mut self,
        id: BodyId,
        soft: Soft,
        record: &mut BodyRecord,
        batch: &mut ContactBatch,
    ) -> Result<(), SolveError> {
        let Soft { mut state, own } = soft;
        if let Some(own) = own {
            let OwnModel { model, shape } = *own;
            let shape = match shape {
                Some(shape) => shape,
                None => Arc::new(model.shape()?),
            };
            state.model = batch.add_deformable_shape(shape);
            record.set_deformable_shape(state.model);
            self.models.push(model);
        }
        self.bodies[id as usize] = state;
        Ok(())
    }
}

impl Soft {
    /// How many numbers travel, about.
    pub(in crate::world) fn weight(&self) -> usize {
        let own = self.own.as_deref();
        self.state.count_of_numbers() + own.map_or(0, |own| own.model.weight())
    }

    /// As a guest has it.
    pub(in crate::world) fn as_guest(&mut self) -> Self {
        let state = self.state.as_guest();
        let own = self.own.clone();
        Self { state, own }
    }
}

impl Model {
    /// The number of its tetrahedra.
    pub(in crate::world) fn count_of_tets(&self) -> usize {
        self.model.mesh().tets().len()
    }

    /// About how many numbers it has.
    fn weight(&self) -> usize {
        NUMBERS_OF_TET * self.count_of_tets()
    }

    /// What a body of it costs in a step, ns.
    pub(in crate::world) fn costs(&self) -> u64 {
        COST * self.count_of_tets() as u64
    }
}

impl State {
    /// The mean of its nodes, m.
    pub(in crate::world) fn middle(&self) -> Vector3 {
        let sum: Vector3 = self.positions.iter().sum();
        sum / self.positions.len().max(1) as f64
    }

    /// Whether it has so many nodes, and as many of all that belongs to them.
    pub(super) fn has_nodes(&self, count: usize) -> bool {
        let lengths = [
            self.positions.len(),
            self.velocities.len(),
            self.inverse_masses.len(),
            self.strain_forces.len(),
            self.loads.len(),
        ];
        lengths == [count; 5]
    }

    /// Whether what came can be the state of a guest of a model that it alone has, of so many tetrahedra.
    pub(in crate::world) fn is_of_guest(&self, model: &Model, tets: usize) -> bool {
        let fits = model.edge.is_some() && model.count_of_tets() == tets;
        let nodes = self.has_nodes(model.model.nodes().len());
        fits && nodes && self.breakable.is_none() && self.boundary.check(&model.model).is_ok()
    }

    /// As a guest has it: whether it breaks is its owner's business.
    pub(in crate::world) fn as_guest(&mut self) -> Self {
        let breakable = self.breakable.take();
        let guest = self.clone();
        self.breakable = breakable;
        guest
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::WorldParameters;
    use crate::world::deformables::{ContactStiffness, DeformableSpec};
    use femdem_fem::element::Element;
    use femdem_fem::material::NeoHookean;
    use femdem_fem::{DeformableModel, MaterialRegion};
    use femdem_mesh::{Pose, TetMesh};

    #[test]
    fn what_came_of_a_guest_that_cracked_is_checked() {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let mesh = TetMesh::block([1; 3], &Vector3::repeat(0.1)).unwrap();
        let region = MaterialRegion {
            material: NeoHookean::new(1e6, 0.3).unwrap().into(),
            density: 1000.0,
        };
        let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
        let model = world.add_model("cube", model, ContactStiffness::default());
        let spec = DeformableSpec::at_rest(model.unwrap(), Pose::identity());
        world.add_deformable(spec).unwrap();
        let tets = world.tets_of(0).unwrap();
        let Deformables { models, bodies, .. } = *world.deformables.unwrap();
        let (shared, state) = (&models[0], &bodies[0]);
        let own = Model {
            edge: Some(0.1),
            ..shared.clone()
        };
        assert!(state.is_of_guest(&own, tets));
        assert!(!state.is_of_guest(&own, tets + 1));
        assert!(!state.is_of_guest(shared, tets));
        let shorten: [fn(&mut State); 5] = [
            |state| state.positions.truncate(1),
            |state| state.velocities.truncate(1),
            |state| state.inverse_masses.truncate(1),
            |state| state.strain_forces.truncate(1),
            |state| state.loads.truncate(1),
        ];
        for shorten in shorten {
            let mut state = state.clone();
            shorten(&mut state);
            assert!(!state.is_of_guest(&own, tets));
        }
    }
}
