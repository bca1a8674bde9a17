//! Bodies and pairs that go to another batch or come from one: see [`crate::batch`].
//!
//! A guest has the places and velocities of its nodes from its owner. Its own contacts, and those with walls and other guests, are
//! not looked for, and what its contacts do to it is not summed.

use super::body::SoftBody;
use super::pair::SoftPair;
use super::state::Sleep;
use super::{DeformablePart, no_shape};
use crate::contact::{BodyId, Load, Partner};
use crate::deform::side::Side;
use crate::error::ContactError;
use crate::generalized::Resistance;

impl DeformablePart {
    /// Takes a deformable body out; `None` if there is none of that number. Its pairs stay.
    pub fn take_body(&mut self, body: BodyId) -> Option<Box<SoftBody>> {
        let own = self.bodies.get_mut(body as usize)?;
        if !own.is_there {
            return None;
        }
        self.count -= 1;
        let mut taken = Box::new(std::mem::replace(own, SoftBody::vacant()));
        taken.is_guest = false;
        Some(taken)
    }

    /// Forgets shapes, which no body has, but for those of these indices.
    pub fn keep_shapes(&mut self, keeps: impl Fn(u32) -> bool) {
        let all = std::mem::take(&mut self.shapes);
        let kept = (0..).zip(all).filter(|(index, _)| keeps(*index));
        self.shapes = kept.map(|(_, shape)| shape).collect();
    }

    /// Notes that a deformable body belongs to another batch.
    pub fn make_guest(&mut self, body: BodyId) {
        if let Some(body) = self.bodies.get_mut(body as usize) {
            body.is_guest = true;
        }
    }

    /// Takes all pairs out.
    pub fn take_pairs(&mut self) -> Vec<SoftPair> {
        self.pairs.take()
    }

    /// Whether a rigid body may move.
    pub fn rigid_sleep(&self, body: BodyId) -> Sleep {
        self.rigid_sleep[body as usize]
    }

    /// Whether friction [begins](Self::begin_friction) in the next update.
    pub fn begins_friction(&self) -> bool {
        !self.starts.is_empty()
    }

    /// How many bodies were entered anew since pairs were listed last.
    pub fn unlisted(&self) -> usize {
        self.entered.len()
    }

    /// Refuses a body whose shape is not there.
    pub fn check_shape(&self, body: &SoftBody) -> Result<(), ContactError> {
        let count = self.shapes.len();
        if (body.shape as usize) < count {
            Ok(())
        } else {
            Err(no_shape(body.shape, count))
        }
    }

    /// Replaces all bodies, whose [shapes](Self::check_shape) are there, and all pairs, which are of these bodies. `sleeps` is by
    /// number, of rigid bodies.
    pub fn give(
        &mut self,
        bodies: Vec<(BodyId, Box<SoftBody>)>,
        sleeps: Vec<Sleep>,
        pairs: Vec<SoftPair>,
    ) {
        let length = sleeps.len();
        self.count = bodies.len();
        self.bodies.clear();
        self.bodies.resize_with(length, SoftBody::vacant);
        for (id, mut body) in bodies {
            body.restore(&self.shapes[body.shape as usize]);
            self.bodies[id as usize] = *body;
        }
        self.rigid_sleep = sleeps;
        self.rigid_loads = vec![Load::default(); length];
        self.rigid_resistances = vec![Resistance::default(); length];
        self.entered.clear();
        self.pairs = Default::default();
        self.pairs.add(pairs);
        self.gather_again(true);
    }

    /// Running bound of the distance that any node of a deformable body has travelled, and the distance from the mean of its nodes
    /// within which they stay until it is next looked up, m.
    pub fn way_and_reach(&self, body: BodyId) -> Option<[f64; 2]> {
        let body = self.bodies.get(body as usize)?;
        body.is_there.then_some([body.travelled, body.reach])
    }
}

impl SoftPair {
    /// Gives the bodies other numbers, in the same order. `None` if one of them has none.
    pub fn renumbered(mut self, number: impl Fn(BodyId) -> Option<BodyId>) -> Option<Self> {
        self.a = match self.a {
            Side::Deformable(a) => Side::Deformable(number(a)?),
            Side::Rigid(a) => Side::Rigid(number(a)?),
            Side::Wall(wall) => Side::Wall(wall),
        };
        self.b = number(self.b)?;
        let (a, b) = (Partner::from(self.a), self.b);
        for contact in &mut self.outcome.contacts {
            (contact.a, contact.b) = (a, b);
        }
        // It names a body by its old number.
        self.failure = None;
        Some(self)
    }
}
