//! Which law is that of a pair: the materials of bodies and walls.

use crate::contact::{BodyId, Partner};
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
