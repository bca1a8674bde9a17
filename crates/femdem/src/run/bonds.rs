//! Bonds between the rigid bodies of a scenario.

use std::collections::BTreeSet;

use femdem_contact::bond::{BondLaw, BondSection};
use femdem_contact::glue::Softening;
use femdem_contact::{BodyId, MaterialId};
use femdem_solve::{SolveError, World};
use serde::{Deserialize, Serialize};

use super::words::in_entry;
use super::{Scenario, Simulation};
use crate::Error;
use crate::error::wrong;
use crate::scene::in_metres;

/// Bonds between the bodies of two groups that nearly touch; see [`BondLaw`]. No two bodies may be bonded by two entries.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct BondEntry {
    /// The two groups, which may be the same: each the name of a material, or of an entry of bodies.
    pub between: [String; 2],
    /// Largest gap, and for faces the largest overlap too \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub gap: f64,
    /// Radius of the disc between spheres over the smaller radius; size over that of the common part of facing faces.
    #[serde(default)]
    pub ratio: Option<f64>,
    /// Tensile strength \[Pa\].
    pub tensile: f64,
    /// Shear strength without pressure \[Pa\].
    pub cohesion: f64,
    /// Energies of fracture by opening and by sliding \[J/m²\].
    pub energy: [f64; 2],
    /// Stiffness per area \[Pa/m\].
    pub stiffness: f64,
    /// Coefficient of friction.
    #[serde(default)]
    pub friction: Option<f64>,
    /// Exponent of mixed modes.
    #[serde(default)]
    pub mix: Option<f64>,
    /// How the traction falls.
    #[serde(default)]
    pub softening: Option<Softening>,
    /// Part of critical damping.
    #[serde(default)]
    pub damping: Option<f64>,
}

impl BondEntry {
    /// The law of these bonds.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] with the number that is out of its range.
    pub fn law(&self) -> Result<BondLaw, Error> {
        let usual = BondLaw::default();
        let law = BondLaw {
            stiffness: self.stiffness,
            tensile: self.tensile,
            cohesion: self.cohesion,
            friction: self.friction.unwrap_or(usual.friction),
            energies: self.energy,
            mix: self.mix.unwrap_or(usual.mix),
            softening: self.softening.unwrap_or(usual.softening),
            damping: self.damping.unwrap_or(usual.damping),
        };
        law.check().map_err(SolveError::from)?;
        Ok(law)
    }

    /// Where it bonds the rigid bodies of two groups, which may be the same: each pair once, with its section.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with `gap` if there is none, [`Error::Solve`] for a gap or a ratio out of range.
    pub fn sections(
        &self,
        world: &World,
        groups: &[BTreeSet<BodyId>; 2],
    ) -> Result<Vec<([BodyId; 2], BondSection)>, Error> {
        let mut found = Vec::new();
        for bodies in near(world, groups, self.gap) {
            let section = world.section_between(bodies, self.gap, self.ratio.unwrap_or(1.0))?;
            found.extend(section.map(|section| (bodies, section)));
        }
        if found.is_empty() {
            let allowed = "larger, or other bodies: no two spheres, and no faces of two convex bodies, of these groups are so near";
            return Err(wrong("gap", &self.gap.to_string(), allowed));
        }
        Ok(found)
    }
}

impl Scenario {
    /// Bonds the bodies that are there.
    pub(super) fn add_bonds(&self, simulation: &mut Simulation) -> Result<(), Error> {
        for (number, entry) in (1..).zip(&self.bond) {
            let added = self.add_bonds_of(entry, simulation);
            added.map_err(in_entry(format!("bond {number}")))?;
        }
        Ok(())
    }

    fn add_bonds_of(&self, entry: &BondEntry, simulation: &mut Simulation) -> Result<(), Error> {
        let law = entry.law()?;
        let [a, b] = &entry.between;
        let groups = [self.group(a, simulation)?, self.group(b, simulation)?];
        let found = entry.sections(&simulation.world, &groups)?;
        for (bodies, _) in &found {
            if simulation.world.are_bonded(*bodies) {
                let [one, two] = bodies.map(|id| simulation.name_of_body(id));
                let value = format!("{:?}, with {one} and {two}", entry.between);
                let allowed =
                    "groups none of whose pairs another entry bonds: two would be twice the mortar";
                return Err(wrong("between", &value, allowed));
            }
        }
        for (bodies, section) in found {
            simulation.world.add_bond(bodies, &section, law)?;
        }
        Ok(())
    }

    /// The rigid bodies of a material or of an entry.
    fn group(&self, name: &str, simulation: &Simulation) -> Result<BTreeSet<BodyId>, Error> {
        let rigid: BTreeSet<BodyId> = simulation.world.rigid_ids().collect();
        let mut group = BTreeSet::new();
        if self.material.contains_key(name) {
            let id: MaterialId = self.material_id(name)?;
            let is_of = |body: &BodyId| simulation.world.material(*body) == Some(id);
            group.extend(rigid.iter().copied().filter(is_of));
        }
        let mut first = simulation.origin.bodies;
        for (entry, count) in self.body.iter().zip(&simulation.origin.members) {
            let members = simulation.members.iter().skip(first).take(*count);
            first += count;
            if entry.name == name {
                group.extend(members.map(|m| m.id).filter(|id| rigid.contains(id)));
            }
        }
        if group.is_empty() {
            let allowed = "the name of a material or of a [[body]] with rigid bodies in the scene";
            return Err(wrong("between", &format!("\"{name}\""), allowed));
        }
        Ok(group)
    }
}

/// Pairs of bodies of two groups whose boxes are at most `gap` (m) apart, ascending.
fn near(world: &World, [a, b]: &[BTreeSet<BodyId>; 2], gap: f64) -> BTreeSet<[BodyId; 2]> {
    let bounds = |id: &BodyId| Some((*id, world.bounds(*id)?));
    let mut boxes: Vec<_> = a.union(b).filter_map(bounds).collect();
    boxes.sort_by(|one, two| one.1.0.x.total_cmp(&two.1.0.x));
    let mut pairs = BTreeSet::new();
    for (k, (one, (low, high))) in boxes.iter().enumerate() {
        for (two, other) in &boxes[k + 1..] {
            if other.0.x > high.x + gap {
                break;
            }
            let meet = (0..3).all(|i| other.0[i] <= high[i] + gap && low[i] <= other.1[i] + gap);
            let belong = |x, y| a.contains(x) && b.contains(y);
            if meet && (belong(one, two) || belong(two, one)) {
                pairs.insert([*one.min(two), *one.max(two)]);
            }
        }
    }
    pairs
}
