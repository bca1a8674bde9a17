//! Bonds over ranks: both bodies must be known wherever one of them is.

use crate::body::Body;
use crate::error::SolveError;
use crate::halo::Alone;
use crate::world::World;
use femdem_contact::bond::Bond;
use femdem_contact::{BodyId, PairRecord};

impl World {
    /// Refuses bonds, of a world that has all bodies, over gaps so wide that the rank of one body might not know the other, wherever
    /// borders are and however a pair turns. Bonds that are shared stay known: see [`Whole::bonded`](super::Whole).
    pub(super) fn check_bonds(&self) -> Result<(), SolveError> {
        let mut alive = self.live_bonds().peekable();
        if alive.peek().is_none() {
            return Ok(());
        }
        let [largest, _] = self.lengths(&mut Alone)?;
        let reach = self.reach(largest);
        for bond in alive {
            let [first, second] = self.bodies_of_bond(bond);
            if self.length_of(bond) > reach(first.radius.min(second.radius)) {
                return Err(too_far(bond.bodies()));
            }
        }
        Ok(())
    }

    /// The largest distance of the bodies of a bond that has not ended, m. Over ranks each bond is known whole where one of its
    /// bodies is.
    pub(super) fn longest_bond(&self) -> f64 {
        self.live_bonds()
            .map(|bond| self.length_of(bond))
            .fold(0.0, f64::max)
    }

    /// The distance of the bodies of a bond, m.
    fn length_of(&self, bond: &Bond) -> f64 {
        let [first, second] = self.bodies_of_bond(bond);
        (first.position - second.position).norm()
    }

    fn bodies_of_bond(&self, bond: &Bond) -> [&Body; 2] {
        bond.bodies().map(|id| &self.bodies[id as usize])
    }

    /// By number, the bonds of a body that have not ended.
    pub(super) fn bonds_of_bodies(&self) -> Vec<u64> {
        let mut counts = vec![0; self.bodies.len()];
        for id in self.live_bonds().flat_map(|bond| bond.bodies()) {
            counts[id as usize] += 1;
        }
        counts
    }

    /// The bonds that had ended when bodies were last dealt, each on one rank.
    pub(in crate::world) fn ended_bonds(&self) -> impl Iterator<Item = &Bond> {
        let share = self.share.as_deref().into_iter();
        share.flat_map(|share| share.ended.iter().filter_map(PairRecord::bond))
    }

    fn live_bonds(&self) -> impl Iterator<Item = &Bond> {
        let all = self.bonds().map(|(_, bond)| bond);
        all.filter(|bond| !bond.has_ended())
    }
}

/// Bodies, by their numbers in the whole, of a bond that no rank knows both of.
pub(super) fn too_far([a, b]: [BodyId; 2]) -> SolveError {
    super::ranks(&format!(
        "the bonded bodies {a} and {b} are farther apart than bodies that meet: run it on one rank"
    ))
}

#[cfg(test)]
mod tests {
    use crate::{BodySpec, World, WorldParameters};
    use femdem_contact::bond::BondLaw;
    use femdem_mesh::Pose;

    #[test]
    fn bonds_are_among_the_costs_by_which_space_is_cut() {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let ball = world.add_sphere("ball", 0.05).unwrap();
        let mut add = |x: f64| {
            let spec = BodySpec::at_rest(ball, 2500.0, Pose::translation(x, 0.0, 0.0));
            world.add_body(spec).unwrap()
        };
        let ids = [add(0.0), add(0.1), add(0.2), add(1.0)];
        for pair in ids[..3].windows(2) {
            let bodies = [pair[0], pair[1]];
            let section = world.section_between(bodies, 1e-3, 0.5).unwrap().unwrap();
            world
                .add_bond(bodies, &section, BondLaw::default())
                .unwrap();
        }
        let costs: Vec<u64> = world.costs().into_iter().map(|(_, cost)| cost).collect();
        assert_eq!(costs, [2, 3, 2, 1]);
    }
}
