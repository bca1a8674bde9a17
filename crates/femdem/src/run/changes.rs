//! What differs between two scenes, and what of it a state can take.

use std::collections::BTreeSet;
use std::path::Path;

use femdem_contact::BodyId;
use toml::{Table, Value};

use super::loads::Loads;
use super::words::KEYS;
use super::{ControlEntry, MotionEntry, Scenario, Simulation};
use crate::{Error, toml_file};

/// Keys that say how a run is written down and when it ends.
const OF_OUTPUT: [&str; 13] = [
    "title",
    "duration",
    "every",
    "history-every",
    "track",
    "pictures",
    "tables",
    "rest",
    "until",
    "relax",
    "energy-error-limit",
    "threads",
    "checkpoint-every",
];

/// Keys that change the motion of the bodies that are there.
const OF_MOTION: [&str; 8] = [
    "gravity",
    "load",
    "contact",
    "pair",
    "time-step",
    "medium",
    "sleeping",
    "sleeping-deformables",
];

/// Keys of what comes and goes: a run goes on with those that it has, and one that starts has its own.
const OF_FLOW: [&str; 3] = ["source", "sink", "gauge"];

/// A key that differs between two scenes.
#[derive(Debug, PartialEq)]
pub(super) struct Change {
    /// The key at the top of the scene, such as "contact" or "body".
    pub top: String,
    /// Of a wall or a body: its number, from 0, and the key in its entry.
    pub entry: Option<(usize, String)>,
    /// The whole, for people.
    pub name: String,
}

impl Change {
    fn new(top: &str, name: String) -> Self {
        Self {
            top: top.to_owned(),
            entry: None,
            name,
        }
    }

    fn is_among(&self, keys: &[&str]) -> bool {
        keys.contains(&&*self.top)
    }

    /// Whether it is the motion of a wall or of a rigid body, the control or opening of a wall, or the control of the periodic cell.
    fn is_drive(&self) -> bool {
        let keys = ["motion", "control", "opens"];
        let of_entry = matches!(&self.entry, Some((_, key)) if keys.contains(&&**key));
        of_entry || self.name == "cell.control"
    }

    /// Whether it changes the motion of the bodies.
    pub fn moves(&self) -> bool {
        self.is_drive() || self.is_among(&OF_MOTION)
    }

    /// Whether a run can go on with it.
    pub fn can_be_applied(&self) -> bool {
        self.moves() || self.is_among(&OF_OUTPUT)
    }

    /// Whether a new run with it can start from a state; `scene` is that of the new run.
    pub fn can_be_started(&self, scene: &Scenario) -> bool {
        let of_run = self.is_among(&["out", "from"]) || self.is_among(&OF_FLOW);
        let body = |i: usize| scene.body.get(i);
        let of_state = match &self.entry {
            Some((_, key)) if key == "boundary" => true,
            // The state has the velocity.
            Some((i, key)) if key == "velocity" => body(*i).is_some_and(|b| b.velocity == [0.0; 3]),
            Some((i, key)) if key == "spin" => body(*i).is_some_and(|b| b.spin == [0.0; 3]),
            _ => false,
        };
        of_run || of_state || self.can_be_applied()
    }
}

/// The keys that differ, by name.
pub(super) fn changes(old: &Scenario, new: &Scenario) -> Result<Vec<Change>, Error> {
    let (old, new) = (table(old)?, table(new)?);
    let mut changes = Vec::new();
    for top in keys(&old, &new) {
        match (old.get(top), new.get(top)) {
            (a, b) if a == b => {}
            (Some(Value::Table(a)), Some(Value::Table(b))) => {
                let parts = keys(a, b)
                    .into_iter()
                    .filter(|key| a.get(*key) != b.get(*key));
                changes.extend(parts.map(|key| Change::new(top, format!("{top}.{key}"))));
            }
            (Some(Value::Array(a)), Some(Value::Array(b))) if are_entries(a) && are_entries(b) => {
                changes.extend(of_entries(top, a, b));
            }
            _ => changes.push(Change::new(top, top.to_owned())),
        }
    }
    Ok(changes)
}

fn table(scenario: &Scenario) -> Result<Table, Error> {
    toml_file::parse(&scenario.to_toml()?, Path::new("scenario"))
}

fn keys<'a>(a: &'a Table, b: &'a Table) -> BTreeSet<&'a str> {
    a.keys().chain(b.keys()).map(String::as_str).collect()
}

fn are_entries(list: &[Value]) -> bool {
    list.iter().all(Value::is_table)
}

/// The keys that differ in lists of walls or bodies.
fn of_entries(top: &str, old: &[Value], new: &[Value]) -> Vec<Change> {
    if old.len() != new.len() {
        let name = format!(
            "the number of [[{top}]] from {} to {}",
            old.len(),
            new.len()
        );
        return vec![Change::new(top, name)];
    }
    let mut changes = Vec::new();
    for (i, pair) in old.iter().zip(new).enumerate() {
        let (Value::Table(a), Value::Table(b)) = pair else {
            continue;
        };
        let parts = keys(a, b)
            .into_iter()
            .filter(|key| a.get(*key) != b.get(*key));
        changes.extend(parts.map(|key| Change {
            entry: Some((i, key.to_owned())),
            ..Change::new(top, format!("[[{top}]] number {} ({key})", i + 1))
        }));
    }
    changes
}

impl Simulation {
    /// Sets the rigid bodies free that have a prescribed motion in the old scene, but none in the new one.
    pub(super) fn set_free(&mut self, old: &Scenario, new: &Scenario) -> Result<(), Error> {
        for (id, motion) in self.new_motions(old, new)? {
            if motion.is_none() && self.world.body_drive(id).is_some() {
                self.world.drive_body(id, None)?;
            }
        }
        Ok(())
    }

    /// Replaces the settings of the world and the motions of walls and rigid bodies in which two scenes differ. Motions
    /// count from where things are now.
    pub(super) fn change(&mut self, old: &Scenario, new: &Scenario) -> Result<(), Error> {
        let set = self.set(old, new).and_then(|()| self.drive(old, new));
        let set = set.and_then(|()| Loads::of(new, self).bound_step(self));
        set.map_err(|error| error.by_keys(&KEYS))
    }

    fn set(&mut self, old: &Scenario, new: &Scenario) -> Result<(), Error> {
        let wanted = new.parameters();
        if old.gravity != new.gravity {
            self.world.set_gravity(wanted.gravity)?;
        }
        if old.contact != new.contact {
            let depth = |scene: &Scenario| (scene.contact.penalty, scene.contact.penetration);
            let mut contact = wanted.contact;
            // A penalty that was chosen stays, unless the scene asks for another.
            if new.contact.penalty.is_none() {
                contact.penalty = self.penalty.value;
            }
            self.world.set_contact(contact)?;
            if depth(old) != depth(new) {
                let loads = Loads::of(new, self);
                new.set_penalty(self, &loads)?;
            }
        }
        new.set_pairs(self)?;
        let world = &mut self.world;
        world.set_time_step(wanted.time_step)?;
        if old.medium != new.medium {
            world.set_medium(wanted.medium)?;
        }
        let sleep = |scene: &Scenario| (scene.sleeping, scene.sleeping_deformables);
        if sleep(old) != sleep(new) {
            world.set_sleep_rule(wanted.sleeping)?;
        }
        Ok(())
    }

    fn drive(&mut self, old: &Scenario, new: &Scenario) -> Result<(), Error> {
        let entries = old.wall.iter().zip(&new.wall);
        for ((old, new), walls) in entries.zip(&self.origin.walls) {
            let changed = old.motion != new.motion || old.control != new.control;
            let there = |wall: &&u32| changed && self.world.wall(**wall).is_some();
            let walls: Vec<u32> = walls.iter().filter(there).copied().collect();
            for wall in walls {
                let drive = new.motion.map(|motion| motion.drive()).unwrap_or_default();
                self.world.drive_wall(wall, drive)?;
            }
        }
        let controls = |scene: &Scenario| -> Vec<Option<ControlEntry>> {
            let of_cell = scene.cell.iter().map(|cell| cell.control.clone());
            let of_walls = scene.wall.iter().map(|wall| wall.control.clone());
            of_walls.chain(of_cell).collect()
        };
        // A run that starts from another one has none yet.
        let wanted = new.controls().next().is_some() || new.cell.is_some();
        let lacks = self.controls.is_empty() && wanted;
        if lacks || controls(old) != controls(new) {
            self.control(new)?;
        }
        self.set_openings(new);
        if old.load != new.load {
            self.set_loads(new)?;
        }
        self.set_free(old, new)?;
        for (id, motion) in self.new_motions(old, new)? {
            if let Some(motion) = motion {
                self.world.drive_body(id, Some(motion.drive()))?;
            }
        }
        Ok(())
    }

    /// The rigid bodies whose motion differs between two scenes of the same bodies, with the new one.
    fn new_motions(
        &self,
        old: &Scenario,
        new: &Scenario,
    ) -> Result<Vec<(BodyId, Option<MotionEntry>)>, Error> {
        let own = self.members.iter().skip(self.origin.bodies);
        let (mut found, mut members) = (Vec::new(), own);
        let entries = old.body.iter().zip(&new.body);
        for ((old, new), &count) in entries.zip(&self.origin.members) {
            for member in members.by_ref().take(count) {
                // One that has left is neither.
                let is_rigid = self.world.follows_drive(member.id).is_some();
                if is_rigid && old.motion != new.motion {
                    found.push((member.id, new.motion));
                }
            }
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "duration = 1
        contact.friction = 0.5
        [material.m]
        density = 1000
        [[wall]]
        plane = { normal = [0, 0, 1] }
        [[body]]
        shape = \"cube\"
        size = 0.1
        material = \"m\"
        velocity = [1, 0, 0]
        [[body]]
        shape = \"cube\"
        size = 0.2
        material = \"m\"
        position = [0, 0, 1]
        ";

    fn scene(from: &str, to: &str) -> Scenario {
        assert!(SCENE.contains(from), "{from}");
        Scenario::from_toml(&SCENE.replacen(from, to, 1)).unwrap()
    }

    #[test]
    fn changes_have_the_names_of_their_keys() {
        let old = scene("", "");
        assert_eq!(changes(&old, &old).unwrap(), []);
        // Name, whether a run goes on with it, whether a run starts with it.
        for (from, to, name, applied, started) in [
            ("duration = 1", "duration = 2", "duration", true, true),
            (
                "friction = 0.5",
                "damping = 0.5\ncontact.friction = 0.5",
                "contact.damping",
                true,
                true,
            ),
            (
                "duration = 1",
                "rest = { energy = 1, time = 1 }",
                "rest",
                true,
                true,
            ),
            ("duration = 1", "out = \"there\"", "out", false, true),
            (
                "density = 1000",
                "density = 1001",
                "material.m",
                false,
                false,
            ),
            (
                "plane = {",
                "motion = { linear = { velocity = [1, 0, 0] } }\nplane = {",
                "[[wall]] number 1 (motion)",
                true,
                true,
            ),
            (
                "0, 1] }",
                "1, 1] }",
                "[[wall]] number 1 (plane)",
                false,
                false,
            ),
            (
                "size = 0.2",
                "size = 0.3",
                "[[body]] number 2 (size)",
                false,
                false,
            ),
            (
                "velocity = [1, 0, 0]",
                "",
                "[[body]] number 1 (velocity)",
                false,
                true,
            ),
            (
                "velocity = [1, 0, 0]",
                "velocity = [2, 0, 0]",
                "[[body]] number 1 (velocity)",
                false,
                false,
            ),
            (
                "[[body]]",
                "[[wall]]\nplane = { normal = [0, 1, 0] }\n[[body]]",
                "the number of [[wall]] from 1 to 2",
                false,
                false,
            ),
        ] {
            let new = scene(from, to);
            let all = changes(&old, &new).unwrap();
            let found: Vec<&Change> = all
                .iter()
                .filter(|c| c.top != "duration" || name == "duration")
                .collect();
            assert_eq!(found.len(), 1, "{to}: {all:?}");
            assert_eq!(found[0].name, name);
            assert_eq!(found[0].can_be_applied(), applied, "{name}");
            assert_eq!(found[0].can_be_started(&new), started, "{name}");
        }
    }
}
