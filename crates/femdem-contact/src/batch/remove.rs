//! Bodies and walls that go, and bodies that a host moves or reshapes by hand.

use super::ContactBatch;
use crate::body_shape::Kind;
use crate::contact::{BodyId, Load, Partner, RigidContact};
use crate::deform::Side;
use crate::error::ContactError;

impl ContactBatch {
    /// Removes a body with its bonds, its contacts and their history, and returns the bodies that it touched, ascending: those
    /// asleep among them may have lost their balance. Its number is given to the next body that is added, unless a lower
    /// one is free.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn remove_body(&mut self, body: BodyId) -> Result<Vec<BodyId>, ContactError> {
        let touched = self.leave(body)?;
        if let Some(part) = &mut self.deformable {
            part.remove_body(body);
        }
        self.body_slots.give_back(body);
        let i = body as usize;
        self.awake[i] = false;
        self.awake_list.retain(|other| *other != body);
        self.sums.loads[i] = Load::default();
        self.pairs.set_body(i, Kind::Convex);
        self.sum_loads();
        Ok(touched)
    }

    /// Removes a wall with its contacts and their history, and returns the bodies that touched it, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such wall.
    pub fn remove_wall(&mut self, wall: u32) -> Result<Vec<BodyId>, ContactError> {
        self.known_wall(wall)?;
        let side = Side::Wall(wall);
        let touched = self.touched_by(side);
        if let Some(part) = &mut self.deformable {
            part.leave(side);
        }
        self.wall_slots.give_back(wall);
        let w = wall as usize;
        self.pairs.leave_wall(wall);
        self.pairs.set_wall(w, false);
        self.walls[w] = None;
        self.sums.walls[w] = Load::default();
        self.sum_loads();
        Ok(touched)
    }

    /// Gives a rigid body another shape. Its contacts end with their history, since the surfaces that touched are gone; those of
    /// the new shape are found in the next update. Returns the bodies that it touched, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such rigid body or shape.
    pub fn reshape(&mut self, body: BodyId, shape: u32) -> Result<Vec<BodyId>, ContactError> {
        let kind = self.known_shape(shape)?.kind();
        if !self.is_rigid(body) {
            return Err(ContactError::NoSuch {
                what: "rigid body",
                index: body as usize,
                count: self.rigid_count(),
            });
        }
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

    /// Ends all pairs and bonds of a body, and forgets where it was.
    pub(super) fn leave(&mut self, body: BodyId) -> Result<Vec<BodyId>, ContactError> {
        let side = self.side(Partner::Body(body))?;
        let touched = self.touched_by(side);
        if let Some(part) = &mut self.deformable {
            part.leave(side);
        }
        self.bonds.forget(body);
        self.pairs.leave(body);
        self.broadphase.forget(body as usize);
        // The lists of the awake are renewed, and one that sleeps is entered anew.
        self.awake_changed = true;
        self.sum_loads();
        Ok(touched)
    }

    /// The bodies that touch a body or a wall, ascending. Deformable ones among them, and it if it is one, are evaluated in the
    /// next update even if they sleep.
    pub(super) fn touched_by(&mut self, side: Side) -> Vec<BodyId> {
        let thing = Partner::from(side);
        let partner = |contact: &RigidContact| match contact.a {
            Partner::Body(a) if Partner::Body(contact.b) == thing => Some(a),
            Partner::Wall(_) if Partner::Body(contact.b) == thing => None,
            _ => Some(contact.b),
        };
        let mut touched: Vec<BodyId> = match thing {
            Partner::Body(body) => {
                let contacts = self.rigid_contacts_of(body);
                let bonded = self.bonds.partners(body);
                let mut all: Vec<BodyId> = contacts.filter_map(partner).chain(bonded).collect();
                all.sort_unstable();
                all
            }
            Partner::Wall(_) => {
                let contacts = self.rigid_contacts().into_iter();
                let own = contacts.filter(|contact| contact.a == thing);
                own.filter_map(partner).collect()
            }
        };
        if let Some(part) = &mut self.deformable {
            touched.extend(part.stir_around(side));
            touched.sort_unstable();
        }
        touched.dedup();
        touched
    }
}
