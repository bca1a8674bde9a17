//! What a linearly implicit step needs of the contacts: springs and dashpots apart, contacts that are
//! about to close, and forces put back in their place.

use super::ContactBatch;
use crate::contact::{Contact, ContactForce};
use crate::error::ContactError;
use crate::motion::Motion;

/// Where all bodies and walls are.
#[derive(Debug, Clone, Copy)]
pub struct Snapshot<'a> {
    /// One motion per added body.
    pub bodies: &'a [Motion],
    /// One motion per added wall.
    pub walls: &'a [Motion],
    /// Time by which the torsion of the contacts advances, s.
    pub dt: f64,
}

impl ContactBatch {
    /// As [`update`](Self::update), with two differences. Dashpots exert no force: every contact has the
    /// forces of its springs, and tells its viscosities ([`Contact::dashpots`]); friction springs of a patch that
    /// slides carry what the dashpots leave of the bound, as they do there. And pairs that do not touch
    /// are looked at ahead: where the bodies would be at the end of the step with their present
    /// velocities. A contact found there is [foreseen](Contact::foreseen); so is one of two convex bodies, or of one and a
    /// wall of planes, that becomes much harder within the step, as where a body tips over an edge and a face comes down.
    ///
    /// This is for an implicit step, which finds the forces together with the velocities at its end
    /// and hands them back to [`set_forces`](Self::set_forces). `travelled` must not be less
    /// ahead than it is now, and what lies between a place ahead and the next one counts, too.
    ///
    /// # Errors
    /// As [`update`](Self::update).
    pub fn update_springs(&mut self, now: Snapshot, ahead: Snapshot) -> Result<(), ContactError> {
        self.advance(now, Some(ahead))
    }

    /// The contacts that the last update evaluated, in its order.
    pub fn evaluated(&self) -> impl Iterator<Item = &Contact> {
        self.pairs.evaluated().flat_map(|pair| pair.contacts())
    }

    /// Replaces the forces of the contacts that the last update evaluated, in the order of
    /// [`evaluated`](Self::evaluated), and sums the loads anew.
    ///
    /// # Errors
    /// [`ContactError::StateCount`] unless there are as many forces as contacts; nothing has changed
    /// then.
    pub fn set_forces(&mut self, forces: &[ContactForce]) -> Result<(), ContactError> {
        let expected = self.evaluated().count();
        if forces.len() != expected {
            return Err(ContactError::StateCount {
                what: "contact",
                given: forces.len(),
                expected,
            });
        }
        let mut forces = forces.iter();
        for k in 0..self.pairs.order_len() {
            let slot = self.pairs.order()[k];
            let contacts = self.pairs.slot_mut(slot).contacts_mut();
            for (contact, force) in contacts.zip(&mut forces) {
                contact.set_force(force);
            }
        }
        self.gather();
        Ok(())
    }
}
