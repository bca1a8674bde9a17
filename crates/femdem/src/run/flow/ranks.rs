//! Flow over ranks: all have the same, and each sees what its own bodies do.

use femdem_mesh::Vector3;
use femdem_solve::{Halo, World};
use serde::{Deserialize, Serialize};

use super::state::Flow;
use crate::Error;
use crate::gather::of_all;
use crate::run::load::LoadedMembers;
use crate::run::{Member, Simulation};

/// No member.
const NONE: u32 = u32::MAX;

/// The flow of a run over ranks, with the members of the run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::run) struct SharedFlow {
    flow: Flow,
    /// None where nothing is counted and no body may break.
    members: Vec<Member>,
    /// The members of bodies, by their numbers in the whole.
    of_bodies: Vec<u32>,
}

impl SharedFlow {
    pub fn of(simulation: &Simulation, may_break: bool) -> Self {
        let flow = simulation.flow.clone();
        let is_listed = flow.is_counted() || may_break;
        let listed = is_listed.then_some(&simulation.members);
        let mut shared = Self {
            flow,
            members: Vec::new(),
            of_bodies: Vec::new(),
        };
        for member in listed.into_iter().flatten() {
            shared.add(member.clone());
        }
        shared
    }

    fn add(&mut self, member: Member) {
        if member.id != Member::GONE {
            let id = member.id as usize;
            let length = self.of_bodies.len().max(id + 1);
            self.of_bodies.resize(length, NONE);
            self.of_bodies[id] = self.members.len() as u32;
        }
        self.members.push(member);
    }

    /// Before a step: opens the walls that are due, and brings bodies.
    pub fn begin_step(
        &mut self,
        world: &mut World,
        loads: &mut LoadedMembers,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        let due = self.flow.walls_due(world);
        if !due.is_empty() {
            world.remove_walls_on(&due, halo)?;
        }
        for member in self.flow.bring(world, self.members.len(), halo)? {
            loads.add(&member);
            self.add(member);
        }
        Ok(())
    }

    /// After a step: makes members of the fragments that have become bodies.
    pub fn fragment_bodies(
        &mut self,
        world: &mut World,
        loads: &mut LoadedMembers,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        for fragmentation in world.fragment_bodies_on(halo)? {
            let whole = self.of_bodies.get(fragmentation.body as usize);
            let Some(&whole) = whole.filter(|member| **member != NONE) else {
                continue;
            };
            for id in fragmentation.fragments {
                let member = Member::fragment(&self.members, whole as usize, id);
                // It has passed what the body has passed, wherever it is.
                self.flow
                    .note_member(&Vector3::zeros(), Some(whole as usize));
                loads.add(&member);
                self.add(member);
            }
        }
        Ok(())
    }

    /// After that: counts the bodies that have passed gates, and takes away those that are beyond a sink.
    pub fn end_step(
        &mut self,
        world: &mut World,
        loads: &mut LoadedMembers,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        if !self.flow.has_gates() {
            return Ok(());
        }
        let own = world.own_bodies(0).filter_map(|id| {
            let number = world.number_in_whole(id)?;
            let member = *self.of_bodies.get(number as usize)?;
            (member != NONE).then_some((member as usize, id))
        });
        let passages = of_all(self.flow.passages(world, own), halo)?;
        let gone = self.flow.pass(passages, &mut self.members, world.time());
        if !gone.is_empty() {
            loads.forget(&gone);
            world.remove_bodies_on(&gone, halo)?;
        }
        Ok(())
    }

    /// Whether a wall is still to open after a time \[s\], or a body to come.
    pub fn is_to_come(&self, time: f64) -> bool {
        self.flow.is_to_come(time)
    }

    /// Tells the run what has come and gone since it was last told.
    pub fn give_back(&self, simulation: &mut Simulation) {
        simulation.flow.go_on_as(&self.flow);
        let mut members = self.members.iter();
        for (known, member) in simulation.members.iter_mut().zip(members.by_ref()) {
            known.id = member.id;
        }
        for member in members {
            simulation.loads.add_member(member);
            simulation.members.push(member.clone());
        }
    }
}
