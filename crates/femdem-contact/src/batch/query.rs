//! What the batch knows after an update: loads, sums and contacts.

use super::{BatchTotals, ContactBatch};
use crate::contact::{BodyId, Load, Partner, RigidContact};
use crate::motion::Motion;
use crate::record::Contact;

/// How far the points of a turning wall that bodies may meet are from its origin, over the farthest point of a body: bodies have
/// skins.
const FARTHER: f64 = 1.1;

impl ContactBatch {
    /// Loads of the rigid bodies from all contacts, by number; those of sleeping bodies by rigid ones are from when they
    /// fell asleep.
    pub fn loads(&self) -> &[Load] {
        match self.deformable {
            Some(_) => &self.all_loads[0],
            None => &self.sums.loads,
        }
    }

    /// Loads on the walls from all evaluated contacts, about the walls' origins.
    pub fn wall_loads(&self) -> &[Load] {
        match self.deformable {
            Some(_) => &self.all_loads[1],
            None => &self.sums.walls,
        }
    }

    /// The load of one rigid body from all its contacts on record, evaluated or not.
    pub fn load_of(&self, body: BodyId) -> Load {
        let mut load = self.rigid_load_of(body);
        let part = self.deformable.as_ref();
        if let Some(other) = part.and_then(|part| part.rigid_loads().get(body as usize)) {
            load += other;
        }
        load
    }

    /// The same without deformable bodies.
    pub(super) fn rigid_load_of(&self, body: BodyId) -> Load {
        let mut load = Load::default();
        for contact in self.rigid_contacts_of(body) {
            load.add(contact, usize::from(contact.b == body));
        }
        self.bonds.add_load_of(body, &mut load);
        load
    }

    /// How far the points of a wall that rigid bodies may meet have moved at most between two of its motions, m: what a host adds
    /// to its [`Motion::travelled`] when it moves the wall. A wall is unbounded: with a turn those points count that are as far
    /// from its origin as bodies are with these motions, by number as in [`update`](Self::update).
    pub fn wall_way(&self, from: &Motion, to: &Motion, bodies: &[Motion]) -> f64 {
        let reach = if to.frame.rotation == from.frame.rotation {
            0.0
        } else {
            let far = self.rigid_ids().filter_map(|id| {
                let away = bodies.get(id as usize)?.frame.position - to.frame.position;
                Some(away.norm() + self.shapes[self.body_shapes[id as usize] as usize].radius())
            });
            FARTHER * far.fold(0.0, f64::max)
        };
        to.way_from(from, reach)
    }

    /// The load of a wall, about its origin, from all its recorded contacts.
    pub fn wall_load_of(&self, wall: u32) -> Load {
        let mut load = Load::default();
        for contact in self.rigid_contacts() {
            if contact.a == Partner::Wall(wall) {
                load.add(contact, 0);
            }
        }
        let part = self.deformable.as_ref();
        if let Some(other) = part.and_then(|part| part.wall_loads().get(wall as usize)) {
            load += other;
        }
        load
    }

    /// Sums of the last update.
    pub fn totals(&self) -> &BatchTotals {
        &self.sums.totals
    }

    /// All contacts on record, sorted by A, B and patch: those with walls come last.
    pub fn contacts(&self) -> Vec<Contact> {
        let rigid = self.rigid_contacts();
        let mut all: Vec<Contact> = rigid.into_iter().map(Contact::from).collect();
        all.extend(self.deformable_contacts());
        all.sort_by_key(|contact| (contact.a, contact.b, contact.patch));
        all
    }

    /// The contacts of one body, sorted by pair and patch.
    pub fn contacts_of(&self, body: BodyId) -> Vec<Contact> {
        let rigid = self.rigid_contacts_of(body).map(Contact::from);
        let thing = Partner::Body(body);
        let soft = self.deformable_contacts().filter(|c| c.has_side(thing));
        let mut own: Vec<Contact> = rigid.chain(soft.copied()).collect();
        own.sort_by_key(|contact| (contact.a, contact.b, contact.patch));
        own
    }

    /// The contacts on record of rigid bodies with each other and with walls, sorted by pair and patch, with what an
    /// implicit step needs to know of them.
    pub fn rigid_contacts(&self) -> Vec<&RigidContact> {
        self.pairs.contacts()
    }

    /// Those of one body, sorted by partner and patch.
    pub fn rigid_contacts_of(&self, body: BodyId) -> impl Iterator<Item = &RigidContact> {
        self.pairs.contacts_of(body)
    }

    /// Candidate pairs of a rigid body.
    pub fn candidates_of(&self, body: BodyId) -> usize {
        self.pairs.of(body).count()
    }

    /// Candidate pairs that will be evaluated at the next update.
    pub fn candidate_count(&self) -> usize {
        self.pairs.order_len()
    }
}
