//! The contact law of a pair of materials, as scenes give it.

use std::collections::BTreeSet;

use femdem_contact::{MaterialId, WallResponse};
use femdem_pack::PairLaw;
use serde::{Deserialize, Serialize};

use super::BridgeEntry;
use crate::Error;
use crate::error::wrong;

/// The contact law of two materials, or of a material and itself. What it does not give is that of
/// [`ContactEntry`](crate::run::ContactEntry).
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
    /// Liquid bridges of spheres with spheres and planes.
    pub liquid_bridge: Option<BridgeEntry>,
}

impl PairEntry {
    /// What it gives, of materials by number.
    pub(crate) fn own(&self, materials: [MaterialId; 2]) -> PairLaw {
        PairLaw {
            materials,
            penalty: self.penalty,
            friction: self.friction,
            wall_friction: self.wall_friction,
            rolling_friction: self.rolling_friction,
            damping_ratio: self.damping,
            tangential_ratio: self.tangential_ratio,
            tangential_damping: self.tangential_damping,
            cohesion: self.cohesion,
            adhesion_energy: self.adhesion_energy,
            liquid_bridge: self.liquid_bridge.map(Into::into),
        }
    }

    /// The law of a pack whose materials have these names, from number 1 on; `None` if one has no name.
    pub(crate) fn of(law: &PairLaw, names: &[String]) -> Option<Self> {
        let name = |id: MaterialId| names.get(usize::from(id.0).checked_sub(1)?).cloned();
        Some(Self {
            materials: [name(law.materials[0])?, name(law.materials[1])?],
            penalty: law.penalty,
            friction: law.friction,
            wall_friction: law.wall_friction,
            rolling_friction: law.rolling_friction,
            damping: law.damping_ratio,
            tangential_ratio: law.tangential_ratio,
            tangential_damping: law.tangential_damping,
            wall_response: None,
            cohesion: law.cohesion,
            adhesion_energy: law.adhesion_energy,
            liquid_bridge: law.liquid_bridge.map(Into::into),
        })
    }

    /// Whether these are its two materials, in either order.
    pub(crate) fn is_of(&self, [a, b]: &[String; 2]) -> bool {
        let [own, other] = &self.materials;
        (own, other) == (a, b) || (own, other) == (b, a)
    }

    /// Refuses a pair that gives nothing, or whose materials are those of a `known` one, to which it is added.
    pub(crate) fn check<'a>(&'a self, known: &mut BTreeSet<[&'a str; 2]>) -> Result<(), Error> {
        let empty = Self {
            materials: self.materials.clone(),
            ..Self::default()
        };
        if *self == empty {
            let allowed = "give a key in which it differs from the law of all others";
            return Err(wrong("pair", "the materials only", allowed));
        }
        let mut materials = [0, 1].map(|k| self.materials[k].as_str());
        materials.sort_unstable();
        if !known.insert(materials) {
            let allowed = "one [[pair]] for two materials";
            return Err(wrong("pair", "given twice", allowed));
        }
        Ok(())
    }
}
