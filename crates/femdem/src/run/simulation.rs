//! A world made from a scenario, and what its entries are in it.

use femdem_mesh::Vector3;
use femdem_solve::{SolveError, World};
use serde::{Deserialize, Serialize};

use super::origin::Origin;
use super::{BodyLoads, Controls, FidelityRecord, Flow, Member};
use crate::scene::ShapeNote;

/// A wall of a simulation. It stays among the walls when it has been taken away.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct NamedWall {
    /// Its name.
    pub name: String,
    /// Its index in the world, while it is there.
    pub id: u32,
}

/// A world made from a scenario.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Simulation {
    /// The world.
    pub world: World,
    /// Its bodies, in the order of the scenario.
    pub members: Vec<Member>,
    /// The walls with which it began, ascending by index.
    pub walls: Vec<NamedWall>,
    /// The supports of deformable bodies, in the same order.
    pub supports: Vec<Support>,
    /// Its controlled walls.
    pub controls: Controls,
    /// The middle of its periodic cell, which stays where it is \[m\].
    pub centre: Vector3,
    /// What comes, goes and is counted.
    pub flow: Flow,
    /// The loads on its bodies.
    pub loads: BodyLoads,
    /// The penalty of its contacts between rigid bodies.
    pub penalty: Penalty,
    /// What it has from a pack, and which walls its scene has added.
    pub origin: Origin,
    /// What has become of its adaptive bodies.
    pub fidelity: FidelityRecord,
    /// How surface files were read and bodies meshed, each once. Not stored: it belongs to making the simulation.
    #[serde(skip)]
    pub notes: Vec<ShapeNote>,
}

/// The stored form of a simulation, before its world is rebuilt.
#[derive(Deserialize)]
struct Stored {
    world: World,
    members: Vec<Member>,
    walls: Vec<NamedWall>,
    supports: Vec<Support>,
    controls: Controls,
    centre: Vector3,
    flow: Flow,
    loads: BodyLoads,
    penalty: Penalty,
    origin: Origin,
    fidelity: FidelityRecord,
}

impl TryFrom<Stored> for Simulation {
    type Error = SolveError;

    fn try_from(stored: Stored) -> Result<Self, SolveError> {
        let Stored {
            mut world,
            members,
            walls,
            supports,
            controls,
            centre,
            flow,
            loads,
            penalty,
            origin,
            fidelity,
        } = stored;
        world.restore()?;
        let none = |what, index, count| Err(SolveError::NoSuch { what, index, count });
        for (member, number) in members.iter().zip(0..) {
            let is_whole = |first: u32| first < number && members[first as usize].of.is_none();
            if let Some(first) = member.of.filter(|first| !is_whole(*first)) {
                return none(
                    "body that fragments broke off",
                    first as usize,
                    number as usize,
                );
            }
        }
        if let Some(known) = flow.misfit(members.len()) {
            return none("body that a gauge has seen", known, members.len());
        }
        let shapes = world.shapes().len();
        if let Some(source) = flow.misfit_source(shapes) {
            return none("shape of the bodies of a source", source, shapes);
        }
        if let Some([load, count]) = loads.misfit() {
            return none("load on a body", load, count);
        }
        Ok(Self {
            world,
            members,
            walls,
            supports,
            controls,
            centre,
            flow,
            loads,
            penalty,
            origin,
            fidelity,
            notes: Vec::new(),
        })
    }
}

/// The nodes of a body that a boundary condition holds or moves.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Support {
    /// Number of the body among the members.
    pub member: usize,
    /// Name of the condition.
    pub name: String,
    /// Nodes and directions of the world (0 to 2), ascending.
    pub holds: Vec<(u32, u8)>,
}

/// A penalty and why it was chosen.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Penalty {
    /// Pa.
    pub value: f64,
    /// Why it has this value, for people.
    pub reason: String,
}
