//! Which contact laws the rigid bodies of a scene can meet with.

use std::collections::BTreeMap;

use femdem_contact::MaterialId;

use super::{Scenario, Simulation};
use crate::scene::PairEntry;

/// A law of contacts, as far as penalties go: that of a pair, or that of all others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Met {
    /// Penalty of its own \[Pa\]; `None`: that of all others.
    pub penalty: Option<f64>,
    /// Cohesion \[Pa\].
    pub cohesion: f64,
    /// Work of adhesion, with that of a liquid bridge where bodies touch \[J/m²\].
    pub adhesion_energy: f64,
}

/// The materials that are there, and the laws of their pairs.
pub(super) struct Meets<'a> {
    scenario: &'a Scenario,
    pairs: Vec<([MaterialId; 2], &'a PairEntry)>,
    /// How many bodies, walls and bodies of sources are of each material; of a source, at least two.
    count: BTreeMap<MaterialId, usize>,
}

impl<'a> Meets<'a> {
    /// Pairs of unknown materials, which are refused when the world gets its laws, are left out.
    pub fn of(scenario: &'a Scenario, simulation: &Simulation) -> Self {
        let pairs = scenario.pair.iter().filter_map(|pair| {
            let [a, b] = &pair.materials;
            let ids = [scenario.material_id(a).ok()?, scenario.material_id(b).ok()?];
            Some((ids, pair))
        });
        let world = &simulation.world;
        let bodies = world.body_ids().filter_map(|id| world.material(id));
        let walls = world.walls().filter_map(|(id, _)| world.wall_material(id));
        let supplies = simulation.flow.supplies.iter();
        let come = supplies.flat_map(|supply| [supply.material; 2]);
        let mut count = BTreeMap::new();
        for material in bodies.chain(walls).chain(come) {
            *count.entry(material).or_insert(0) += 1;
        }
        Self {
            scenario,
            pairs: pairs.collect(),
            count,
        }
    }

    /// The laws of all that a body of a material may touch; that of all others if there is nothing.
    pub fn laws(&self, own: MaterialId) -> Vec<Met> {
        let there = self.count.iter();
        let others = there.filter(|(material, count)| **count > usize::from(**material == own));
        let mut laws: Vec<Met> = others.map(|(other, _)| self.law([own, *other])).collect();
        if laws.is_empty() {
            laws.push(self.law([own; 2]));
        }
        laws
    }

    fn law(&self, [a, b]: [MaterialId; 2]) -> Met {
        let of = |ids: &[MaterialId; 2]| *ids == [a, b] || *ids == [b, a];
        let pair = self.pairs.iter().find(|(ids, _)| of(ids));
        let pair = pair.map(|(_, pair)| *pair);
        let usual = self.scenario.parameters().contact;
        let law = pair.map_or(usual, |pair| pair.own([a, b]).over(&usual));
        Met {
            penalty: pair.and_then(|pair| pair.penalty),
            cohesion: law.cohesion,
            adhesion_energy: law.work_of_adhesion(),
        }
    }
}
