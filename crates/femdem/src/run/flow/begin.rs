//! The beginning of flow: openings, gates and sources of a scenario.

use std::collections::BTreeSet;

use femdem_mesh::Vector3;

use super::SourceEntry;
use super::state::{Count, Flow, Gate, Opening, Supply};
use crate::Error;
use crate::error::wrong;
use crate::run::words::in_entry;
use crate::run::{Member, Scenario, Simulation};

/// Sine of the largest angle between a gate and an edge of a periodic cell.
const ALONG: f64 = 1e-9;

/// A name, or one by kind and number where none is given.
fn name_of(given: &str, kind: &str, number: usize) -> String {
    match given {
        "" => format!("{kind} {number}"),
        given => given.to_owned(),
    }
}

impl Scenario {
    /// Names of the sinks, gauges and sources, as in results.
    #[must_use]
    pub fn flow_names(&self) -> Vec<String> {
        let entries = [("sink", &self.sink), ("gauge", &self.gauge)];
        let gates = entries.into_iter().flat_map(|(kind, entries)| {
            let numbered = (1..).zip(entries);
            numbered.map(move |(number, entry)| name_of(&entry.name, kind, number))
        });
        let sources = (1..).zip(&self.source);
        let sources = sources.map(|(number, entry)| name_of(&entry.name, "source", number));
        gates.chain(sources).collect()
    }

    /// Refuses times of openings that cannot be or have no effect.
    pub(in crate::run) fn check_openings(&self) -> Result<(), Error> {
        for wall in &self.wall {
            let Some(time) = wall.opens else { continue };
            if !(time > 0.0 && time < self.duration) {
                let allowed = "a time above 0 and below the duration, in s";
                return Err(wrong("wall.opens", &time.to_string(), allowed));
            }
            if wall.control.is_some() {
                let allowed = "none for a wall with a control, which moves it to the end";
                return Err(wrong("wall.opens", &time.to_string(), allowed));
            }
        }
        Ok(())
    }
}

impl Simulation {
    /// Sets which walls open, as a scene has it.
    pub(in crate::run) fn set_openings(&mut self, scene: &Scenario) {
        let entries = scene.wall.iter().zip(&self.origin.walls);
        let openings = entries.flat_map(|(entry, walls)| {
            let time = entry.opens;
            let opening = move |&wall: &u32| Some(Opening { wall, time: time? });
            walls.iter().filter_map(opening)
        });
        self.flow.openings = openings.collect();
    }

    /// Begins the gates and sources of a scene, at the present time.
    pub(in crate::run) fn set_flow(&mut self, scene: &Scenario) -> Result<(), Error> {
        let mut names = BTreeSet::new();
        let mut named = |given: &str, kind: &str, number: usize| {
            let name = name_of(given, kind, number);
            match names.insert(name.clone()) {
                true => Ok(name),
                false => {
                    let allowed = "another sink, gauge or source has it: give each its own";
                    Err(wrong("name", &format!("\"{name}\""), allowed))
                }
            }
        };
        let mut flow = Flow::default();
        for (kind, takes, entries) in [("sink", true, &scene.sink), ("gauge", false, &scene.gauge)]
        {
            for (number, entry) in (1..).zip(entries) {
                let name = named(&entry.name, kind, number)?;
                let planes = entry.planes();
                let planes = planes.map_err(in_entry(format!("{kind} \"{name}\"")))?;
                self.refuse_across_edges(&planes)
                    .map_err(in_entry(format!("{kind} \"{name}\"")))?;
                let mut gate = Gate {
                    name,
                    takes,
                    planes,
                    passed: Count::default(),
                    beyond: Vec::new(),
                };
                let is_beyond = |member: &Member| {
                    let x = self.world.position(member.id);
                    x.is_some_and(|x| gate.is_beyond(&x))
                };
                gate.beyond = self.members.iter().map(is_beyond).collect();
                flow.gates.push(gate);
            }
        }
        for (number, entry) in (1..).zip(&scene.source) {
            let name = named(&entry.name, "source", number)?;
            if scene.body.iter().any(|body| body.name == name) {
                let allowed = "a [[body]] has it: give each its own";
                return Err(wrong("name", &format!("\"{name}\""), allowed));
            }
            let supply = self.supply(scene, entry, &name);
            let supply = supply.map_err(in_entry(format!("source \"{name}\"")))?;
            flow.supplies.push(supply);
        }
        self.flow = flow;
        self.set_openings(scene);
        Ok(())
    }

    /// Lets sources without another end go on to the end of a scene whose duration has changed.
    pub(in crate::run) fn extend_sources(&mut self, scene: &Scenario) -> Result<(), Error> {
        for (supply, entry) in self.flow.supplies.iter_mut().zip(&scene.source) {
            supply.most = entry.most(&supply.kinds, supply.rate, scene.duration)?;
        }
        Ok(())
    }

    /// Refuses gates that do not repeat themselves with a periodic cell: a body is on one side of them and its image on the other.
    fn refuse_across_edges(&self, planes: &[([f64; 3], f64)]) -> Result<(), Error> {
        let Some(cell) = self.world.cell() else {
            return Ok(());
        };
        let across = |normal: &[f64; 3]| {
            let normal = Vector3::from(*normal);
            let mut edges = cell.edges().column_iter();
            edges.any(|edge| normal.dot(&edge).abs() > ALONG * edge.norm())
        };
        match planes.iter().find(|(normal, _)| across(normal)) {
            Some((normal, _)) => {
                let allowed = "a plane along the edges of the periodic cell";
                Err(wrong(
                    "plane or box",
                    &format!("with the normal {normal:?}"),
                    allowed,
                ))
            }
            None => Ok(()),
        }
    }

    /// The source that an entry describes, with its shape in the world.
    fn supply(
        &mut self,
        scene: &Scenario,
        entry: &SourceEntry,
        name: &str,
    ) -> Result<Supply, Error> {
        entry.check()?;
        let density = scene.material(&entry.material)?.density()?;
        let material = scene.material_id(&entry.material)?;
        let kinds = entry.kinds(self, name, density)?;
        let [lower, upper] = entry.corners();
        let mut supply = Supply {
            name: name.to_owned(),
            kinds,
            density,
            material,
            lower,
            upper,
            places: entry.places.clone(),
            velocity: entry.velocity,
            rate: 0.0,
            most: 0,
            largest_mass: entry.mass.unwrap_or(f64::MAX),
            start: entry.start,
            end: entry.end.unwrap_or(f64::MAX),
            seed: entry.seed,
            tried: 0,
            come: Count::default(),
        };
        supply.rate = entry.bodies_per_second(supply.mean_mass())?;
        supply.most = entry.most(&supply.kinds, supply.rate, scene.duration)?;
        Ok(supply)
    }
}
