//! Overlaps of bodies and walls that were added or moved by hand since the contacts were last evaluated.

use super::World;
use crate::error::SolveError;
use femdem_contact::{BodyId, Contact, Partner, RigidContact};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Bodies and walls whose overlaps have not been evaluated.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::world) struct Newcomers {
    pub added: Things,
    /// Put where they are by hand.
    pub moved: Things,
}

/// Some bodies and walls.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::world) struct Things {
    pub bodies: BTreeSet<BodyId>,
    pub walls: BTreeSet<u32>,
}

impl Things {
    fn has(&self, partner: Partner) -> bool {
        match partner {
            Partner::Body(i) => self.bodies.contains(&i),
            Partner::Wall(w) => self.walls.contains(&w),
        }
    }

    fn forget(&mut self, partner: Partner) {
        match partner {
            Partner::Body(i) => self.bodies.remove(&i),
            Partner::Wall(w) => self.walls.remove(&w),
        };
    }
}

impl Newcomers {
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// 0 if something that was added is a side of a contact, else 1 if something that was moved is.
    fn kind(&self, a: Partner, b: BodyId) -> Option<usize> {
        let is_side = |things: &Things| things.has(a) || things.has(Partner::Body(b));
        [&self.added, &self.moved].into_iter().position(is_side)
    }

    /// Whether the contacts of something have not been evaluated since it came or was moved.
    pub fn has(&self, thing: Partner) -> bool {
        self.added.has(thing) || self.moved.has(thing)
    }

    /// With other numbers of the bodies, without those that have none.
    pub fn renumbered(mut self, number: impl Fn(BodyId) -> Option<BodyId>) -> Self {
        for things in [&mut self.added, &mut self.moved] {
            let bodies = std::mem::take(&mut things.bodies);
            things.bodies = bodies.into_iter().filter_map(&number).collect();
        }
        self
    }

    /// Adds those of another part of a world.
    pub fn join(&mut self, other: Self) {
        for (all, more) in [
            (&mut self.added, other.added),
            (&mut self.moved, other.moved),
        ] {
            all.bodies.extend(more.bodies);
            all.walls.extend(more.walls);
        }
    }

    /// Something was removed.
    pub fn forget(&mut self, partner: Partner) {
        self.added.forget(partner);
        self.moved.forget(partner);
    }
}

impl World {
    /// Evaluates the loads at the present positions, if they are out of date.
    pub(super) fn evaluate_if_due(&mut self) -> Result<(), SolveError> {
        if !self.loaded {
            self.evaluate(0.0)?;
            self.loaded = true;
            self.wake_left();
        }
        Ok(())
    }

    /// Evaluates the contacts if something has come since the last evaluation. An implicit step would see its overlaps as
    /// contacts that it has foreseen.
    pub(super) fn meet_newcomers(&mut self) -> Result<(), SolveError> {
        if self.newcomers.is_empty() {
            return Ok(());
        }
        self.evaluate_if_due()
    }

    /// Books the elastic energy of the overlaps of rigid bodies with what was added or moved by hand since the last
    /// evaluation, and returns it, J.
    pub(super) fn book_newcomers(&mut self) -> f64 {
        if self.newcomers.is_empty() {
            return 0.0;
        }
        let kind = |c: &&RigidContact| self.newcomers.kind(c.a, c.b);
        let brought = sums(self.batch.booked_contacts(), kind, |c| c.potential());
        self.book(brought);
        brought.iter().sum()
    }

    /// The same for deformable bodies, whose contacts are evaluated last: nothing is new any more.
    pub(super) fn book_soft_newcomers(&mut self) {
        if self.newcomers.is_empty() {
            return;
        }
        let kind = |c: &&Contact| self.newcomers.kind(c.a, c.b);
        let booked = self.deformable_contacts();
        let booked = booked.filter(|contact| !self.is_guest(contact.b));
        let brought = sums(booked, kind, |c| c.potential());
        self.book(brought);
        self.newcomers = Newcomers::default();
    }

    fn book(&mut self, [added, moved]: [f64; 2]) {
        self.initial_energy += added;
        self.flows.by_hand += moved;
    }
}

/// Sums over the contacts by kind.
fn sums<C>(
    contacts: impl Iterator<Item = C>,
    kind: impl Fn(&C) -> Option<usize>,
    energy: impl Fn(&C) -> f64,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for contact in contacts {
        if let Some(kind) = kind(&contact) {
            sums[kind] += energy(&contact);
        }
    }
    sums
}
