//! Flow: walls that open, sources, and gates at which bodies are counted or leave.
//!
//! Before a step walls open and bodies come; after it those that have passed a gate are counted, and those beyond a sink leave. A
//! body keeps its number when others leave, and numbers are not given again.

mod entry;
mod source;

pub use entry::{GateEntry, SourceEntry};

use femdem_mesh::Vector3;
use femdem_view::output::csv::quoted;
use serde::{Deserialize, Serialize};

use super::build::in_entry;
use super::history::number;
use super::{Member, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;
use source::Supply;

/// Columns of `flow.csv`.
pub const FLOW_COLUMNS: [&str; 5] = ["time", "name", "bodies", "mass", "rate"];

/// What comes, goes and is counted in a simulation, and which walls open.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    openings: Vec<Opening>,
    gates: Vec<Gate>,
    pub(super) supplies: Vec<Supply>,
}

/// A wall that is taken away at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Opening {
    /// Number in the world.
    wall: u32,
    /// s.
    time: f64,
}

/// A place that bodies pass, in one direction or in the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Gate {
    name: String,
    /// Whether bodies leave there.
    takes: bool,
    /// Unit normals and offsets \[m\]; what is below any of these is beyond.
    planes: Vec<([f64; 3], f64)>,
    passed: Count,
    /// Of each member, whether it is beyond.
    beyond: Vec<bool>,
}

/// What has passed so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Count {
    bodies: i64,
    /// kg.
    mass: f64,
    /// Mass \[kg\] and time \[s\] of the last row.
    last: [f64; 2],
}

impl Count {
    fn add(&mut self, bodies: i64, mass: f64) {
        self.bodies += bodies;
        self.mass += bodies as f64 * mass;
    }

    /// A row of the table; the rate is that since the last one.
    fn row(&mut self, name: &str, time: f64) -> Vec<String> {
        let [mass, before] = self.last;
        let rate = match time > before {
            true => (self.mass - mass) / (time - before),
            false => 0.0,
        };
        self.last = [self.mass, time];
        let mut row = vec![number(time), quoted(name), self.bodies.to_string()];
        row.extend([self.mass, rate].map(number));
        row
    }
}

impl Gate {
    fn is_beyond(&self, x: &Vector3) -> bool {
        let below = |(normal, offset): &([f64; 3], f64)| Vector3::from(*normal).dot(x) < *offset;
        self.planes.iter().any(below)
    }
}

impl Flow {
    /// Whether there is anything to be counted.
    pub(super) fn is_counted(&self) -> bool {
        !(self.gates.is_empty() && self.supplies.is_empty())
    }

    /// Rows of `flow.csv`: gates, then sources.
    pub(super) fn rows(&mut self, time: f64) -> Vec<Vec<String>> {
        let gates = self.gates.iter_mut();
        let gates = gates.map(|gate| gate.passed.row(&gate.name, time));
        let supplies = self.supplies.iter_mut();
        let supplies = supplies.map(|supply| supply.come.row(&supply.name, time));
        gates.chain(supplies).collect()
    }

    /// Mass of the bodies that are still to come \[kg\].
    pub(super) fn mass_to_come(&self) -> f64 {
        self.supplies.iter().map(Supply::mass_to_come).sum()
    }

    /// Corners of the boxes in which bodies are still to come \[m\].
    pub(super) fn boxes(&self) -> impl Iterator<Item = [Vector3; 2]> {
        let open = self.supplies.iter().filter(|s| s.mass_to_come() > 0.0);
        open.map(|supply| [supply.lower.into(), supply.upper.into()])
    }

    /// The last time at which a wall opens or a body may come \[s\].
    pub(super) fn settled_from(&self) -> f64 {
        let openings = self.openings.iter().map(|opening| opening.time);
        let supplies = self.supplies.iter().map(Supply::settled_from);
        openings.chain(supplies).fold(0.0, f64::max)
    }
}

impl Scenario {
    /// Refuses times of openings that cannot be or have no effect.
    pub(super) fn check_openings(&self) -> Result<(), Error> {
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
    pub(super) fn set_openings(&mut self, scene: &Scenario) {
        let entries = scene.wall.iter().zip(&self.origin.walls);
        let openings = entries.flat_map(|(entry, walls)| {
            let time = entry.opens;
            let opening = move |&wall: &u32| Some(Opening { wall, time: time? });
            walls.iter().filter_map(opening)
        });
        self.flow.openings = openings.collect();
    }

    /// Begins the gates and sources of a scene, at the present time.
    pub(super) fn set_flow(&mut self, scene: &Scenario) -> Result<(), Error> {
        let mut names = std::collections::BTreeSet::new();
        let mut named = |given: &str, kind: &str, number: usize| {
            let name = match given {
                "" => format!("{kind} {number}"),
                given => given.to_owned(),
            };
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
            let supply = self.supply(scene, entry, &name);
            let supply = supply.map_err(in_entry(format!("source \"{name}\"")))?;
            flow.supplies.push(supply);
        }
        self.flow = flow;
        self.set_openings(scene);
        Ok(())
    }

    /// Whether there are, were or will be rigid bodies.
    pub(super) fn has_rigid(&self) -> bool {
        // Deformable bodies stay.
        self.members.len() > self.world.deformable_count() || !self.flow.supplies.is_empty()
    }

    /// Takes away the walls whose time has come.
    pub(super) fn open_walls(&mut self) -> Result<(), Error> {
        let time = self.world.time();
        let due = self.flow.openings.iter();
        let due: Vec<u32> = due
            .filter(|opening| opening.time <= time)
            .map(|opening| opening.wall)
            .collect();
        for wall in due {
            if self.world.wall(wall).is_some() {
                self.world.remove_wall(wall)?;
            }
        }
        Ok(())
    }

    /// Counts the bodies that have passed gates, and takes away those that are beyond a sink.
    pub(super) fn pass_gates(&mut self) -> Result<(), Error> {
        for k in 0..self.flow.gates.len() {
            for number in 0..self.members.len() {
                let id = self.members[number].id;
                // Bodies that have left, and those that move as prescribed, pass nothing; deformable ones stay.
                let (Some(x), Some(mass)) = (self.world.position(id), self.world.mass(id)) else {
                    continue;
                };
                if self.world.follows_drive(id) == Some(true) {
                    continue;
                }
                let gate = &mut self.flow.gates[k];
                let is_beyond = gate.is_beyond(&x);
                if gate.takes {
                    if is_beyond && self.world.follows_drive(id).is_some() {
                        gate.passed.add(1, mass);
                        self.world.remove_body(id)?;
                        self.members[number].id = Member::GONE;
                    }
                } else if is_beyond != gate.beyond[number] {
                    gate.passed.add(if is_beyond { 1 } else { -1 }, mass);
                    gate.beyond[number] = is_beyond;
                }
            }
        }
        Ok(())
    }
}
