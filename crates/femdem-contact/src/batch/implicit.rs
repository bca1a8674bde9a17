//! Contacts for a linearly implicit step: springs and dashpots separately, contacts that are about to close,
//! and replaced forces.

use super::ContactBatch;
use crate::contact::{ContactForce, RigidContact};
use crate::error::{ContactError, check};
use crate::law::ContactParameters;
use crate::motion::Motion;

/// The poses and velocities of all bodies and walls at one time.
#[derive(Debug, Clone, Copy)]
pub struct Snapshot<'a> {
    /// One motion per number of a body.
    pub bodies: &'a [Motion],
    /// One motion per number of a wall.
    pub walls: &'a [Motion],
    /// Time by which the torsion of the contacts advances, s.
    pub dt: f64,
}

impl ContactBatch {
    /// As [`update`](Self::update), with two differences. First, dashpots exert no force: every contact has
    /// the forces of its springs, and its viscosities are in [`RigidContact::dashpots`]. The friction springs of a
    /// sliding patch carry what the dashpots leave of the bound, as in `update`. Second, pairs that do not
    /// touch are evaluated at the poses predicted for the end of the step from the present velocities. A
    /// contact found there is [foreseen](RigidContact::foreseen). So is a contact of two convex bodies, or of one
    /// and a wall of planes, that becomes much harder within the step, as when a body tips over an edge and a
    /// face comes down.
    ///
    /// This is for an implicit step, which solves for the forces together with the velocities at its end and
    /// passes them to [`set_forces`](Self::set_forces). [`Motion::travelled`](crate::Motion::travelled) must
    /// never decrease from one evaluation to the next, including between predicted and actual poses: add the
    /// distance between them.
    ///
    /// # Errors
    /// As [`update`](Self::update).
    pub fn update_springs(&mut self, now: Snapshot, ahead: Snapshot) -> Result<(), ContactError> {
        let attract = self.laws().all().any(ContactParameters::attracts);
        let allowed = "false: what attracts has no springs ahead of time; use `update`";
        check(
            "laws that attract",
            f64::from(u8::from(attract)),
            !attract,
            allowed,
        )?;
        let count = self.bonds().filter(|(_, bond)| !bond.has_ended()).count();
        let allowed = "0: bonds are for explicit steps; use `update`";
        check("bonds", count as f64, count == 0, allowed)?;
        self.advance(now, Some(ahead))
    }

    /// The contacts evaluated in the last update, in its order.
    pub fn evaluated(&self) -> impl Iterator<Item = &RigidContact> {
        self.pairs.evaluated().flat_map(|pair| pair.contacts())
    }

    /// Replaces the forces of the contacts evaluated in the last update, given in the order of
    /// [`evaluated`](Self::evaluated), and sums the loads again.
    ///
    /// # Errors
    /// [`ContactError::StateCount`] if the numbers of forces and contacts differ; nothing is changed then.
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
