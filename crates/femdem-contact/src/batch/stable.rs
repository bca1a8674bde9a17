//! The step for which the contacts on record are stable.

use super::ContactBatch;
use crate::contact::{BodyId, Contact, Partner};
use crate::generalized::Resistance;
use crate::motion::Motion;

impl ContactBatch {
    /// The largest step for which all contacts on record are stable, s: the least
    /// [`largest_step`](Self::largest_step) of the bodies that are awake, infinite without contacts. `bodies` are their
    /// motions. Contacts that begin in the step are stiffer than those on record: take a small part of it.
    pub fn stable_step(&self, bodies: &[Motion]) -> f64 {
        let awake = (0..).zip(bodies).filter(|(body, _)| self.is_awake(*body));
        awake.fold(f64::INFINITY, |most, (body, motion)| {
            self.largest_step(body, motion, None, most)
        })
    }

    /// The springs and dashpots of all recorded contacts of a body. Sleeping partners do not move.
    pub fn resistance_of(&self, body: BodyId) -> Resistance {
        let mut resistance = Resistance::default();
        for contact in self.contacts_of(body) {
            let side = usize::from(contact.b == body);
            let moves = partner(contact, side).is_none_or(|other| self.is_awake(other));
            resistance.add(contact, side, moves);
        }
        resistance
    }

    /// The largest step for which the contacts of a body are stable, at most `most`, s: that of
    /// [`Resistance::largest_step`], with sleeping partners fixed. `others` holds springs and dashpots on the
    /// body from outside this batch.
    pub fn largest_step(
        &self,
        body: BodyId,
        motion: &Motion,
        others: Option<&Resistance>,
        most: f64,
    ) -> f64 {
        let load = self.sums.loads.get(body as usize);
        if others.is_none() && load.is_none_or(|load| load.allows(motion, most)) {
            return most;
        }
        let mut resistance = self.resistance_of(body);
        if let Some(others) = others {
            resistance += others;
        }
        resistance.largest_step(motion, most)
    }
}

/// The body on the other side of a contact.
fn partner(contact: &Contact, side: usize) -> Option<BodyId> {
    match (contact.a, side) {
        (Partner::Body(a), 1) => Some(a),
        (Partner::Body(_), _) => Some(contact.b),
        (Partner::Wall(_), _) => None,
    }
}
