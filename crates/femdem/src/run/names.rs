//! Names of the entries of a scene, which identify them in the results.

use std::collections::BTreeSet;

use super::Simulation;
use crate::Error;
use crate::error::wrong;

/// Names that are taken.
#[derive(Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// The given name, which must be free, or the default with a number if that is taken.
    pub fn of(&mut self, what: &'static str, given: &str, default: &str) -> Result<String, Error> {
        let name = if given.is_empty() {
            let numbered = (2..).map(|k| format!("{default} ({k})"));
            let mut free = std::iter::once(default.to_owned()).chain(numbered);
            free.find(|name| !self.0.contains(name)).unwrap_or_default()
        } else {
            given.to_owned()
        };
        if !self.0.insert(name.clone()) {
            let allowed = match what {
                "wall" => "another wall has it: give each its own",
                _ => "another body has it: give each its own",
            };
            return Err(wrong("name", &format!("\"{name}\""), allowed));
        }
        Ok(name)
    }
}

/// Refuses equal names in the results: copies of a body and walls of a box have names derived from the given
/// one, and a support is named after its body and itself.
pub(super) fn check_names(simulation: &Simulation) -> Result<(), Error> {
    let members = &simulation.members;
    let bodies = members.iter().map(|member| member.name.clone());
    let walls = simulation.world.walls();
    let walls = walls.map(|(_, wall)| wall.name().to_owned());
    let supports = simulation.supports.iter().filter_map(|support| {
        let body = members.get(support.member)?;
        Some(format!("{} {}", body.name, support.name))
    });
    let copies = "a copy of another body has it: give each its own";
    own_names(bodies, copies)?;
    own_names(walls, "a side of another wall has it: give each its own")?;
    let together =
        "the names of another body and of what holds it read the same: give each its own";
    own_names(supports, together)
}

fn own_names(names: impl Iterator<Item = String>, allowed: &'static str) -> Result<(), Error> {
    let mut known = BTreeSet::new();
    for name in names {
        if !known.insert(name.clone()) {
            return Err(wrong("name", &format!("\"{name}\""), allowed));
        }
    }
    Ok(())
}
