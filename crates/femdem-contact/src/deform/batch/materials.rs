//! Which law is that of a pair: the materials of bodies and walls.

use super::{DeformableBatch, SOFT, Touched};
use crate::deform::record::DeformablePartner;
use crate::error::ContactError;
use crate::law::ContactParameters;
use crate::laws::{ContactLaws, MaterialId};
use serde::{Deserialize, Serialize};

/// The laws, and the materials of deformable bodies, rigid ones and walls by number.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Materials {
    pub laws: ContactLaws,
    of: [Vec<MaterialId>; 3],
}

impl Materials {
    pub fn new(laws: ContactLaws) -> Self {
        Self {
            laws,
            of: Default::default(),
        }
    }

    /// How many have a material, by kind.
    pub fn counts(&self) -> [usize; 3] {
        self.of.each_ref().map(Vec::len)
    }

    /// Notes the material of something new; a number is at most one beyond those that have been in use.
    pub fn set(&mut self, kind: usize, slot: u32, material: MaterialId) {
        let list = &mut self.of[kind];
        match list.get_mut(slot as usize) {
            Some(own) => *own = material,
            None => list.push(material),
        }
    }

    fn of(&self, thing: DeformablePartner) -> MaterialId {
        let (kind, slot) = thing.kind();
        self.of[kind]
            .get(slot as usize)
            .copied()
            .unwrap_or_default()
    }

    /// The law of a pair; that with a wall has the friction of walls.
    pub fn law(&self, a: DeformablePartner, b: u32) -> ContactParameters {
        let pair = [a, DeformablePartner::Deformable(b)].map(|side| self.of(side));
        let law = self.laws.between(pair);
        match a {
            DeformablePartner::Wall(_) => law.at_walls(),
            _ => *law,
        }
    }
}

impl DeformableBatch {
    /// The laws.
    pub fn laws(&self) -> &ContactLaws {
        &self.materials.laws
    }

    /// Replaces the laws; contacts keep their history.
    pub fn set_laws(&mut self, laws: impl Into<ContactLaws>) {
        self.evaluate_all();
        self.materials.laws = laws.into();
    }

    /// The material of a body or a wall; `None` if it does not exist.
    pub fn material(&self, thing: DeformablePartner) -> Option<MaterialId> {
        let (kind, slot) = thing.kind();
        self.known(kind, slot)
            .ok()
            .map(|()| self.materials.of(thing))
    }

    /// Gives a body or a wall another material. Its contacts keep their history, and have the laws of the new material from
    /// the next update on. Returns what it touches. A deformable body keeps its [modulus](Self::set_modulus).
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if it does not exist.
    pub fn set_material(
        &mut self,
        thing: DeformablePartner,
        material: MaterialId,
    ) -> Result<Touched, ContactError> {
        let (kind, slot) = thing.kind();
        self.known(kind, slot)?;
        self.materials.set(kind, slot, material);
        let touched = self.touched_by(thing);
        let own = (kind == SOFT).then_some(slot);
        for i in touched.deformables.iter().copied().chain(own) {
            self.bodies[i as usize].sleep.stir();
        }
        Ok(touched)
    }
}
