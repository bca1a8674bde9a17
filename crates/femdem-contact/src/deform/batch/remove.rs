//! Bodies and walls that go, and bodies that a host moves by hand.

use super::{DeformableBatch, RIGID, SOFT, WALL};
use crate::contact::BodyId;
use crate::deform::record::DeformablePartner;
use crate::error::ContactError;
use crate::generalized::Resistance;

/// What touched something before it was removed or moved by hand, ascending. Those asleep among them may have lost their
/// balance.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Touched {
    /// Deformable bodies.
    pub deformables: Vec<u32>,
    /// Rigid bodies.
    pub rigid: Vec<BodyId>,
}

impl DeformableBatch {
    /// Removes a deformable body with its contacts and their history. Its number is given to the next one that is added,
    /// unless a lower one is free.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn remove_body(&mut self, body: u32) -> Result<Touched, ContactError> {
        let touched = self.leave(DeformablePartner::Deformable(body))?;
        self.slots[SOFT].give_back(body);
        self.bodies[body as usize].vacate();
        Ok(touched)
    }

    /// The same for a rigid body.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn remove_rigid(&mut self, body: BodyId) -> Result<Touched, ContactError> {
        let touched = self.leave(DeformablePartner::Rigid(body))?;
        self.slots[RIGID].give_back(body);
        self.rigid[body as usize] = None;
        self.rigid_resistances[body as usize] = Resistance::default();
        Ok(touched)
    }

    /// The same for a wall.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such wall.
    pub fn remove_wall(&mut self, wall: u32) -> Result<Touched, ContactError> {
        let touched = self.leave(DeformablePartner::Wall(wall))?;
        self.slots[WALL].give_back(wall);
        self.walls[wall as usize] = None;
        Ok(touched)
    }

    /// Tells that the nodes of a deformable body were put somewhere else by hand. Its contacts end with their history,
    /// since other material points face each other now; those at its new place are found in the next update.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn moved_by_hand(&mut self, body: u32) -> Result<Touched, ContactError> {
        let touched = self.leave(DeformablePartner::Deformable(body))?;
        self.bodies[body as usize].displaced();
        Ok(touched)
    }

    /// The same for a rigid body.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn rigid_moved_by_hand(&mut self, body: BodyId) -> Result<Touched, ContactError> {
        self.leave(DeformablePartner::Rigid(body))
    }

    /// Ends all pairs of a body or wall, and sums the forces of the others again.
    fn leave(&mut self, thing: DeformablePartner) -> Result<Touched, ContactError> {
        let (kind, slot) = thing.kind();
        self.known(kind, slot)?;
        let own =
            |a: DeformablePartner, b: u32| a == thing || DeformablePartner::Deformable(b) == thing;
        let touched = self.touched_by(thing);
        self.pairs.end(|pair| own(pair.a, pair.b));
        self.starts.retain(|(a, b), _| !own(*a, *b));
        for &i in &touched.deformables {
            self.bodies[i as usize].sleep.stir();
        }
        self.gather(false);
        Ok(touched)
    }

    /// What a body or a wall touches.
    pub(super) fn touched_by(&self, thing: DeformablePartner) -> Touched {
        let mut touched = Touched::default();
        let pairs = self.pairs.list().iter();
        for pair in pairs.filter(|pair| !pair.outcome.contacts.is_empty()) {
            let sides = [pair.a, DeformablePartner::Deformable(pair.b)];
            for other in sides.iter().filter(|_| sides.contains(&thing)) {
                match *other {
                    same if same == thing => {}
                    DeformablePartner::Deformable(i) => touched.deformables.push(i),
                    DeformablePartner::Rigid(i) => touched.rigid.push(i),
                    DeformablePartner::Wall(_) => {}
                }
            }
        }
        touched.deformables.sort_unstable();
        touched
    }
}
