//! What the tables say of all bodies of a run: sums that are the same for any number of ranks, but for energies.

use femdem_contact::{BodyId, ExactSum};
use femdem_mesh::Vector3;
use femdem_solve::{Halo, Ledger, SolveError};

use super::books::rounding_of_places;
use super::contacts::by_wall;
use super::gather::by_slices;
use super::history::MemberState;
use super::{CellState, Simulation};
use crate::Error;

/// What the rows of a time say but for members and flow.
pub(super) struct Measured {
    pub ledger: Ledger,
    /// What rounding alone gives to deformable bodies \[J\].
    pub rounding: f64,
    pub momentum: Vector3,
    pub centre: Vector3,
    pub contacts: u64,
    pub pieces: u64,
    /// Bonds that hold and that are broken.
    pub bonds: [u64; 2],
    pub deformable_share: f64,
    /// Force on each wall, and what presses on it \[N\].
    pub walls: Vec<Vector3>,
    pub pressing: Vec<f64>,
    /// Of each support.
    pub reactions: Vec<Vector3>,
    pub cells: Vec<CellState>,
}

impl Simulation {
    /// Measures all bodies; this has those of one rank, with those near them.
    pub(super) fn measure(&self, halo: &mut dyn Halo) -> Result<Measured, SolveError> {
        let world = &self.world;
        let contacts = self.own_contacts();
        let mut counts = [contacts.len() as u64, self.piece_count() as u64];
        halo.sum(&mut counts)?;
        let mut sums = self.wall_sums(&contacts);
        // Each is of a body of one rank, or of several that it fell apart into.
        let reactions = self.reactions();
        let on_supports = reactions
            .iter()
            .flat_map(<Vector3 as AsRef<[f64; 3]>>::as_ref);
        sums.extend(on_supports.map(|x| ExactSum::from_iter([*x])));
        let mass = |id: BodyId| world.mass(id);
        sums.push(world.deformables().map(|body| body.mass()).collect());
        sums.push(world.own_bodies(0).filter_map(mass).collect());
        sums.push(ExactSum::from_iter([rounding_of_places(world)]));
        let sums = world.sums_on(sums, halo)?;
        let (on_walls, rest) = sums.split_at(4 * self.walls.len());
        let (on_supports, masses) = rest.split_at(3 * reactions.len());
        let (walls, pressing) = by_wall(on_walls);
        let (on_supports, _) = on_supports.as_chunks::<3>();
        let [soft, all, rounding] = [0, 1, 2].map(|k| masses[k]);
        Ok(Measured {
            ledger: world.ledger_on(halo)?,
            rounding,
            momentum: world.linear_momentum_on(halo)?,
            centre: world.centre_of_mass_on(halo)?,
            contacts: counts[0],
            pieces: counts[1],
            bonds: world.bond_counts_on(halo)?,
            deformable_share: if soft > 0.0 { soft / all } else { 0.0 },
            walls,
            pressing,
            reactions: on_supports.iter().map(|x| Vector3::from(*x)).collect(),
            cells: self.controls.cells(world, halo)?,
        })
    }

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
