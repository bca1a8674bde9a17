//! Contact laws of pairs of materials.

use std::collections::BTreeSet;

use femdem_contact::{ContactLaw, ContactLaws, ContactParameters, MaterialId, WallResponse};
use serde::{Deserialize, Serialize};

use super::build::in_entry;
use super::words::OF_PAIRS;
use super::{Scenario, Simulation};
use crate::Error;
use crate::error::wrong;

/// The contact law of two materials, or of a material and itself. What it does not give is that of
/// [`ContactEntry`](super::ContactEntry).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PairEntry {
    /// The two materials, by name, in either order.
    pub materials: [String; 2],
    /// Penalty p of contacts of rigid bodies \[Pa\].
    pub penalty: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: Option<f64>,
    /// Coulomb friction coefficient between bodies and walls. `None`: `friction`, if that is given.
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction.
    pub rolling_friction: Option<f64>,
    /// Fraction of critical damping of the normal contact, below 0.7071.
    pub damping: Option<f64>,
    /// Tangential over normal foundation modulus.
    pub tangential_ratio: Option<f64>,
    /// Fraction of critical damping of the tangential springs.
    pub tangential_damping: Option<f64>,
    /// How walls act on deformable bodies.
    pub wall_response: Option<WallResponse>,
    /// Cohesion of rigid bodies \[Pa\]: attraction over the contact area.
    pub cohesion: Option<f64>,
    /// Work of adhesion of spheres with spheres and planes \[J/m²\].
    pub adhesion_energy: Option<f64>,
}

impl PairEntry {
    /// The law, where `usual` is that of other pairs.
    fn law(&self, usual: &ContactParameters) -> Result<ContactLaw, Error> {
        let wall_friction = match self.friction {
            Some(_) => self.wall_friction,
            None => self.wall_friction.or(usual.wall_friction),
        };
        let law = ContactLaw::new(ContactParameters {
            penalty: self.penalty.unwrap_or(usual.penalty),
            friction: self.friction.unwrap_or(usual.friction),
            wall_friction,
            rolling_friction: self.rolling_friction.unwrap_or(usual.rolling_friction),
            damping_ratio: self.damping.unwrap_or(usual.damping_ratio),
            tangential_ratio: self.tangential_ratio.unwrap_or(usual.tangential_ratio),
            tangential_damping: self.tangential_damping.unwrap_or(usual.tangential_damping),
            wall_response: self.wall_response.unwrap_or(usual.wall_response),
            cohesion: self.cohesion.unwrap_or(usual.cohesion),
            adhesion_energy: self.adhesion_energy.unwrap_or(usual.adhesion_energy),
        });
        law.map_err(|error| Error::from(error).by_keys(&OF_PAIRS))
    }
}

impl Scenario {
    /// The number of a material in the world: from 1, as 0 is that of walls without a material.
    pub(super) fn material_id(&self, name: &str) -> Result<MaterialId, Error> {
        self.material(name)?;
        let number = 1 + self
            .material
            .keys()
            .take_while(|known| *known != name)
            .count();
        let number = u8::try_from(number).map_err(|_| {
            let count = self.material.len().to_string();
            wrong("material", &count, "at most 255 materials in a scene")
        })?;
        Ok(MaterialId(number))
    }

    /// Gives the world the laws of the pairs, which inherit from the contact law that it has.
    pub(super) fn set_pairs(&self, simulation: &mut Simulation) -> Result<(), Error> {
        let usual = simulation.world.parameters().contact;
        let mut laws = ContactLaws::from(ContactLaw::new(usual)?);
        let mut known = BTreeSet::new();
        for pair in &self.pair {
            let mut add = || {
                let [a, b] = &pair.materials;
                let ids = [self.material_id(a)?, self.material_id(b)?];
                let law = pair.law(&usual)?;
                let empty = PairEntry {
                    materials: pair.materials.clone(),
                    ..PairEntry::default()
                };
                if *pair == empty {
                    return Err(wrong(
                        "pair",
                        "the materials only",
                        "give a key in which it differs from [contact]",
                    ));
                }
                if !known.insert((ids[0].min(ids[1]), ids[0].max(ids[1]))) {
                    return Err(wrong(
                        "pair",
                        "given twice",
                        "one [[pair]] for two materials",
                    ));
                }
                laws.set(ids, Some(law));
                Ok(())
            };
            let [a, b] = &pair.materials;
            add().map_err(in_entry(format!("pair \"{a}\" and \"{b}\"")))?;
        }
        if *simulation.world.laws() != laws {
            simulation.world.set_laws(laws)?;
        }
        Ok(())
    }
}
