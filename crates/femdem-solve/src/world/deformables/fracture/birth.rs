//! Where and when cracks open.

use super::Breakable;
use super::cracks::CrackState;
use super::joints::Joint;
use crate::error::SolveError;
use crate::fracture::Fracture;
use crate::halo::Halo;
use crate::world::World;
use crate::world::deformables::add::{held_energy, inverse_masses};
use crate::world::deformables::each::on_each_with;
use crate::world::deformables::nodal_bound::NodalBound;
use crate::world::deformables::rest::Rest;
use crate::world::deformables::{Deformables, Model, Scratch, State, foundation};
use femdem_contact::deform::{Modulus, NodalLoads};
use femdem_contact::glue::{GlueLaw, GlueLimits, GluedFacet, MidSurface};
use femdem_contact::{BodyId, ContactBatch};
use femdem_fem::fracture::{Cut, Decision};
use femdem_fem::{DeformableModel, ElementStress};
use femdem_mesh::{Matrix3, Vector3};
use std::sync::Arc;

impl World {
    /// Looks at the stresses of the bodies that may break, and splits nodes where they exceed the strength. Called after each
    /// step. Guests crack as their owners say.
    pub(in crate::world) fn crack_deformables(
        &mut self,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
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
            body.look(&model.model, &faces, time, scratch)
        });
        let before = self.stored_in_soft_contacts();
        let mut cracked = Vec::new();
        for (i, look) in looks.into_iter().enumerate() {
            let look = look.map_err(|error| error.in_body(self.named(i), steps, time))?;
            cracked.extend(look.and_then(|model| self.with_cracks(i as BodyId, model)));
        }
        if !self.tell_cracks(&mut cracked, halo)? {
            return Ok(());
        }
        for (id, model) in cracked {
            // It is breakable from now on, as its fragments will be.
            self.forget_adaptive(id);
            self.crack(id, model)?;
        }
        self.book_cracks();
        // The contacts act on the new nodes, too.
        self.meet_deformables(0.0)?;
        self.flows.cracks.released += before - self.stored_in_soft_contacts();
        Ok(())
    }

    /// The number of a body with the model of its cracks.
    fn with_cracks(&self, id: BodyId, cracked: DeformableModel) -> Option<(BodyId, Model)> {
        let deformables = self.deformables.as_deref()?;
        let number = deformables.bodies[id as usize].model as usize;
        let old = &deformables.models[number];
        let edge = || self.batch.deformable_shapes()[number].edge();
        let model = Model {
            name: old.name.clone(),
            model: cracked,
            edge: Some(old.edge.unwrap_or_else(edge)),
            ..*old
        };
        Some((id, model))
    }

    /// Gives a body the model of its cracks.
    fn crack(&mut self, id: BodyId, cracked: Model) -> Result<(), SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(());
        };
        deformables.bound = None;
        let number = deformables.bodies[id as usize].model;
        let old = &mut deformables.models[number as usize];
        if old.edge.is_some() {
            *old = cracked;
            return self.reshape_cracked(id);
        }
        let shape = Arc::clone(&self.batch.deformable_shapes()[number as usize]);
        deformables.models.push(cracked);
        let own = self.batch.add_deformable_shape(shape);
        deformables.bodies[id as usize].model = own;
        self.batch.crack_deformable(id, own, None)?;
        self.reshape_cracked(id)
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

    /// Takes the stiffness of the contacts over to cracked bodies.
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

/// The limits of a facet that is cut, whose corners are at these places, m. In tension along d a facet askew carries less than the
/// strength, T = |n·d| f, and all of them open equally far: the facets of a zigzag bear and take what the plane that fails does, in the
/// mode of that plane, and each the part that it has of it. What they [carry](carried) of the stress along that plane is known when they open.
fn limits(
    fracture: &Fracture,
    cut: &Cut,
    corners: &[Vector3; 3],
) -> Result<GlueLimits, SolveError> {
    let strength = &fracture.strength;
    let strengths = [strength.tensile(), strength.cohesion()];
    let mut limits = GlueLimits::flat(strengths, strength.friction_angle().tan());
    if let Some(middle) = MidSurface::new(corners, corners) {
        let [n, first, second] = middle.axes.map(|axis| axis.dot(&cut.plane));
        let sign = if n < 0.0 { -1.0 } else { 1.0 };
        limits.plane = [sign * n, sign * first, sign * second];
    }
    limits.check()?;
    Ok(limits)
}

/// What a facet of these axes carries of a stress (Pa), in them: its traction σ n, and the part of that of the stress along the plane
/// that fails, σ (n − (n·m) m), whose sum over a zigzag without overhangs is zero.
fn carried(axes: &[Vector3; 3], plane: [f64; 3], stress: &Matrix3) -> [[f64; 3]; 2] {
    let normal = &axes[0];
    let across: Vector3 = axes.iter().zip(plane).map(|(axis, m)| axis * m).sum();
    [*normal, normal - across * normal.dot(&across)].map(|n| {
        let traction = stress * n;
        axes.map(|axis| axis.dot(&traction))
    })
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

impl Faces {
    /// The law of a facet beside elements of a height, m.
    fn law(&self, fracture: &Fracture, height: f64) -> GlueLaw {
        GlueLaw {
            stiffness: fracture.stiffness * self.young / height,
            energies: fracture.energies,
            mix: fracture.mix,
            softening: fracture.softening,
            contact: self.pressure,
            tangential: self.tangential * self.pressure,
            friction: self.friction,
            presses: false,
        }
    }
}

impl State {
    /// Looks at the stresses, and cracks if they exceed the strength.
    fn look(
        &mut self,
        model: &DeformableModel,
        faces: &Faces,
        time: f64,
        scratch: &mut Scratch,
    ) -> Result<Option<DeformableModel>, SolveError> {
        let Some(mut breakable) = self.breakable.take() else {
            return Ok(None);
        };
        let next = self.crack(&mut breakable, model, faces, time);
        self.breakable = Some(breakable);
        let Some(next) = next? else {
            return Ok(None);
        };
        self.strain(&next, scratch, time, true)?;
        Ok(Some(next))
    }

    /// Cracks where the stresses exceed the strength; returns the model if any node is split.
    fn crack(
        &mut self,
        breakable: &mut Breakable,
        model: &DeformableModel,
        faces: &Faces,
        time: f64,
    ) -> Result<Option<DeformableModel>, SolveError> {
        let stresses = model.stresses(&self.positions, &self.history)?;
        let found = breakable.decide(model, &self.positions, &stresses)?;
        let Breakable {
            fracture,
            factors,
            cracks,
            ..
        } = breakable;
        let Some(cracks) = cracks.as_deref_mut() else {
            return Ok(None);
        };
        let mut next = None;
        if !found.splits.is_empty() {
            // Nodes that are points come first.
            let cracked = model.cracked(cracks.mesh.mesh(model.mesh().points())?)?;
            self.split(&cracked, &found, cracks)?;
            next = Some(cracked);
        }
        cracks.add(model, &self.positions, &found, fracture, faces, time)?;
        if next.is_none() {
            return Ok(None);
        }
        cracks.loosened = true;
        cracks.open(&self.positions, &stresses, factors);
        cracks.stiffen(self.positions.len());
        Ok(next)
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

    /// What contacts do to its nodes, as body `i`; of stiffness, with that of its cracks.
    pub(in crate::world) fn contact_loads<'a>(
        &'a self,
        batch: &'a ContactBatch,
        i: BodyId,
    ) -> NodalLoads<'a> {
        let contacts = batch.nodal_loads(i);
        match self.cracks() {
            Some(cracks) => cracks.loads(contacts),
            None => contacts,
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
    /// Adds joints for facets that have just been cut; they are not joined yet. `positions` are those of the nodes, m.
    fn add(
        &mut self,
        model: &DeformableModel,
        positions: &[Vector3],
        found: &Decision,
        fracture: &Fracture,
        faces: &Faces,
        time: f64,
    ) -> Result<(), SolveError> {
        if found.cuts.is_empty() {
            return Ok(());
        }
        // Where elements are higher than meshes may have them in the mean, glue is as stiff as at that height, so that no mode without
        // pressure rises beyond its energy in the plane that fails.
        let most = if fracture.coarse {
            f64::INFINITY
        } else {
            fracture.largest_height(faces.young)
        };
        for cut in &found.cuts {
            let facet = self.mesh.facets().all()[cut.facet as usize];
            let [a, b, c] = facet.points.map(|point| model.nodes()[point as usize]);
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let volume: f64 = facet
                .tets
                .iter()
                .map(|t| model.volumes()[*t as usize])
                .sum();
            let height = 1.5 * volume / area;
            let law = faces.law(fracture, height.min(most));
            law.check()?;
            let sides = self.mesh.sides(cut.facet).unwrap_or([facet.points; 2]);
            // Both sides are there still.
            let corners = sides[0].map(|node| positions[node as usize]);
            self.joints.push(Joint {
                facet: cut.facet,
                sides,
                law,
                glued: GluedFacet::new(area)?,
                height,
                birth: time,
                end: None,
                mode: cut.mode,
                limits: limits(fracture, cut, &corners)?,
                taken: 0.0,
            });
        }
        Ok(())
    }

    /// Joins facets the first of whose nodes have just been split, under the traction that they carry: that of the mean stress of
    /// the elements beside them, over the area before the body deformed.
    fn open(&mut self, positions: &[Vector3], stresses: &[ElementStress], factors: &[f64]) {
        let facets = self.mesh.facets().all();
        for joint in &mut self.joints {
            let [first, second] = joint.sides;
            if first == second || joint.glued.is_joined() {
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
            let mean = mean * grown;
            if let Some(surface) = MidSurface::new(&middle, &middle) {
                let [traction, aside] = carried(&surface.axes, joint.limits.plane, &mean);
                let limits = GlueLimits {
                    aside,
                    ..joint.limits
                };
                let own = first.map(|node| factors[self.mesh.points()[node as usize] as usize]);
                let lent = joint.glued.join(&joint.law, traction, &limits, own);
                self.flows.lent += lent;
                joint.taken -= lent;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Rotation;

    const STRESS: [f64; 9] = [5e6, 1e6, -2e6, 1e6, -15e6, 3e6, -2e6, 3e6, 4e6];

    /// The facets of a zigzag, here the sides of a pyramid over a square, carry together the traction of the plane that fails: what each
    /// has of the stress along that plane adds up to nothing, and the rest is its part of the plane's.
    #[test]
    fn a_zigzag_carries_what_its_plane_does() {
        let stress = Matrix3::from_row_slice(&STRESS);
        let turn = Rotation::from_scaled_axis(Vector3::new(0.4, -1.1, 0.7));
        let m = turn * Vector3::z();
        let base = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let base = base.map(|(x, y)| turn * Vector3::new(x, y, 0.0));
        let peak = turn * Vector3::new(0.3, -0.2, 1.4);
        let (mut along, mut rest) = (Vector3::zeros(), Vector3::zeros());
        for k in 0..4 {
            let triangle = [base[k], base[(k + 1) % 4], peak];
            let area = 0.5
                * (triangle[1] - triangle[0])
                    .cross(&(triangle[2] - triangle[0]))
                    .norm();
            let surface = MidSurface::new(&triangle, &triangle).expect("it has an area");
            let axes = surface.axes;
            let plane = axes.map(|axis| axis.dot(&m));
            let [traction, aside] = carried(&axes, plane, &stress);
            // The other way of the normal of the plane is the same.
            assert_eq!(carried(&axes, plane.map(|x| -x), &stress)[1], aside);
            for (i, axis) in axes.iter().enumerate() {
                along += axis * (aside[i] * area);
                rest += axis * ((traction[i] - aside[i]) * area);
            }
        }
        assert!(along.norm() < 1e-6, "{along}");
        assert!((rest - stress * m * 4.0).norm() < 1e-6, "{rest}");
    }
}
