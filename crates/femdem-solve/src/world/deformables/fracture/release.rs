//! Facets whose sides have nothing to do with each other any more become skin.

use super::CrackState;
use super::query::CrackFacet;
use crate::error::SolveError;
use crate::world::World;
use crate::world::deformables::{CrackedSkin, Deformables, State};
use femdem_contact::BodyId;
use std::sync::Arc;

/// Looks at the stresses between two looks at what is released.
const LOOKS: u64 = 20;

/// Opening over the height of the elements at which a broken facet without pressure is released; and slip over the slip
/// for release at which it is in any case.
const OPENING: f64 = 0.02;
const FORCED: f64 = 3.0;

impl World {
    /// Releases broken facets. Called after each step.
    pub(in crate::world) fn release_cracks(&mut self) -> Result<(), SolveError> {
        let steps = self.steps;
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let mut released = Vec::new();
        for (body, i) in deformables.bodies.iter_mut().zip(0..) {
            if body.breakable.as_ref().is_some_and(|breakable| {
                let due = steps.is_multiple_of(LOOKS * u64::from(breakable.fracture.every));
                due && !body.rest.asleep
            }) && body.release()
            {
                released.push(i);
            }
        }
        if released.is_empty() {
            return Ok(());
        }
        let before = self.stored_in_soft_contacts();
        for id in released {
            self.reshape_cracked(id)?;
        }
        self.book_cracks();
        self.meet_deformables(0.0)?;
        self.flows.cracks.released += before - self.stored_in_soft_contacts();
        Ok(())
    }

    /// Energy of the contacts of deformable bodies and of their friction, J.
    fn stored_in_soft_contacts(&self) -> f64 {
        let totals = self.deformable_totals();
        totals.map_or(0.0, |totals| totals.energy + totals.spring_energy)
    }

    /// Gives a body the skin of the cracks that are released.
    fn reshape_cracked(&mut self, id: BodyId) -> Result<(), SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        deformables.bound = None;
        let Deformables { models, bodies, .. } = deformables;
        let body = &mut bodies[id as usize];
        let Some(breakable) = body.breakable.as_mut() else {
            return Ok(());
        };
        let Some(cracks) = breakable.cracks.as_deref_mut() else {
            return Ok(());
        };
        let points = models[cracks.base as usize].model.mesh().points();
        let skin = cracks.skin.mesh(points)?;
        let shape = self.batch.deformable_shapes()[body.model as usize].cracked(&skin)?;
        let own = body.model;
        models[own as usize].cracked = Some(CrackedSkin {
            base: cracks.base,
            mesh: Some(skin),
        });
        self.batch
            .crack_deformable(id, own, Some(Arc::new(shape)))?;
        cracks.share(models[own as usize].model.masses(), &body.inverse_masses);
        cracks.follow(&body.positions, &body.velocities);
        let model = &models[own as usize];
        let shape = &self.batch.deformable_shapes()[own as usize];
        if let Some(modulus) = self.batch.modulus(id) {
            let masses = body.contact_masses(model.model.masses());
            body.contact_step = model.contact_step(shape, modulus, &masses);
        }
        Ok(())
    }
}

impl State {
    /// Releases the joints that are free; returns whether there were any.
    fn release(&mut self) -> bool {
        let Some(breakable) = self.breakable.as_mut() else {
            return false;
        };
        let slip = breakable.fracture.release;
        let Some(cracks) = breakable.cracks.as_deref_mut() else {
            return false;
        };
        let positions = &self.positions;
        let (mut facets, mut held) = (Vec::new(), 0.0);
        let CrackState {
            joints, released, ..
        } = cracks;
        joints.retain(|joint| {
            let [a, b] = joint.places(positions);
            let limits = [OPENING, slip].map(|part| part * joint.height);
            let law = &joint.law;
            let forced = joint.glued.is_broken(law)
                && joint.glued.largest_slip(&a, &b) > FORCED * slip * joint.height;
            let free = forced || joint.glued.is_free(law, [&a, &b], limits);
            if free {
                facets.push(joint.facet);
                released.push(CrackFacet::of(joint, positions));
                let now = joint.glued.forces(law, &a, &b);
                held += now.glue + now.contact;
            }
            !free
        });
        cracks.stored -= held;
        cracks.flows.released += held;
        cracks.stiffen(positions.len());
        // The facets are those of the mesh.
        !facets.is_empty() && cracks.skin.cut(&facets).is_ok()
    }
}
