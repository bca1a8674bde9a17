//! The step for which the contacts on record are stable.

use super::ContactBatch;
use crate::contact::{BodyId, Partner, RigidContact};
use crate::generalized::Resistance;
use crate::motion::Motion;

impl ContactBatch {
    /// The largest step for which all contacts on record of rigid bodies are stable, s: the least
    /// [`largest_step`](Self::largest_step) of the bodies that are awake, infinite without contacts. `bodies` are their
    /// motions. Contacts that begin in the step are stiffer than those on record: take a small part of it.
    /// For the nodes of deformable bodies see [`NodalLoads`](crate::deform::NodalLoads).
    pub fn stable_step(&self, bodies: &[Motion]) -> f64 {
        let rigid = (0..).zip(bodies).zip(&self.awake);
        let awake = rigid.filter(|(_, awake)| **awake);
        awake.fold(f64::INFINITY, |most, ((body, motion), _)| {
            self.largest_step(body, motion, most)
        })
    }

    /// The springs and dashpots of all recorded contacts and bonds of a rigid body. Sleeping partners do not move.
    pub fn resistance_of(&self, body: BodyId) -> Resistance {
        let mut resistance = Resistance::default();
        for contact in self.rigid_contacts_of(body) {
            let side = usize::from(contact.b == body);
            let moves = partner(contact, side).is_none_or(|other| self.is_awake(other));
            resistance.add(contact, side, moves);
        }
        self.bonds
            .resist(body, |other| self.is_awake(other), &mut resistance);
        if let Some(others) = self.by_deformables(body) {
            resistance += others;
        }
        resistance
    }

    /// The largest step for which the contacts of a rigid body are stable, at most `most`, s: that of
    /// [`Resistance::largest_step`], with sleeping partners fixed.
    pub fn largest_step(&self, body: BodyId, motion: &Motion, most: f64) -> f64 {
        let load = self.sums.loads.get(body as usize);
        let alone = load.map_or(f64::INFINITY, |load| load.safe_step(motion));
        // The loads of rigid contacts say nothing of the others.
        let safe = match self.by_deformables(body) {
            Some(_) => 0.0,
            None if alone >= most => return most,
            None => alone,
        };
        self.resistance_of(body)
            .largest_step_from(motion, [safe, most])
    }

    /// Springs and dashpots on a rigid body that deformable ones touch.
    fn by_deformables(&self, body: BodyId) -> Option<&Resistance> {
        self.deformable.as_ref()?.rigid_resistance(body)
    }
}

/// The body on the other side of a contact.
fn partner(contact: &RigidContact, side: usize) -> Option<BodyId> {
    match (contact.a, side) {
        (Partner::Body(a), 1) => Some(a),
        (Partner::Body(_), _) => Some(contact.b),
        (Partner::Wall(_), _) => None,
    }
}
