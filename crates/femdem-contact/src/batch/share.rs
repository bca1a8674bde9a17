//! Batches that share the bodies of a whole: what one knows of a body and of a pair, to be handed to another.
//!
//! A body belongs to one batch; others near it have it as a guest. Of a pair with a guest both batches have their own copy, and
//! evaluate it to the same bits. A pair is on the books of the batch that its B belongs to. Of a deformable body its owner sums what
//! contacts do to its nodes.

use super::ContactBatch;
use super::bonds::BondId;
use super::pairs::{Pair, PairTable};
use crate::body_shape::Kind;
use crate::bond::Bond;
use crate::broadphase::Entry;
use crate::contact::{BodyId, Load, Partner};
use crate::deform::{DeformablePart, Side, Sleep, SoftBody, SoftPair};
use crate::error::{ContactError, check};
use crate::laws::MaterialId;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What a batch knows of a body alone.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BodyRecord {
    /// Of a rigid body, as whether it is awake, and its load.
    shape: u32,
    awake: bool,
    load: Load,
    /// How deformable bodies see it.
    sleep: Sleep,
    material: MaterialId,
    entry: Option<Entry>,
    /// Of a deformable body.
    soft: Option<Box<SoftBody>>,
}

impl BodyRecord {
    /// Whether it is that of a rigid body that is awake.
    pub fn is_awake_rigid(&self) -> bool {
        self.awake
    }

    /// Gives a deformable body a shape of another index.
    pub fn set_deformable_shape(&mut self, shape: u32) {
        if let Some(soft) = &mut self.soft {
            soft.shape = shape;
        }
    }

    /// The distance from the mean of the nodes of a deformable body within which they stay until it is next looked up, m.
    pub fn reach(&self) -> Option<f64> {
        Some(self.soft.as_deref()?.reach)
    }
}

/// Bodies with their numbers, ascending.
pub type BodyRecords = Vec<(BodyId, BodyRecord)>;

/// A candidate pair: what it remembers, and its contacts; or a bond of two bodies.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PairRecord(Candidate);

#[derive(Debug, Clone, Serialize, Deserialize)]
enum Candidate {
    Rigid(Box<Pair>),
    /// With a deformable body.
    Soft(Box<SoftPair>),
    /// With its number.
    Bond(Box<(BondId, Bond)>),
}

impl PairRecord {
    /// The bond, if it is one.
    pub fn bond(&self) -> Option<&Bond> {
        match &self.0 {
            Candidate::Bond(numbered) => Some(&numbered.1),
            Candidate::Rigid(_) | Candidate::Soft(_) => None,
        }
    }

    /// Its sides.
    pub fn sides(&self) -> (Partner, BodyId) {
        match &self.0 {
            Candidate::Rigid(pair) => (pair.a, pair.b),
            Candidate::Soft(pair) => (pair.a.into(), pair.b),
            Candidate::Bond(numbered) => {
                let [a, b] = numbered.1.bodies();
                (Partner::Body(a), b)
            }
        }
    }

    /// Gives the bodies other numbers, in the same order. `None` if one of them has none.
    #[must_use]
    pub fn renumbered(self, number: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        let mut pair = match self.0 {
            Candidate::Rigid(pair) => pair,
            Candidate::Soft(pair) => {
                let pair = pair.renumbered(number)?;
                return Some(Self(Candidate::Soft(Box::new(pair))));
            }
            Candidate::Bond(numbered) => {
                let (id, bond) = *numbered;
                let bond = bond.renumbered(number)?;
                return Some(Self(Candidate::Bond(Box::new((id, bond)))));
            }
        };
        if let Partner::Body(a) = pair.a {
            pair.a = Partner::Body(number(a)?);
        }
        pair.b = number(pair.b)?;
        let (a, b) = (pair.a, pair.b);
        for contact in pair.records_mut() {
            (contact.a, contact.b) = (a, b);
        }
        Some(Self(Candidate::Rigid(pair)))
    }

    /// Whether its bodies and its wall are there, as those of such a pair.
    fn fits(&self, is_there: impl Fn(BodyId, bool) -> bool, is_wall: impl Fn(u32) -> bool) -> bool {
        match &self.0 {
            Candidate::Rigid(pair) => {
                let a_is_there = match pair.a {
                    Partner::Body(a) => a < pair.b && is_there(a, false),
                    Partner::Wall(wall) => is_wall(wall),
                };
                a_is_there && is_there(pair.b, false)
            }
            Candidate::Soft(pair) => {
                let a_is_there = match pair.a {
                    Side::Deformable(a) => a <= pair.b && is_there(a, true),
                    Side::Rigid(a) => is_there(a, false),
                    Side::Wall(wall) => is_wall(wall),
                };
                a_is_there && is_there(pair.b, true)
            }
            Candidate::Bond(numbered) => {
                let [a, b] = numbered.1.bodies();
                a != b && is_there(a, false) && is_there(b, false)
            }
        }
    }
}

impl ContactBatch {
    /// Takes all bodies out, with their pairs and bonds. Walls and shapes stay.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] if there are contacts whose friction [begins](Self::begin_friction) in the next update, or
    /// rigid bodies whose pairs with deformable ones an update has not listed yet: they cannot be shared out. Nothing is taken then.
    pub fn take_bodies(&mut self) -> Result<(BodyRecords, Vec<PairRecord>), ContactError> {
        let allowed = "0 in a batch whose bodies are shared out";
        let part = self.deformable.as_deref();
        let unlisted = part.map_or(0, DeformablePart::unlisted);
        for (name, count) in [
            (
                "number of contacts whose friction begins",
                usize::from(self.begins_friction()),
            ),
            ("number of bodies whose pairs are not listed yet", unlisted),
        ] {
            check(name, count as f64, count == 0, allowed)?;
        }
        let mut part = self.deformable.take();
        let mut record = |id: BodyId| BodyRecord {
            shape: self.body_shapes[id as usize],
            awake: self.awake[id as usize],
            load: self.sums.loads[id as usize],
            sleep: part.as_ref().map_or(Sleep::Awake, |p| p.rigid_sleep(id)),
            material: self.materials.of_bodies[id as usize],
            entry: self.broadphase.entry(id as usize),
            soft: part.as_mut().and_then(|p| p.take_body(id)),
        };
        let bodies = self.body_ids().map(|id| (id, record(id))).collect();
        let soft = part.as_mut().map_or_else(Vec::new, |p| p.take_pairs());
        self.deformable = part;
        let rigid = self.pairs.take().into_iter();
        let rigid = rigid.map(|pair| Candidate::Rigid(Box::new(pair)));
        let soft = soft.into_iter().map(|pair| Candidate::Soft(Box::new(pair)));
        let bonds = self.bonds.take().into_iter();
        let bonds = bonds.map(|bond| Candidate::Bond(Box::new(bond)));
        let pairs = rigid.chain(soft).chain(bonds).map(PairRecord).collect();
        self.give_bodies(0, Vec::new(), Vec::new())?;
        Ok((bodies, pairs))
    }

    /// Forgets shapes of deformable bodies, of which there are none, but for those of these indices: they get others, in the same order.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] if there are deformable bodies.
    pub fn keep_deformable_shapes(
        &mut self,
        keeps: impl Fn(u32) -> bool,
    ) -> Result<(), ContactError> {
        let count = self.deformable_count();
        check(
            "number of deformable bodies",
            count as f64,
            count == 0,
            "0 where shapes are forgotten",
        )?;
        if let Some(part) = &mut self.deformable {
            part.keep_shapes(keeps);
        }
        Ok(())
    }

    /// Notes that a body belongs to another batch: a part of a body of that one.
    pub fn make_guest(&mut self, body: BodyId) {
        self.pairs.set_guest(body as usize);
        if let Some(part) = &mut self.deformable {
            part.make_guest(body);
        }
    }

    /// Whether friction of deformable bodies [begins](Self::begin_friction) in the next update.
    pub fn begins_friction(&self) -> bool {
        let part = self.deformable.as_deref();
        part.is_some_and(DeformablePart::begins_friction)
    }

    /// Running bound of the distance that any node of a deformable body has travelled, and the distance from the mean of its nodes
    /// within which they stay until it is next looked up, m.
    pub fn way_and_reach(&self, body: BodyId) -> Option<[f64; 2]> {
        self.deformable.as_ref()?.way_and_reach(body)
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
            match (&record.soft, &self.deformable) {
                (None, _) => kinds[*id as usize] = self.known_shape(record.shape)?.kind(),
                (Some(body), Some(part)) => part.check_shape(body)?,
                (Some(body), None) => {
                    let what = "shape of deformable bodies";
                    return Err(no_such(what, body.shape as usize, 0));
                }
            }
        }
        let is_there = |id: BodyId, soft: bool| {
            let at = bodies.binary_search_by_key(&id, |(id, ..)| *id);
            at.is_ok_and(|at| bodies[at].1.soft.is_some() == soft)
        };
        let is_wall = |wall| self.wall_slots.holds(wall);
        for pair in &pairs {
            if !pair.fits(is_there, is_wall) {
                let b = pair.sides().1 as usize;
                return Err(no_such("body of a pair", b, bodies.len()));
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
        let mut sleeps = vec![Sleep::Awake; length];
        let mut soft_bodies = Vec::new();
        for (id, record, is_guest) in bodies {
            let i = id as usize;
            guests[i] = is_guest;
            self.body_shapes[i] = record.shape;
            self.materials.of_bodies[i] = record.material;
            self.awake[i] = record.awake;
            self.sums.loads[i] = record.load;
            sleeps[i] = record.sleep;
            if let Some(entry) = record.entry {
                self.broadphase.adopt(i, entry);
            }
            if let Some(mut body) = record.soft {
                body.is_guest = is_guest;
                soft_bodies.push((id, body));
            }
        }
        let (mut rigid, mut soft, mut bonds) = (Vec::new(), Vec::new(), Vec::new());
        for PairRecord(pair) in pairs {
            match pair {
                Candidate::Rigid(pair) => rigid.push(*pair),
                Candidate::Soft(pair) => soft.push(*pair),
                Candidate::Bond(numbered) => bonds.push(*numbered),
            }
        }
        self.pairs.give(kinds, guests, rigid);
        self.bonds.give(bonds);
        self.sum_wall_loads();
        self.sum_edges();
        if let Some(part) = &mut self.deformable {
            part.give(soft_bodies, sleeps, soft);
        }
        self.sum_loads();
        Ok(())
    }

    /// Adds a body as [`add_body`](Self::add_body) does, under a number that is free or the next new one; that of another batch, which
    /// comes near those of this one, as a guest.
    ///
    /// # Errors
    /// As [`add_body`](Self::add_body), and [`ContactError::NoSuch`] for another number.
    pub fn add_body_as(
        &mut self,
        body: BodyId,
        shape: u32,
        is_guest: bool,
    ) -> Result<(), ContactError> {
        let kind = self.known_shape(shape)?.kind();
        let total = self.body_slots.total();
        let slot = self.body_slots.take_this(body);
        let slot = slot.ok_or_else(|| no_such("free number of a body", body as usize, total))?;
        self.begin_number(slot, shape, kind);
        self.begin_rigid(body);
        if is_guest {
            self.pairs.set_guest(body as usize);
        }
        Ok(())
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

    /// The forces over the edges anew, as an update adds them.
    fn sum_edges(&mut self) {
        self.sums.edges = Default::default();
        let Self {
            pairs, sums, awake, ..
        } = self;
        let is_awake = |pair: &&Pair| {
            let of_a = matches!(pair.a, Partner::Body(a) if awake[a as usize]);
            of_a || awake[pair.b as usize]
        };
        let booked = pairs.all().filter(|pair| !pairs.is_guest(pair.b));
        for pair in booked.filter(is_awake) {
            sums.add_pair_to_edges(pair);
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
