//! The contacts of a body whose cracks have grown.

use crate::error::SolveError;
use crate::world::World;
use crate::world::deformables::Deformables;
use femdem_contact::BodyId;
use std::sync::Arc;

impl World {
    /// Energy of the contacts of deformable bodies, J. What friction springs lose is booked as friction.
    pub(super) fn stored_in_soft_contacts(&self) -> f64 {
        let totals = self.deformable_totals();
        totals.map_or(0.0, |totals| totals.energy)
    }

    /// Gives a body the contact mesh of its cracks.
    pub(super) fn reshape_cracked(&mut self, id: BodyId) -> Result<(), SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        deformables.bound = None;
        let Deformables { models, bodies, .. } = deformables;
        let body = &mut bodies[id as usize];
        let own = body.model;
        let model = &models[own as usize];
        let shape = model.shape()?;
        self.batch
            .crack_deformable(id, own, Some(Arc::new(shape)))?;
        let shape = &self.batch.deformable_shapes()[own as usize];
        if let Some(modulus) = self.batch.modulus(id) {
            body.contact_step = model.contact_step(shape, modulus);
        }
        Ok(())
    }
}
