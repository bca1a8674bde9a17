//! Contact laws of pairs of materials.

use std::collections::BTreeSet;

use femdem_contact::{ContactLaw, ContactLaws, ContactParameters, MaterialId};

use super::words::OF_PAIRS;
use super::words::in_entry;
use super::{Scenario, Simulation};
use crate::Error;
use crate::error::wrong;
use crate::scene::PairEntry;

/// The law of a pair, where `usual` is that of other pairs.
fn law(pair: &PairEntry, usual: &ContactParameters) -> Result<ContactLaw, Error> {
    let law = ContactLaw::new(ContactParameters {
        wall_response: pair.wall_response.unwrap_or(usual.wall_response),
        ..pair.own([MaterialId::default(); 2]).over(usual)
    });
    law.map_err(|error| Error::from(error).by_keys(&OF_PAIRS))
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
                let law = law(pair, &usual)?;
                pair.check(&mut known)?;
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
