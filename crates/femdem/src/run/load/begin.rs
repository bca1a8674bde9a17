//! Loads on the bodies of a simulation: their beginning, and those of a step.

use std::collections::BTreeSet;

use femdem_mesh::Vector3;
use femdem_solve::{Alone, AppliedLoad};

use super::{BodyLoads, OnBodies, names};
use crate::Error;
use crate::run::words::KEYS;
use crate::run::words::in_entry;
use crate::run::{Scenario, Simulation};

impl Simulation {
    /// Replaces the loads on bodies by those of a scene. Earlier ones end.
    pub(in crate::run) fn set_loads(&mut self, scene: &Scenario) -> Result<(), Error> {
        for (member, numbers) in self.members.iter().zip(&self.loads.of_members) {
            if !numbers.is_empty() && self.world.has_body(member.id) {
                self.world.set_load(member.id, AppliedLoad::default())?;
            }
        }
        let mut loads = BodyLoads::default();
        for (number, entry) in (1..).zip(&scene.load) {
            let mut add = || -> Result<(), Error> {
                self.check_loaded(&entry.bodies)?;
                loads.loads.push(OnBodies::new(entry)?);
                Ok(())
            };
            add().map_err(in_entry(format!("load {number}")))?;
        }
        for member in &self.members {
            loads.add_member(member);
        }
        self.loads = loads;
        self.load_bodies(self.world.time())
    }

    /// Refuses names of no bodies.
    fn check_loaded(&self, given: &[String]) -> Result<(), Error> {
        let mut known: BTreeSet<&str> = BTreeSet::new();
        // A fragment bears what is on the body that broke.
        let wholes = self.members.iter().filter(|member| member.of.is_none());
        known.extend(wholes.map(|member| member.name.as_str()));
        known.extend(self.flow.supplies.iter().map(|supply| supply.name.as_str()));
        for name in given {
            if !known.iter().any(|member| names(name, member)) {
                let list: Vec<&str> = known.iter().take(20).copied().collect();
                return Err(Error::Unknown {
                    name: "bodies",
                    value: name.clone(),
                    known: format!(
                        "bodies, sources, and names before a number: {}",
                        list.join(", ")
                    ),
                });
            }
        }
        Ok(())
    }

    /// Loads the bodies for a step that begins now: with the loads of its middle, so that it is of second order.
    pub(in crate::run) fn load_bodies_in_step(&mut self) -> Result<(), Error> {
        self.load_bodies(self.world.time() + 0.5 * self.world.time_step())
    }

    /// Loads the bodies with the loads at a time \[s\].
    pub(in crate::run) fn load_bodies(&mut self, time: f64) -> Result<(), Error> {
        if self.loads.is_empty() {
            return Ok(());
        }
        let world = &mut self.world;
        let applied = self.loads.apply(&self.members, world, time, &mut Alone);
        applied.map_err(|error| error.by_keys(&KEYS))
    }

    /// Sum of the loads on rigid bodies that contacts move \[N\].
    pub(in crate::run) fn load_on_rigid(&self) -> Vector3 {
        let free = self.world.rigid_ids();
        let free = free.filter(|&id| self.world.follows_drive(id) == Some(false));
        let loads = free.filter_map(|id| self.world.applied_load(id));
        loads.map(|load| load.force).sum()
    }
}
