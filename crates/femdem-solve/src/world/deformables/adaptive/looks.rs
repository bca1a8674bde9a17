//! Which adaptive bodies change, and when.

use super::super::Deformables;
use super::basis::{Basis, nodal_means, worst};
use super::screen::{Screen, pressed};
use super::spin::Kept;
use super::{AdaptiveBody, Adaptives};
use crate::error::SolveError;
use crate::world::World;
use femdem_contact::{BodyId, Contact, Partner};
use femdem_mesh::Vector3;
use std::collections::BTreeMap;

/// A body is deformable from this part of its strength on.
const NEAR: f64 = 0.7;

/// A body that uses less than this part of its strength may become rigid.
const FAR: f64 = 0.3;

/// A body is at rest within itself if its kinetic energy, but for that of its motion as a whole, is at most this part of V f²/(2 E), with its
/// volume V, tensile strength f and Young's modulus E: of what it stores near its strength.
const QUIET: f64 = 1e-6;

/// Looks in a row at which a body has to be at rest within itself and far from its strength.
const WINDOW: u32 = 20;

/// What becomes of a body.
pub(super) enum Verdict {
    Soften,
    Harden,
}

/// A body that changes, with its largest stress over its strength.
struct Change {
    id: BodyId,
    ratio: f64,
    verdict: Verdict,
}

impl World {
    /// Looks at the adaptive bodies, and makes those deformable or rigid that it is time for. Called after each step.
    pub(in crate::world) fn adapt_bodies(&mut self) -> Result<(), SolveError> {
        let Some(mut adaptives) = self.adaptives.take() else {
            return Ok(());
        };
        let found = self.look_at(&mut adaptives);
        self.adaptives = Some(adaptives);
        for Change { id, ratio, verdict } in found? {
            let (time, steps) = (self.time, self.steps);
            let changed = match verdict {
                Verdict::Soften => self.soften(id),
                Verdict::Harden => self.harden(id, ratio),
            };
            changed.map_err(|error| error.in_body(id as usize, steps, time))?;
        }
        Ok(())
    }

    fn look_at(&mut self, adaptives: &mut Adaptives) -> Result<Vec<Change>, SolveError> {
        let Adaptives { bodies, bases, .. } = adaptives;
        let steps = self.steps;
        let is_due = |body: &AdaptiveBody| {
            let every = u64::from(body.adaptive.fracture.every);
            steps.is_multiple_of(every)
        };
        if !bodies.values().any(is_due) {
            return Ok(Vec::new());
        }
        let contacts = self.batch.contacts();
        let mut of_bodies: BTreeMap<BodyId, Vec<&Contact>> = BTreeMap::new();
        for contact in &contacts {
            of_bodies.entry(contact.b).or_default().push(contact);
            if let Partner::Body(a) = contact.a
                && a != contact.b
            {
                of_bodies.entry(a).or_default().push(contact);
            }
        }
        let mut changes = Vec::new();
        for (&id, body) in bodies.iter_mut().filter(|(_, body)| is_due(body)) {
            if self.batch.is_deformable(id) {
                if let Some(ratio) = self.is_quiet(id, body)? {
                    let verdict = Verdict::Harden;
                    changes.push(Change { id, ratio, verdict });
                }
                continue;
            }
            let Some(own) = of_bodies.get(&id).filter(|_| self.batch.is_awake(id)) else {
                continue;
            };
            let basis = match bases.entry(body.adaptive.model) {
                std::collections::btree_map::Entry::Occupied(known) => known.into_mut(),
                std::collections::btree_map::Entry::Vacant(place) => {
                    place.insert(self.basis(body)?)
                }
            };
            if let Some(ratio) = self.is_near(id, body, basis, own)? {
                let verdict = Verdict::Soften;
                changes.push(Change { id, ratio, verdict });
            }
        }
        Ok(changes)
    }

    fn basis(&self, body: &AdaptiveBody) -> Result<Basis, SolveError> {
        let models = self.deformables.as_deref().map_or(&[][..], |d| &d.models);
        let number = body.adaptive.model as usize;
        let missing = || SolveError::NoSuch {
            what: "model",
            index: number,
            count: models.len(),
        };
        let model = models.get(number).ok_or_else(missing)?;
        Basis::new(model, &body.adaptive.fracture.strength)
    }

    /// Whether a rigid body with these contacts is to become deformable, with its largest stress over its strength then.
    fn is_near(
        &self,
        id: BodyId,
        body: &mut AdaptiveBody,
        basis: &Basis,
        contacts: &[&Contact],
    ) -> Result<Option<f64>, SolveError> {
        let rigid = &self.bodies[id as usize];
        let pose = rigid.pose(&self.shapes[rigid.shape as usize]);
        let now = pressed(id, &pose, contacts.iter().copied());
        let weakest = body.factors.iter().copied().fold(f64::INFINITY, f64::min);
        if !body
            .screen
            .is_due([basis.unit / weakest, basis.reach()], &now, NEAR)
        {
            return Ok(None);
        }
        let Some(forces) = self.nodal_forces_of(id, body, contacts)? else {
            return Ok(None);
        };
        let solved = basis.solve(&forces)?;
        let strength = &body.adaptive.fracture.strength;
        let ratio = worst(strength, solved.corners(), &body.factors);
        body.screen = Screen::new(ratio, now);
        Ok((ratio >= NEAR).then_some(ratio))
    }

    /// Whether a deformable body is to become rigid, with its largest stress over its strength then.
    fn is_quiet(&self, id: BodyId, body: &mut AdaptiveBody) -> Result<Option<f64>, SolveError> {
        let Some(Deformables { models, bodies, .. }) = self.deformables.as_deref() else {
            return Ok(None);
        };
        let state = &bodies[id as usize];
        let model = &models[state.model as usize];
        let masses = model.model.masses();
        let strength = &body.adaptive.fracture.strength;
        let kept = Kept {
            mass: masses.iter().sum(),
            momentum: state.momentum(masses),
            angular_momentum: state.angular_momentum(masses, &Vector3::zeros()),
        };
        let within = kept.rigid_energy(&state.positions, masses);
        let within = within.map(|rigid| state.kinetic_energy(masses) - rigid);
        let volume: f64 = model.model.volumes().iter().sum();
        let scale = volume * strength.tensile().powi(2) / (2.0 * model.young);
        let is_whole = state.breakable.as_deref().is_some_and(|breakable| {
            let same = breakable.factors.len() == body.factors.len();
            same && breakable.cracks.is_none() && breakable.spent.is_empty()
        });
        if !is_whole || within.is_none_or(|energy| energy > QUIET * scale) {
            body.quiet = 0;
            return Ok(None);
        }
        let stresses = model.model.stresses(&state.positions, &state.history)?;
        let ratio = worst(
            strength,
            &nodal_means(&model.model, &stresses),
            &body.factors,
        );
        body.quiet = if ratio < FAR { body.quiet + 1 } else { 0 };
        Ok((body.quiet >= WINDOW).then_some(ratio))
    }
}
