//! Batches that share the bodies of a whole: what one knows of a body and of a pair, to be handed to another.
//!
//! A body belongs to one batch; others near it have it as a guest. Of a pair with a guest both batches have their own copy, and
//! evaluate it to the same bits. A pair is on the books of the batch that its B belongs to.

use super::ContactBatch;
use super::pairs::{Pair, PairTable};
use crate::body_shape::Kind;
use crate::broadphase::Entry;
use crate::contact::{BodyId, Load, Partner};
use crate::error::{ContactError, check};
use crate::laws::MaterialId;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What a batch knows of a rigid body alone.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BodyRecord {
    shape: u32,
    material: MaterialId,
    awake: bool,
    load: Load,
    entry: Option<Entry>,
}

impl BodyRecord {
    /// Whether the body is awake.
    pub fn is_awake(&self) -> bool {
        self.awake
    }
}

/// Bodies with their numbers, ascending.
pub type BodyRecords = Vec<(BodyId, BodyRecord)>;

/// A candidate pair: what it remembers, and its contacts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PairRecord(Pair);

impl PairRecord {
    /// Its sides.
    pub fn sides(&self) -> (Partner, BodyId) {
        (self.0.a, self.0.b)
    }

    /// Gives the bodies other numbers. `None` if one of them has none.
    #[must_use]
    pub fn renumbered(mut self, number: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        let pair = &mut self.0;
        if let Partner::Body(a) = pair.a {
            pair.a = Partner::Body(number(a)?);
        }
        pair.b = number(pair.b)?;
        let (a, b) = (pair.a, pair.b);
        for contact in pair.records_mut() {
            (contact.a, contact.b) = (a, b);
        }
        Some(self)
    }
}

impl ContactBatch {
    /// Takes all bodies out, with their pairs. Walls stay.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] if there are deformable bodies or bonds: they cannot be shared out. Nothing is taken then.
    pub fn take_bodies(&mut self) -> Result<(BodyRecords, Vec<PairRecord>), ContactError> {
        let allowed = "0 in a batch whose bodies are shared out";
        for (name, count) in [
            ("number of deformable bodies", self.deformable_count()),
            ("number of bonds", self.bonds().count()),
        ] {
            check(name, count as f64, count == 0, allowed)?;
        }
        let record = |id: BodyId| BodyRecord {
            shape: self.body_shapes[id as usize],
            material: self.materials.of_bodies[id as usize],
            awake: self.awake[id as usize],
            load: self.sums.loads[id as usize],
            entry: self.broadphase.entry(id as usize),
        };
        let bodies = self.rigid_ids().map(|id| (id, record(id))).collect();
        let pairs = self.pairs.take();
        self.give_bodies(0, Vec::new(), Vec::new())?;
        Ok((bodies, pairs.into_iter().map(PairRecord).collect()))
    }

    /// Gives a batch without bodies its bodies: each with its number, ascending and below `total`, and whether it is a guest.
    /// Pairs are by these numbers.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] for a shape that is not there, a number out of order, and a pair of a body that is not there.
    pub fn give_bodies(
        &mut self,
        total: u32,
        bodies: Vec<(BodyId, BodyRecord, bool)>,
        pairs: Vec<PairRecord>,
    ) -> Result<(), ContactError> {
        let ascending = bodies.windows(2).all(|w| w[0].0 < w[1].0);
        let last = bodies.last().map(|(id, ..)| *id);
        if !ascending || last.is_some_and(|id| id >= total) {
            let last = last.unwrap_or_default() as usize;
            return Err(no_such("number of a body", last, total as usize));
        }
        let length = total as usize;
        let mut kinds = vec![Kind::Convex; length];
        for (id, record, _) in &bodies {
            kinds[*id as usize] = self.known_shape(record.shape)?.kind();
        }
        let is_there = |id: BodyId| bodies.binary_search_by_key(&id, |(id, ..)| *id).is_ok();
        for PairRecord(pair) in &pairs {
            let a_is_there = match pair.a {
                Partner::Body(a) => a < pair.b && is_there(a),
                Partner::Wall(wall) => self.wall_slots.holds(wall),
            };
            if !a_is_there || !is_there(pair.b) {
                return Err(no_such("body of a pair", pair.b as usize, bodies.len()));
            }
        }
        self.body_slots = bodies.iter().map(|(id, ..)| *id).collect();
        self.body_slots.extend_to(total);
        self.body_shapes = vec![0; length];
        self.materials.of_bodies = vec![MaterialId::default(); length];
        self.awake = vec![false; length];
        self.awake_list.clear();
        self.awake_changed = true;
        self.sums.loads = vec![Load::default(); length];
        self.broadphase.clear();
        let mut guests = vec![false; length];
        for (id, record, is_guest) in bodies {
            let i = id as usize;
            guests[i] = is_guest;
            self.body_shapes[i] = record.shape;
            self.materials.of_bodies[i] = record.material;
            self.awake[i] = record.awake;
            self.sums.loads[i] = record.load;
            if let Some(entry) = record.entry {
                self.broadphase.adopt(i, entry);
            }
        }
        let pairs = pairs.into_iter().map(|PairRecord(pair)| pair).collect();
        self.pairs.give(kinds, guests, pairs);
        self.sum_wall_loads();
        Ok(())
    }

    /// Adds a body of another batch that comes near those of this one, as [`add_body`](Self::add_body) does there.
    ///
    /// # Errors
    /// As [`add_body`](Self::add_body).
    pub fn add_guest(&mut self, shape: u32) -> Result<BodyId, ContactError> {
        let body = self.add_body(shape)?;
        self.pairs.set_guest(body as usize);
        Ok(body)
    }

    /// The loads on walls anew, from the contacts of awake bodies that are no guests, in the order of an update.
    fn sum_wall_loads(&mut self) {
        self.sums.walls.fill(Load::default());
        let awake = |body: &BodyId| self.awake[*body as usize] && !self.pairs.is_guest(*body);
        for body in self.body_slots.iter().filter(awake) {
            for contact in self.pairs.contacts_of(body) {
                if let Partner::Wall(wall) = contact.a {
                    self.sums.walls[wall as usize].add(contact, 0);
                }
            }
        }
    }

    /// Whether a body belongs to another batch.
    pub fn is_guest(&self, body: BodyId) -> bool {
        self.pairs.is_guest(body)
    }
}

fn no_such(what: &'static str, index: usize, count: usize) -> ContactError {
    ContactError::NoSuch { what, index, count }
}

impl PairTable {
    fn set_guest(&mut self, body: usize) {
        if body >= self.guests.len() {
            self.guests.resize(body + 1, false);
        }
        self.guests[body] = true;
        self.changed = true;
    }

    /// Takes all pairs but those of two guests, and of a guest with a wall.
    fn take(&mut self) -> Vec<Pair> {
        let free: BTreeSet<u32> = self.free.drain(..).collect();
        let slots = (0..).zip(std::mem::take(&mut self.slots));
        let live = slots.filter(|(slot, _)| !free.contains(slot));
        let is_own = |pair: &Pair| {
            let own_a = matches!(pair.a, Partner::Body(a) if !self.is_guest(a));
            own_a || !self.is_guest(pair.b)
        };
        live.map(|(_, pair)| pair).filter(is_own).collect()
    }
}
