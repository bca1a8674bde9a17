//! Where and when cracks open.

use super::cracks::CrackState;
use super::joints::{Joint, in_axes};
use crate::error::SolveError;
use crate::world::World;
use crate::world::deformables::add::{held_energy, inverse_masses};
use crate::world::deformables::each::on_each_with;
use crate::world::deformables::nodal_bound::NodalBound;
use crate::world::deformables::rest::Rest;
use crate::world::deformables::{CrackedSkin, Deformables, Model, Scratch, State, foundation};
use femdem_contact::deform::{Modulus, NodalLoads};
use femdem_contact::glue::{GlueLaw, GluedFacet};
use femdem_contact::{BodyId, ContactBatch};
use femdem_fem::fracture::{Cut, Decision, NodalDecision};
use femdem_fem::{DeformableModel, ElementStress};
use femdem_mesh::tet::CrackedMesh;
use femdem_mesh::{Matrix3, Vector3};
use std::borrow::Cow;
use std::sync::Arc;

/// A body that has just cracked, or cracked further.
struct Cracked {
    model: DeformableModel,
    /// Whether it was whole before.
    is_first: bool,
}

impl World {
    /// Looks at the stresses of the bodies that may break, and splits nodes where they exceed the strength. Called after each
    /// step.
    pub(in crate::world) fn crack_deformables(&mut self) -> Result<(), SolveError> {
        let (time, steps) = (self.time, self.steps);
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        let Deformables { models, bodies, .. } = &mut *deformables;
        let batch = &self.batch;
        let looks = on_each_with(bodies, Scratch::default, |scratch, i, body| {
            let due = body.breakable.as_ref().is_some_and(|breakable| {
                let stressed = body.bound.strain >= breakable.harmless;
                let due = steps.is_multiple_of(u64::from(breakable.fracture.every));
                due && stressed && !body.rest.asleep
            });
            if !due {
                return Ok(None);
            }
            let model = &models[body.model as usize];
            let base = body.cracks().map_or(body.model, |cracks| cracks.base);
            let shape = &batch.deformable_shapes()[body.model as usize];
            let modulus = batch.modulus(i as BodyId).unwrap_or(Modulus::Penalty(0.0));
            let material = batch.material(i as BodyId).unwrap_or_default();
            let contact = batch.laws().between([material; 2]);
            let faces = Faces {
                young: model.young,
                pressure: 2.0 * foundation(shape, modulus),
                tangential: contact.tangential_ratio,
                friction: contact.friction,
            };
            let whole = &models[base as usize].model;
            body.look(whole, &model.model, &faces, time, scratch)
        });
        let mut any = false;
        for (i, look) in looks.into_iter().enumerate() {
            let cracked = look.map_err(|error| error.in_body(i, steps, time))?;
            if let Some(cracked) = cracked {
                any = true;
                self.crack(i as BodyId, cracked)?;
            }
        }
        if any {
            self.book_cracks();
            self.map_cracks();
        }
        Ok(())
    }

    /// Gives a body the model of its cracks.
    fn crack(&mut self, id: BodyId, cracked: Cracked) -> Result<(), SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        deformables.bound = None;
        let number = deformables.bodies[id as usize].model;
        if !cracked.is_first {
            deformables.models[number as usize].model = cracked.model;
            return Ok(());
        }
        let old = &deformables.models[number as usize];
        let new = Model {
            name: old.name.clone(),
            model: cracked.model,
            stiffness: old.stiffness,
            field: old.field,
            young: old.young,
            cracked: Some(CrackedSkin {
                base: number,
                mesh: None,
            }),
        };
        let shape = Arc::clone(&self.batch.deformable_shapes()[number as usize]);
        deformables.models.push(new);
        let own = self.batch.add_deformable_shape(shape);
        deformables.bodies[id as usize].model = own;
        Ok(self.batch.crack_deformable(id, own, None)?)
    }

    /// Books what cracks exchanged since the last call.
    pub(in crate::world) fn book_cracks(&mut self) {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return;
        };
        for body in &mut deformables.bodies {
            if let Some(cracks) = body.cracks_mut() {
                self.flows.cracks += std::mem::take(&mut cracks.flows);
            }
        }
    }

    /// Takes the forces of the contacts over to the nodes of cracked bodies.
    pub(in crate::world) fn map_cracks(&mut self) {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return;
        };
        for (body, i) in deformables.bodies.iter_mut().zip(0..) {
            if let Some(cracks) = body.cracks_mut() {
                cracks.take(&self.batch.nodal_loads(i));
            }
        }
    }
}

/// What the faces of a crack have of the body.
struct Faces {
    /// Young's modulus, Pa.
    young: f64,
    /// Stiffness of their contact, Pa/m, of friction over that, and the coefficient of friction.
    pressure: f64,
    tangential: f64,
    friction: f64,
}

impl State {
    /// Looks at the stresses, and cracks if they exceed the strength. `whole` is the model without cracks.
    fn look(
        &mut self,
        whole: &DeformableModel,
        model: &DeformableModel,
        faces: &Faces,
        time: f64,
        scratch: &mut Scratch,
    ) -> Result<Option<Cracked>, SolveError> {
        let Some(mut breakable) = self.breakable.take() else {
            return Ok(None);
        };
        let stresses = model.stresses(&self.positions, &self.history)?;
        let is_first = breakable.cracks.is_none();
        let base = self.model;
        let mut cracks = breakable
            .cracks
            .take()
            .unwrap_or_else(|| Box::new(CrackState::new(base, CrackedMesh::new(whole.mesh()))));
        let decision = NodalDecision {
            strength: &breakable.fracture.strength,
            factors: &breakable.factors,
            positions: &self.positions,
            stresses: &stresses,
            volumes: model.volumes(),
        };
        let found = decision.decide(&mut cracks.mesh)?;
        breakable.highest = found.highest;
        let cut = !found.cuts.is_empty();
        if cut {
            let law = |cut: &Cut, height: f64| GlueLaw {
                stiffness: breakable.fracture.stiffness * faces.young / height,
                energies: breakable.fracture.energies.map(|g| g * cut.projection),
                mix: breakable.fracture.mix,
                softening: breakable.fracture.softening,
                contact: faces.pressure,
                tangential: faces.tangential * faces.pressure,
                friction: faces.friction,
            };
            cracks.add(whole, &found, law, time)?;
        }
        let next = if found.splits.is_empty() {
            None
        } else {
            Some(model.cracked(cracks.mesh.mesh(whole.mesh().points())?)?)
        };
        if let Some(next) = &next {
            self.split(next, &found, &mut cracks)?;
            cracks.open(&self.positions, &stresses);
            cracks.stiffen(self.positions.len());
            cracks.share(next.masses(), &self.inverse_masses);
            cracks.follow(&self.positions, &self.velocities);
        }
        if !is_first || next.is_some() {
            breakable.cracks = Some(cracks);
        } else if cut {
            // Facets that are cut and split no node yet are found again.
            breakable.cracks = None;
        }
        self.breakable = Some(breakable);
        let Some(next) = next else {
            return Ok(None);
        };
        self.strain(&next, scratch, time, true)?;
        Ok(Some(Cracked {
            model: next,
            is_first,
        }))
    }

    /// Splits nodes.
    fn split(
        &mut self,
        model: &DeformableModel,
        found: &Decision,
        cracks: &mut CrackState,
    ) -> Result<(), SolveError> {
        for split in &found.splits {
            let from = split.node as usize;
            self.positions.push(self.positions[from]);
            self.velocities.push(self.velocities[from]);
        }
        let count = self.positions.len();
        self.strain_forces.resize(count, Vector3::zeros());
        self.loads.resize(count, Vector3::zeros());
        let mesh = &cracks.mesh;
        self.boundary
            .follow(&found.splits, mesh.tets(), mesh.points());
        self.inverse_masses = inverse_masses(model.masses(), &self.boundary);
        self.held_energy = held_energy(&self.boundary, model.masses(), &self.velocities);
        self.nodal = NodalBound::new(model)?;
        self.rest = Rest::default();
        for joint in &mut cracks.joints {
            joint.sides = mesh.sides(joint.facet).unwrap_or(joint.sides);
        }
        Ok(())
    }

    /// Advances the joints of its cracks, and adds their forces to those of the elements.
    pub(in crate::world::deformables) fn join_cracks(&mut self, time: f64, renew: bool) {
        let Self {
            breakable,
            positions,
            strain_forces,
            ..
        } = self;
        let breakable = breakable.as_deref_mut();
        if let Some(cracks) = breakable.and_then(|breakable| breakable.cracks.as_deref_mut()) {
            cracks.join(positions, time, strain_forces);
            if renew {
                cracks.stiffen(positions.len());
            }
        }
    }

    /// Moves the contact nodes of a cracked body to where its nodes are.
    pub(in crate::world::deformables) fn follow_cracks(&mut self) {
        let Self {
            breakable,
            positions,
            velocities,
            ..
        } = self;
        let breakable = breakable.as_deref_mut();
        if let Some(cracks) = breakable.and_then(|breakable| breakable.cracks.as_deref_mut()) {
            cracks.follow(positions, velocities);
        }
    }

    /// What contacts do to its nodes, as body `i`; of stiffness, with that of its cracks.
    pub(in crate::world) fn contact_loads<'a>(
        &'a self,
        batch: &'a ContactBatch,
        i: BodyId,
    ) -> NodalLoads<'a> {
        match self.cracks() {
            Some(cracks) => cracks.loads(),
            None => batch.nodal_loads(i),
        }
    }

    /// Masses of its contact nodes, from those of its nodes, kg.
    pub(in crate::world::deformables) fn contact_masses<'a>(
        &self,
        masses: &'a [f64],
    ) -> Cow<'a, [f64]> {
        match self.cracks() {
            Some(cracks) => Cow::Owned(cracks.contact_masses(masses)),
            None => Cow::Borrowed(masses),
        }
    }

    pub(in crate::world) fn cracks(&self) -> Option<&CrackState> {
        self.breakable.as_ref()?.cracks.as_deref()
    }

    pub(in crate::world) fn cracks_mut(&mut self) -> Option<&mut CrackState> {
        self.breakable.as_mut()?.cracks.as_deref_mut()
    }
}

impl CrackState {
    /// Adds joints for facets that have just been cut, none of whose pairs of nodes is split yet.
    fn add(
        &mut self,
        whole: &DeformableModel,
        found: &Decision,
        law: impl Fn(&Cut, f64) -> GlueLaw,
        time: f64,
    ) -> Result<(), SolveError> {
        for cut in &found.cuts {
            let facet = self.mesh.facets().all()[cut.facet as usize];
            let [a, b, c] = facet.points.map(|point| whole.nodes()[point as usize]);
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let volume: f64 = facet
                .tets
                .iter()
                .map(|t| whole.volumes()[*t as usize])
                .sum();
            let height = 1.5 * volume / area;
            let law = law(cut, height);
            law.check()?;
            self.joints.push(Joint {
                facet: cut.facet,
                sides: [facet.points; 2],
                law,
                glued: GluedFacet::new(area)?,
                height,
                birth: time,
                end: None,
                mode: cut.mode,
                taken: 0.0,
            });
        }
        for joint in &mut self.joints {
            joint.sides = self.mesh.sides(joint.facet).unwrap_or(joint.sides);
        }
        Ok(())
    }

    /// Joins the pairs of nodes that have just been split, under the traction that the facet carries: that of the mean stress of
    /// the elements beside it, over its area before the body deformed.
    fn open(&mut self, positions: &[Vector3], stresses: &[ElementStress]) {
        let facets = self.mesh.facets().all();
        for joint in &mut self.joints {
            let [first, second] = joint.sides;
            let is_new = |q: &usize| first[*q] != second[*q] && !joint.glued.is_joined(*q);
            let new: Vec<usize> = (0..3).filter(is_new).collect();
            if new.is_empty() {
                continue;
            }
            let [a, b] = joint.places(positions);
            let middle = [0, 1, 2].map(|q| (a[q] + b[q]) * 0.5);
            let mean: Matrix3 = facets[joint.facet as usize]
                .tets
                .iter()
                .map(|t| stresses[*t as usize].cauchy * 0.5)
                .sum();
            let now = 0.5
                * (middle[1] - middle[0])
                    .cross(&(middle[2] - middle[0]))
                    .norm();
            let grown = now / joint.glued.area();
            if let Some(traction) = in_axes(&middle, |normal| mean * normal * grown) {
                for q in new {
                    let lent = joint.glued.join(q, &joint.law, traction);
                    self.flows.lent += lent;
                    joint.taken -= lent;
                }
            }
        }
    }
}
