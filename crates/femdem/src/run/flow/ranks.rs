//! Flow over ranks: all have the same, and each sees what its own bodies do.

use femdem_solve::{Halo, SolveError, World, checkpoint};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::state::Flow;
use crate::Error;
use crate::run::load::LoadedMembers;
use crate::run::{Member, Simulation};

/// No member.
const NONE: u32 = u32::MAX;

/// The flow of a run over ranks, with the members of the run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::run) struct SharedFlow {
    flow: Flow,
    /// None where nothing is counted.
    members: Vec<Member>,
    /// The members of bodies, by their numbers in the whole.
    of_bodies: Vec<u32>,
}

impl SharedFlow {
    pub fn of(simulation: &Simulation) -> Self {
        let flow = simulation.flow.clone();
        let counted = flow.is_counted().then_some(&simulation.members);
        let mut shared = Self {
            flow,
            members: Vec::new(),
            of_bodies: Vec::new(),
        };
        for member in counted.into_iter().flatten() {
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

    /// After a step: counts the bodies that have passed gates, and takes away those that are beyond a sink.
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

/// The items of all ranks, by rank.
pub(super) fn of_all<T: Serialize + DeserializeOwned>(
    own: Vec<T>,
    halo: &mut dyn Halo,
) -> Result<Vec<T>, SolveError> {
    let mut count = [own.len() as u64];
    halo.sum(&mut count)?;
    if count[0] == 0 || halo.size() == 1 {
        return Ok(own);
    }
    let mut messages = Vec::new();
    if !own.is_empty() {
        let bytes = checkpoint::encode(&own)?;
        messages.extend((0..halo.size()).map(|rank| (rank, bytes.clone())));
    }
    let mut all = Vec::new();
    for (_, bytes) in halo.send(messages)? {
        let part: Vec<T> = checkpoint::decode(&bytes)?;
        all.extend(part);
    }
    Ok(all)
}
