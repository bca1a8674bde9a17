//! Bodies and walls that go, and bodies that a host moves or reshapes by hand.

use super::ContactBatch;
use crate::body_shape::Kind;
use crate::contact::{BodyId, Contact, Load, Partner};
use crate::error::ContactError;

impl ContactBatch {
    /// Removes a body with its contacts and their history, and returns the bodies that it touched, ascending: those
    /// asleep among them may have lost their balance. Its number is given to the next body that is added, unless a lower
    /// one is free.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn remove_body(&mut self, body: BodyId) -> Result<Vec<BodyId>, ContactError> {
        let touched = self.leave(body)?;
        self.body_slots.give_back(body);
        let i = body as usize;
        self.awake[i] = false;
        self.awake_list.retain(|other| *other != body);
        self.sums.loads[i] = Load::default();
        self.pairs.set_body(i, Kind::Convex);
        Ok(touched)
    }

    /// Removes a wall with its contacts and their history, and returns the bodies that touched it, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such wall.
    pub fn remove_wall(&mut self, wall: u32) -> Result<Vec<BodyId>, ContactError> {
        self.known_wall(wall)?;
        let touched = self.touched_by_wall(wall);
        self.wall_slots.give_back(wall);
        let w = wall as usize;
        self.pairs.leave_wall(wall);
        self.pairs.set_wall(w, false);
        self.walls[w] = None;
        self.sums.walls[w] = Load::default();
        Ok(touched)
    }

    /// Gives a body another shape. Its contacts end with their history, since the surfaces that touched are gone; those of
    /// the new shape are found in the next update. Returns the bodies that it touched, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body or shape.
    pub fn reshape(&mut self, body: BodyId, shape: u32) -> Result<Vec<BodyId>, ContactError> {
        let kind = self.known_shape(shape)?.kind();
        let touched = self.leave(body)?;
        self.body_shapes[body as usize] = shape;
        self.pairs.set_body(body as usize, kind);
        Ok(touched)
    }

    /// Tells that a body was put somewhere else by hand, by more than [`Motion::travelled`](crate::Motion::travelled)
    /// says. Its contacts end with their history, since other material points face each other now; those at its new
    /// place are found in the next update. Returns the bodies that it touched, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn moved_by_hand(&mut self, body: BodyId) -> Result<Vec<BodyId>, ContactError> {
        self.leave(body)
    }

    /// Ends all pairs of a body, and forgets where it was.
    fn leave(&mut self, body: BodyId) -> Result<Vec<BodyId>, ContactError> {
        self.known_body(body)?;
        let touched = self.touched_by(body);
        self.pairs.leave(body);
        self.broadphase.forget(body as usize);
        // The lists of the awake are renewed, and one that sleeps is entered anew.
        self.awake_changed = true;
        Ok(touched)
    }

    pub(super) fn known_body(&self, body: BodyId) -> Result<(), ContactError> {
        if self.contains(body) {
            return Ok(());
        }
        Err(ContactError::NoSuch {
            what: "body",
            index: body as usize,
            count: self.len(),
        })
    }

    pub(super) fn known_wall(&self, wall: u32) -> Result<(), ContactError> {
        if self.wall(wall).is_some() {
            return Ok(());
        }
        Err(ContactError::NoSuch {
            what: "wall",
            index: wall as usize,
            count: self.wall_slots.len(),
        })
    }

    /// The bodies that a body touches, ascending.
    pub(super) fn touched_by(&self, body: BodyId) -> Vec<BodyId> {
        let partner = |contact: &Contact| match contact.a {
            Partner::Body(a) => Some(if a == body { contact.b } else { a }),
            Partner::Wall(_) => None,
        };
        let mut touched: Vec<BodyId> = self.contacts_of(body).filter_map(partner).collect();
        touched.dedup();
        touched
    }

    /// The bodies that touch a wall, ascending.
    pub(super) fn touched_by_wall(&self, wall: u32) -> Vec<BodyId> {
        let contacts = self.contacts().into_iter();
        let own = contacts.filter(|contact| contact.a == Partner::Wall(wall));
        let mut touched: Vec<BodyId> = own.map(|contact| contact.b).collect();
        touched.dedup();
        touched
    }
}
