//! Queries of the deformable bodies of a world.

use super::add::{centroid, held_energy, inverse_masses};
use super::{Model, ModelId, State};
use crate::error::SolveError;
use crate::world::World;
use femdem_contact::deform::DeformableTotals;
use femdem_contact::{BodyId, Contact};
use femdem_fem::element::ElementFailure;
use femdem_fem::material::Material;
use femdem_fem::{Boundary, DeformableModel, ElementStress, InternalState};
use femdem_mesh::Vector3;
use std::sync::Arc;

/// Read access to a deformable body of a world.
#[derive(Debug, Clone, Copy)]
pub struct Deformable<'a> {
    model: &'a Model,
    state: &'a State,
    contact: &'a [Vector3],
}

impl<'a> Deformable<'a> {
    pub(in crate::world) fn own_model(&self) -> &'a Model {
        self.model
    }

    pub(in crate::world) fn state(&self) -> &'a State {
        self.state
    }

    /// Name of its model.
    #[must_use]
    pub fn name(&self) -> &'a str {
        &self.model.name
    }

    /// Index of its model.
    #[must_use]
    pub fn model_id(&self) -> ModelId {
        self.state.model
    }

    /// Its model.
    #[must_use]
    pub fn model(&self) -> &'a DeformableModel {
        &self.model.model
    }

    /// Positions of the nodes, m.
    #[must_use]
    pub fn positions(&self) -> &'a [Vector3] {
        &self.state.positions
    }

    /// Velocities of the nodes, m/s.
    #[must_use]
    pub fn velocities(&self) -> &'a [Vector3] {
        &self.state.velocities
    }

    /// History of the materials.
    #[must_use]
    pub fn history(&self) -> &'a [f64] {
        &self.state.history
    }

    /// The external load, set by [`World::set_load`], N.
    #[must_use]
    pub fn applied_load(&self) -> Vector3 {
        self.state.pull * self.mass()
    }

    /// The boundary conditions.
    #[must_use]
    pub fn boundary(&self) -> &'a Boundary {
        &self.state.boundary
    }

    /// Forces of the contacts on the nodes, N.
    #[must_use]
    pub fn contact_forces(&self) -> &'a [Vector3] {
        self.contact
    }

    /// Forces of the elements on the nodes, N.
    #[must_use]
    pub fn internal_forces(&self) -> &'a [Vector3] {
        &self.state.strain_forces
    }

    /// Loads of the boundary on the nodes, N.
    #[must_use]
    pub fn loads(&self) -> &'a [Vector3] {
        &self.state.loads
    }

    /// Acceleration by the external load, m/s^2.
    pub(in crate::world) fn pull(&self) -> Vector3 {
        self.state.pull
    }

    /// Energies of the elements.
    #[must_use]
    pub fn internal(&self) -> InternalState {
        let state = self.state;
        self.model().with_energy(state.internal, &state.positions)
    }

    /// Mass, kg.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.model().masses().iter().sum()
    }

    /// Centre of mass, m.
    #[must_use]
    pub fn centroid(&self) -> Vector3 {
        centroid(&self.state.positions, self.model().masses())
    }

    /// Linear momentum, kg m/s.
    #[must_use]
    pub fn momentum(&self) -> Vector3 {
        self.state.momentum(self.model().masses())
    }

    /// Angular momentum about a point, kg m^2/s.
    #[must_use]
    pub fn angular_momentum(&self, about: &Vector3) -> Vector3 {
        self.state.angular_momentum(self.model().masses(), about)
    }

    /// Whether it is frozen (see [`SleepParameters::deformables`](crate::SleepParameters::deformables)).
    #[must_use]
    pub fn is_asleep(&self) -> bool {
        self.state.rest.asleep
    }

    /// Kinetic energy, J.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        self.state.kinetic_energy(self.model().masses())
    }

    /// Potential energy in gravity (m/s^2) relative to the origin, J.
    #[must_use]
    pub fn potential(&self, gravity: &Vector3) -> f64 {
        self.state.potential(self.model().masses(), gravity)
    }

    /// Cauchy stress and volume ratio of every element.
    ///
    /// # Errors
    /// [`ElementFailure`] if an element has no stress.
    pub fn stresses(&self) -> Result<Vec<ElementStress>, ElementFailure> {
        self.model()
            .stresses(&self.state.positions, &self.state.history)
    }
}

impl State {
    /// J.
    pub fn kinetic_energy(&self, masses: &[f64]) -> f64 {
        let nodes = self.velocities.iter().zip(masses);
        nodes.map(|(v, m)| 0.5 * m * v.norm_squared()).sum()
    }

    /// kg m/s.
    pub fn momentum(&self, masses: &[f64]) -> Vector3 {
        let nodes = self.velocities.iter().zip(masses);
        nodes.map(|(v, m)| v * *m).sum()
    }

    /// Angular momentum about a point, kg m^2/s.
    pub fn angular_momentum(&self, masses: &[f64], about: &Vector3) -> Vector3 {
        let nodes = self.positions.iter().zip(&self.velocities);
        let nodes = nodes.zip(masses);
        nodes.map(|((x, v), m)| (x - about).cross(v) * *m).sum()
    }

    /// Potential energy in gravity relative to the origin, J.
    pub fn potential(&self, masses: &[f64], gravity: &Vector3) -> f64 {
        let nodes = self.positions.iter().zip(masses);
        nodes.map(|(x, m)| -m * gravity.dot(x)).sum()
    }
}

impl World {
    /// Number of deformable bodies.
    #[must_use]
    pub fn deformable_count(&self) -> usize {
        self.batch.deformable_count()
    }

    /// The deformable bodies, ascending.
    pub fn deformable_ids(&self) -> impl Iterator<Item = BodyId> {
        self.batch.deformable_ids()
    }

    /// A deformable body; `None` for an unknown index.
    #[must_use]
    pub fn deformable(&self, id: BodyId) -> Option<Deformable<'_>> {
        let deformables = self.deformables.as_deref()?;
        let state = deformables.bodies.get(id as usize)?;
        if state.is_vacant() {
            return None;
        }
        Some(Deformable {
            model: deformables.models.get(state.model as usize)?,
            state,
            contact: state.contact_loads(&self.batch, id).forces,
        })
    }

    /// All deformable bodies that belong to no other rank, by index.
    pub fn deformables(&self) -> impl Iterator<Item = Deformable<'_>> {
        let own = self.deformable_ids().filter(|id| !self.is_guest(*id));
        own.filter_map(|i| self.deformable(i))
    }

    /// Contacts of deformable bodies, sorted by pair.
    pub fn deformable_contacts(&self) -> impl Iterator<Item = &Contact> {
        self.batch.deformable_contacts()
    }

    /// Sums over the contacts of deformable bodies.
    #[must_use]
    pub fn deformable_totals(&self) -> Option<&DeformableTotals> {
        self.batch.deformable_totals()
    }

    /// A model of deformable bodies.
    pub fn model(&self, id: ModelId) -> Option<&DeformableModel> {
        let models = &self.deformables.as_deref()?.models;
        Some(&models.get(id as usize)?.model)
    }

    /// Replaces the boundary conditions of a deformable body. The places given to the boundary (see
    /// [`Boundary::drive_from`]) are those before a motion begins. If a motion has already begun, its nodes
    /// jump to where it is now; use [`counted_from`](Boundary::counted_from) with the present time to avoid
    /// that. The change of kinetic energy of its nodes by being held is booked as work.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, or a node that its model does not have.
    pub fn set_boundary(&mut self, id: BodyId, boundary: Boundary) -> Result<(), SolveError> {
        self.known_deformable(id)?;
        self.not_shared("changing conditions of bodies")?;
        if boundary != Boundary::default() {
            self.refuse_adaptive(Some(id), "nodes that are free", "conditions on nodes")?;
        }
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let (model, state) = deformables.parts(id);
        let model = &model.model;
        boundary.check(model)?;
        state.inverse_masses = inverse_masses(model.masses(), &boundary);
        state.held_energy = held_energy(&boundary, model.masses(), &state.velocities);
        state.boundary = boundary;
        state.loads.fill(Vector3::zeros());
        deformables.wake(id as usize, &mut self.batch);
        self.loaded = false;
        Ok(())
    }

    /// Binds custom materials that were read by name to their laws again.
    ///
    /// # Errors
    /// [`FemError::UnboundMaterial`](femdem_fem::FemError::UnboundMaterial) if a law is missing.
    pub fn bind_materials(&mut self, laws: &[Arc<dyn Material>]) -> Result<(), SolveError> {
        for model in self.deformables.iter_mut().flat_map(|d| &mut d.models) {
            model.model.bind(laws)?;
        }
        Ok(())
    }
}
