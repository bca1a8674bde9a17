//! What `members.csv` says of all members.

use femdem_contact::BodyId;
use femdem_solve::Halo;

use super::Simulation;
use super::history::MemberState;
use crate::Error;
use crate::gather::by_slices;

impl Simulation {
    /// What `members.csv` says of each member that is there; this has all of them.
    pub(super) fn member_states(
        &self,
        mut take: impl FnMut(usize, MemberState) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let forces = self.forces(&self.contacts()).members;
        for (at, (member, force)) in self.members.iter().zip(&forces).enumerate() {
            if let Some(state) = MemberState::of(&self.world, member.id, force) {
                take(at, state)?;
            }
        }
        Ok(())
    }

    /// The same of the members with these numbers of bodies in the whole, which the first rank names and others have, each its
    /// own, ascending by their numbers here; `take` gets places among the numbers.
    pub(super) fn member_states_on(
        &self,
        numbers: &[BodyId],
        halo: &mut dyn Halo,
        take: impl FnMut(usize, MemberState) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let forces = self.forces(&self.contacts()).members;
        let of = |number| {
            let id = self.world.number_here(number)?;
            let own = (!self.world.is_guest(id)).then_some(id)?;
            let at = self.members.binary_search_by_key(&own, |member| member.id);
            MemberState::of(&self.world, own, &forces[at.ok()?])
        };
        by_slices(numbers, halo, of, take)
    }
}
