//! Flow in a step: walls open, bodies come, are counted and leave.

use femdem_contact::BodyId;
use femdem_mesh::Vector3;
use femdem_solve::{Alone, World};
use serde::{Deserialize, Serialize};

use super::state::Flow;
use crate::Error;
use crate::run::{Member, Simulation};

/// That a body has passed a gate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Passage {
    /// Numbers among the gates and the members.
    gate: u32,
    member: u32,
    /// kg.
    mass: f64,
    is_beyond: bool,
}

impl Flow {
    /// The walls that are there and whose time has come.
    pub(super) fn walls_due(&self, world: &World) -> Vec<u32> {
        let due = self.openings.iter();
        let due = due.filter(|opening| opening.time <= world.time());
        due.map(|opening| opening.wall)
            .filter(|wall| world.wall(*wall).is_some())
            .collect()
    }

    /// What bodies have passed since the last step: numbers among the members, and those in the world.
    pub(super) fn passages(
        &self,
        world: &World,
        bodies: impl Iterator<Item = (usize, BodyId)>,
    ) -> Vec<Passage> {
        let mut passages = Vec::new();
        if self.gates.is_empty() {
            return passages;
        }
        for (member, id) in bodies {
            // Bodies that have left, and those that move as prescribed, pass nothing; deformable and adaptive ones stay.
            let (Some(x), Some(mass)) = (world.position(id), world.mass(id)) else {
                continue;
            };
            if world.follows_drive(id) == Some(true) {
                continue;
            }
            let stays = world.is_adaptive(id) || world.follows_drive(id).is_none();
            for (number, gate) in (0..).zip(&self.gates) {
                let is_beyond = gate.is_beyond(&x);
                let passes = match gate.takes {
                    true => is_beyond && !stays,
                    false => is_beyond != gate.beyond[member],
                };
                if passes {
                    passages.push(Passage {
                        gate: number,
                        member: member as u32,
                        mass,
                        is_beyond,
                    });
                }
                if passes && gate.takes {
                    break;
                }
            }
        }
        passages
    }

    /// Counts what has passed until a time \[s\], and returns the bodies that leave.
    pub(super) fn pass(
        &mut self,
        mut passages: Vec<Passage>,
        members: &mut [Member],
        time: f64,
    ) -> Vec<BodyId> {
        passages.sort_by_key(|passage| (passage.gate, passage.member));
        let mut gone = Vec::new();
        for passage in passages {
            let gate = &mut self.gates[passage.gate as usize];
            let bodies = if passage.is_beyond { 1 } else { -1 };
            gate.passed.add(bodies, passage.mass, time);
            if gate.takes {
                let member = &mut members[passage.member as usize];
                gone.push(std::mem::replace(&mut member.id, Member::GONE));
            } else {
                gate.beyond[passage.member as usize] = passage.is_beyond;
            }
        }
        gone
    }

    /// Notes a new member at a place \[m\], which has passed the same gates as another one, if that is known.
    pub(super) fn note_member(&mut self, x: &Vector3, like: Option<usize>) {
        for gate in &mut self.gates {
            let known = like.and_then(|other| gate.beyond.get(other).copied());
            let is_beyond = known.unwrap_or_else(|| gate.is_beyond(x));
            gate.beyond.push(is_beyond);
        }
    }
}

impl Simulation {
    /// Whether there are, were or will be rigid bodies.
    pub(in crate::run) fn has_rigid(&self) -> bool {
        self.has_adaptive() || self.has_rigid_beside(self.world.deformable_count())
    }

    /// The same beside so many deformable bodies, which stay.
    pub(in crate::run) fn has_rigid_beside(&self, deformable: usize) -> bool {
        self.members.len() > deformable || !self.flow.supplies.is_empty()
    }

    /// Takes away the walls whose time has come.
    pub(in crate::run) fn open_walls(&mut self) -> Result<(), Error> {
        let due = self.flow.walls_due(&self.world);
        Ok(self.world.remove_walls_on(&due, &mut Alone)?)
    }

    /// Counts the bodies that have passed gates, and takes away those that are beyond a sink.
    pub(in crate::run) fn pass_gates(&mut self) -> Result<(), Error> {
        let bodies = self.members.iter().map(|member| member.id);
        let passages = self.flow.passages(&self.world, bodies.enumerate());
        let time = self.world.time();
        let gone = self.flow.pass(passages, &mut self.members, time);
        Ok(self.world.remove_bodies_on(&gone, &mut Alone)?)
    }

    /// Adds the bodies of sources that are due and for which there is room.
    pub(in crate::run) fn bring_bodies(&mut self) -> Result<(), Error> {
        let count = self.members.len();
        let new = self.flow.bring(&mut self.world, count, &mut Alone)?;
        for member in new {
            self.loads.add_member(&member);
            self.members.push(member);
        }
        Ok(())
    }

    /// Bodies that sources will have brought by a time \[s\], if there is room for them.
    #[must_use]
    pub fn bodies_due(&self, time: f64) -> u64 {
        self.flow.due(time)
    }

    /// Bodies that sources have brought so far.
    #[must_use]
    pub fn bodies_come(&self) -> u64 {
        self.flow.come()
    }

    /// Says which sources have brought fewer bodies than are due.
    pub(in crate::run) fn missing_bodies(&self) -> impl Iterator<Item = String> {
        let time = self.world.time();
        self.flow.supplies.iter().filter_map(move |supply| {
            let (due, come) = (supply.due(time), supply.come.bodies);
            let name = &supply.name;
            (due > come as u64).then(|| {
                format!("source {name} has brought {come} of the {due} bodies that are due: there was no room for more")
            })
        })
    }

    /// Makes members of the fragments that have become bodies.
    pub(in crate::run) fn fragment_bodies(&mut self) -> Result<(), Error> {
        let fragmentations = self.world.fragment_bodies();
        for fragmentation in fragmentations.map_err(|source| self.named(source))? {
            let Some(whole) = self.member_of(fragmentation.body) else {
                continue;
            };
            for id in fragmentation.fragments {
                let member = Member::fragment(&self.members, whole, id);
                let x = self.world.position(id).unwrap_or_default();
                self.flow.note_member(&x, Some(whole));
                self.loads.add_member(&member);
                self.members.push(member);
            }
        }
        Ok(())
    }
}
