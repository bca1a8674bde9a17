//! Which law is that of a pair: the materials of bodies and walls.

use super::ContactBatch;
use crate::contact::{BodyId, Contact, Partner};
use crate::error::ContactError;
use crate::law::ContactParameters;
use crate::laws::{ContactLaws, MaterialId};
use serde::{Deserialize, Serialize};

/// The laws, and the materials by number of body and of wall.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Materials {
    pub laws: ContactLaws,
    pub of_bodies: Vec<MaterialId>,
    pub of_walls: Vec<MaterialId>,
}

impl Materials {
    pub fn new(laws: ContactLaws) -> Self {
        Self {
            laws,
            of_bodies: Vec::new(),
            of_walls: Vec::new(),
        }
    }

    /// The law of a pair; that with a wall has the friction of walls.
    #[inline]
    pub fn law(&self, a: Partner, b: BodyId) -> ContactParameters {
        let of_b = self.of_bodies[b as usize];
        match a {
            Partner::Body(a) => *self.laws.between([self.of_bodies[a as usize], of_b]),
            Partner::Wall(wall) => {
                let of_wall = self.of_walls[wall as usize];
                self.laws.between([of_wall, of_b]).at_walls()
            }
        }
    }
}

impl ContactBatch {
    /// The laws.
    pub fn laws(&self) -> &ContactLaws {
        &self.materials.laws
    }

    /// Replaces the laws; contacts keep their history.
    pub fn set_laws(&mut self, laws: impl Into<ContactLaws>) {
        self.materials.laws = laws.into();
    }

    /// The law of a contact; that with a wall has the friction of walls. `None` if a side has been removed.
    pub fn law_of(&self, contact: &Contact) -> Option<ContactParameters> {
        let (a, b) = (contact.a, contact.b);
        let a_is_there = match a {
            Partner::Body(a) => self.contains(a),
            Partner::Wall(wall) => self.wall(wall).is_some(),
        };
        (a_is_there && self.contains(b)).then(|| self.materials.law(a, b))
    }

    /// The material of a body.
    pub fn material(&self, body: BodyId) -> Option<MaterialId> {
        self.contains(body)
            .then(|| self.materials.of_bodies[body as usize])
    }

    /// The material of a wall.
    pub fn wall_material(&self, wall: u32) -> Option<MaterialId> {
        self.wall(wall)?;
        self.materials.of_walls.get(wall as usize).copied()
    }

    /// Gives a body another material. Its contacts keep their history, and have the laws of the new material from the next
    /// update on. Returns the bodies that it touches, ascending: it and those asleep among them may lose their balance.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn set_material(
        &mut self,
        body: BodyId,
        material: MaterialId,
    ) -> Result<Vec<BodyId>, ContactError> {
        self.known_body(body)?;
        self.materials.of_bodies[body as usize] = material;
        Ok(self.touched_by(body))
    }

    /// The same for a wall.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such wall.
    pub fn set_wall_material(
        &mut self,
        wall: u32,
        material: MaterialId,
    ) -> Result<Vec<BodyId>, ContactError> {
        self.known_wall(wall)?;
        self.materials.of_walls[wall as usize] = material;
        Ok(self.touched_by_wall(wall))
    }
}
