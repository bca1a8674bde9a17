//! Contacts summed pair by pair.

use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

use super::ForceContact;
use crate::class::ContactClass;
use crate::coordination::Partner;

/// A touching pair: all contacts between two bodies, or between a body and a wall, together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairForce {
    /// The body; the lower index of two.
    pub first: u32,
    /// The other body, or the wall.
    pub second: Partner,
    /// Sum of the normal forces (N).
    pub normal_force: f64,
    /// Force on `second` (N), friction included.
    pub force: Vector3,
    /// Number of contacts.
    pub contacts: u32,
    /// The most extended of their classes: face-face before edge-face before point. `None` where no class
    /// is known.
    pub class: Option<ContactClass>,
    /// Constraints of rigid bodies without friction, summed over the contacts, at most 6; a contact of
    /// unknown class counts as a point.
    pub constraints_frictionless: u32,
    /// The same with friction.
    pub constraints_frictional: u32,
}

/// Pairs of `contacts`, sorted by their partners; sums are taken in the order given.
pub(super) fn of_contacts(contacts: &[ForceContact]) -> Vec<PairForce> {
    let mut ordered: Vec<PairForce> = contacts.iter().map(PairForce::of).collect();
    // A stable sort, so that the sums do not depend on how the sort works.
    ordered.sort_by_key(|pair| (pair.first, pair.second));
    let groups = ordered.chunk_by(|a, b| (a.first, a.second) == (b.first, b.second));
    groups
        .filter_map(|group| group.iter().copied().reduce(PairForce::joined))
        .collect()
}

impl PairForce {
    fn of(contact: &ForceContact) -> Self {
        let (first, second) = contact.pair();
        let sign = if first == contact.first { 1.0 } else { -1.0 };
        let class = contact.class.unwrap_or(ContactClass::Point);
        Self {
            first,
            second,
            normal_force: contact.normal_force,
            force: contact.force() * sign,
            contacts: 1,
            class: contact.class,
            constraints_frictionless: class.constraints(false),
            constraints_frictional: class.constraints(true),
        }
    }

    fn joined(self, other: Self) -> Self {
        // The order of the classes is that of their dimension, the most extended first.
        let class = [self.class, other.class].into_iter().flatten().min();
        let sum = |a: u32, b: u32| (a + b).min(6);
        Self {
            normal_force: self.normal_force + other.normal_force,
            force: self.force + other.force,
            contacts: self.contacts.saturating_add(other.contacts),
            class,
            constraints_frictionless: sum(
                self.constraints_frictionless,
                other.constraints_frictionless,
            ),
            constraints_frictional: sum(self.constraints_frictional, other.constraints_frictional),
            ..self
        }
    }

    /// Constraints with or without friction.
    pub(crate) fn constraints(&self, friction: bool) -> u32 {
        if friction {
            self.constraints_frictional
        } else {
            self.constraints_frictionless
        }
    }
}
