//! Facets whose sides have nothing to do with each other any more become skin.

use super::CrackState;
use super::facet::CrackFacet;
use super::joints::Joint;
use crate::error::SolveError;
use crate::world::World;
use crate::world::deformables::{CrackedSkin, Deformables, State};
use femdem_contact::BodyId;
use femdem_mesh::Vector3;
use std::sync::Arc;

/// Looks at the stresses between two looks at what is released.
const LOOKS: u64 = 4;

/// Opening over the height of the elements at which a broken facet without pressure is released.
const OPENING: f64 = 0.02;

/// Slip over the slip for release at which a broken facet is released under pressure too: its sides no longer lie on each other.
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
            self.reshape_cracked(id, true)?;
        }
        self.book_cracks();
        self.meet_deformables(0.0)?;
        self.flows.cracks.released += before - self.stored_in_soft_contacts();
        Ok(())
    }

    /// Energy of the contacts of deformable bodies, J. What friction springs lose is booked as friction.
    fn stored_in_soft_contacts(&self) -> f64 {
        let totals = self.deformable_totals();
        totals.map_or(0.0, |totals| totals.energy)
    }

    /// Gives a body the contact mesh of its cracks; with new skin, if any was released.
    pub(super) fn reshape_cracked(&mut self, id: BodyId, released: bool) -> Result<(), SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        deformables.bound = None;
        let Deformables { models, bodies, .. } = deformables;
        let body = &mut bodies[id as usize];
        let own = body.model;
        let Some(cracks) = body.cracks() else {
            return Ok(());
        };
        let old = &self.batch.deformable_shapes()[own as usize];
        let nodes = cracks.mesh.tets();
        let count = cracks.mesh.points().len();
        let shape = if released {
            let points = models[cracks.base as usize].model.mesh().points();
            let skin = cracks.skin.mesh(points)?;
            let shape = old.cracked(&skin, nodes, count)?;
            models[own as usize].cracked = Some(CrackedSkin {
                base: cracks.base,
                mesh: Some(skin),
            });
            shape
        } else {
            old.renumbered(nodes, count)?
        };
        self.batch
            .crack_deformable(id, own, Some(Arc::new(shape)))?;
        let model = &models[own as usize];
        let shape = &self.batch.deformable_shapes()[own as usize];
        if let Some(modulus) = self.batch.modulus(id) {
            body.contact_step = model.contact_step(shape, modulus);
        }
        Ok(())
    }
}

impl State {
    /// Releases the joints that are free; returns whether there were any. A facet whose nodes others still hold together all
    /// around would not become skin: it keeps its joint.
    fn release(&mut self) -> bool {
        let Self {
            breakable,
            positions,
            strain_forces,
            ..
        } = self;
        let Some(breakable) = breakable.as_deref_mut() else {
            return false;
        };
        let slip = breakable.fracture.release;
        let Some(cracks) = breakable.cracks.as_deref_mut() else {
            return false;
        };
        let mut facets = cracks.free(positions, slip);
        let skin = loop {
            if facets.is_empty() {
                return false;
            }
            let mut skin = cracks.skin.clone();
            // The facets are those of the mesh.
            let cut = skin.cut(&facets);
            debug_assert!(cut.is_ok(), "facets of this mesh");
            let before = facets.len();
            facets.retain(|facet| skin.sides(*facet).is_some_and(|[a, b]| a != b));
            if facets.len() == before {
                break skin;
            }
        };
        cracks.skin = skin;
        let CrackState {
            joints,
            released,
            stored,
            flows,
            ..
        } = cracks;
        joints.retain(|joint| {
            let is_free = facets.binary_search(&joint.facet).is_ok();
            if is_free {
                released.push(CrackFacet::of(joint, positions));
                let now = joint.forces(positions);
                *stored -= now.glue + now.contact;
                flows.released += now.glue + now.contact;
                // The contacts have them from now on.
                joint.add(&now, -1.0, strain_forces);
            }
            !is_free
        });
        cracks.stiffen(positions.len());
        true
    }
}

impl CrackState {
    /// The facets that nothing holds any more and that are open, or have slid far, ascending.
    fn free(&self, positions: &[Vector3], slip: f64) -> Vec<u32> {
        let is_free = |joint: &&Joint| {
            let [a, b] = joint.places(positions);
            let limits = [OPENING, slip].map(|part| part * joint.height);
            let law = &joint.law;
            let far = joint.end.is_some()
                && joint.glued.largest_slip(&a, &b) > FORCED * slip * joint.height;
            far || joint.glued.is_free(law, [&a, &b], limits)
        };
        let free = self.joints.iter().filter(is_free);
        let mut facets: Vec<u32> = free.map(|joint| joint.facet).collect();
        facets.sort_unstable();
        facets
    }
}
