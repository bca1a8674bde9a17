//! The bodies of a rank as a simulation.

use femdem_contact::BodyId;
use femdem_mesh::{Pose, Vector3};
use femdem_solve::World;
use serde::{Deserialize, Serialize};

use crate::run::{Controls, Member, NamedWall, Simulation, Support};

/// Walls and supports of a run, which all ranks know.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Fixtures {
    walls: Vec<NamedWall>,
    /// With the numbers of their bodies in the whole.
    supports: Vec<(BodyId, Support)>,
    /// The middle of the periodic cell \[m\].
    centre: Vector3,
}

impl Fixtures {
    pub fn of(simulation: &Simulation) -> Self {
        let supports = simulation.supports.iter().map(|support| {
            let member = simulation.members.get(support.member);
            (member.map_or(Member::GONE, |m| m.id), support.clone())
        });
        Self {
            walls: simulation.walls.clone(),
            supports: supports.collect(),
            centre: simulation.centre,
        }
    }

    /// Whether nodes of bodies are held.
    pub fn hold(&self) -> bool {
        !self.supports.is_empty()
    }

    /// The bodies of a world, guests too, as members without names, ascending, with what measures them.
    pub fn simulation(&self, world: World, controls: &Controls) -> Simulation {
        let member = |id| Member {
            name: String::new(),
            id,
            placed: Pose::identity(),
            of: None,
        };
        let members: Vec<Member> = world.body_ids().map(member).collect();
        let supports = self.supports.iter().map(|(number, support)| {
            let id = world.number_here(*number);
            let at = id.map(|id| members.binary_search_by_key(&id, |member| member.id));
            Support {
                // None is of a body that is not here.
                member: at.and_then(Result::ok).unwrap_or(usize::MAX),
                ..support.clone()
            }
        });
        Simulation {
            supports: supports.collect(),
            world,
            members,
            walls: self.walls.clone(),
            controls: controls.clone(),
            centre: self.centre,
            flow: Default::default(),
            loads: Default::default(),
            penalty: Default::default(),
            origin: Default::default(),
            fidelity: Default::default(),
            notes: Vec::new(),
        }
    }
}
