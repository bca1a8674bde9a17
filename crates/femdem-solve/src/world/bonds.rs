//! Bonds between the rigid bodies of a world.

use super::World;
use super::hand::Stored;
use crate::error::{SolveError, check};
use femdem_contact::bond::{Bond, BondLaw, BondSection};
use femdem_contact::{BodyId, BondId, Contact, Motion, Partner};
use std::collections::BTreeSet;

impl World {
    /// Bonds two rigid bodies as they lie, without force, over a section in world coordinates: mortar, cement, a glued clump.
    /// Contacts of the two end with their friction, and what they held is in [`Ledger::by_hand`](crate::Ledger::by_hand). The
    /// bonds of the two alone act between them until each is broken and carries nothing, or has opened or slid somewhere by a
    /// tenth of its width; then they meet by the kernel again. Bonded bodies sleep and wake together. A bond goes with its
    /// bodies, and where one of them is [put elsewhere](Self::set_pose) by hand.
    ///
    /// ```
    /// use femdem_contact::bond::BondLaw;
    /// use femdem_mesh::{Pose, Vector3};
    /// use femdem_solve::{BodySpec, Drive, SleepParameters, World, WorldParameters};
    ///
    /// // A ball glued to a fixed one hangs in the air.
    /// let sleeping = SleepParameters { enabled: false, ..SleepParameters::default() };
    /// let mut world = World::new(WorldParameters { sleeping, ..WorldParameters::default() })?;
    /// let ball = world.add_sphere("ball", 0.05)?;
    /// let at = |x: f64| BodySpec::at_rest(ball, 2500.0, Pose::translation(x, 0.0, 0.0));
    /// let bodies = [world.add_driven_body(at(0.0), Drive::Fixed)?, world.add_body(at(0.1))?];
    /// let section = world.section_between(bodies, 1e-3, 0.5)?.ok_or("they are apart")?;
    /// let bond = world.add_bond(bodies, &section, BondLaw { damping: 0.5, ..BondLaw::default() })?;
    /// while world.time() < 0.02 {
    ///     world.step()?;
    /// }
    /// let weight = 9.81 * world.mass(bodies[1]).unwrap_or_default();
    /// let force = world.bond(bond).ok_or("it is gone")?.state().force;
    /// assert!((force.z / -weight - 1.0).abs() < 0.02 && world.position(bodies[1]).unwrap_or_default().z > -1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SolveError::Contact`] for a body that is not there or not rigid, for a law out of range and in periodic space,
    /// [`SolveError::Parameter`] with implicit steps.
    pub fn add_bond(
        &mut self,
        bodies: [BodyId; 2],
        section: &BondSection,
        law: BondLaw,
    ) -> Result<BondId, SolveError> {
        self.restored()?;
        self.not_shared("bonding bodies")?;
        check_explicit(self.parameters.time_step.implicit.is_some())?;
        for body in bodies {
            self.refuse_adaptive(Some(body), "to be free of bonds", "a bond")?;
        }
        let [a, b] = bodies;
        let own = |c: &&Contact| c.has_side(Partner::Body(a)) && c.has_side(Partner::Body(b));
        let contacts = self.batch.contacts_of(a);
        let stored = Stored::of(contacts.iter().filter(own));
        let id = self.batch.add_bond(bodies, section, law, &self.motions)?;
        self.book_ended(stored, &bodies);
        Ok(id)
    }

    /// The section in which two rigid bodies can be bonded that are at most `gap` (m) apart: for two spheres a disc of `ratio`
    /// times the smaller radius, for two convex polyhedra the common part of facing faces, shrunk by `ratio`. `None` for others,
    /// whose sections are [polygons](BondSection::polygon) of the caller, and where there is none.
    ///
    /// # Errors
    /// [`SolveError::Contact`] for a ratio or a gap out of range.
    pub fn section_between(
        &self,
        bodies: [BodyId; 2],
        gap: f64,
        ratio: f64,
    ) -> Result<Option<BondSection>, SolveError> {
        self.restored()?;
        Ok(self
            .batch
            .section_between(bodies, &self.motions, gap, ratio)?)
    }

    /// All bonds with their numbers, ascending; those that have ended too.
    pub fn bonds(&self) -> impl Iterator<Item = (BondId, &Bond)> {
        self.batch.bonds()
    }

    /// A bond; `None` for one that was never added or whose body has gone.
    pub fn bond(&self, id: BondId) -> Option<&Bond> {
        self.batch.bond(id)
    }

    /// How many bonds were added so far; those that have ended or gone count too.
    pub fn bonds_added(&self) -> usize {
        self.batch.bonds_added()
    }

    /// Whether a bond that has not ended holds two bodies together directly.
    pub fn are_bonded(&self, bodies: [BodyId; 2]) -> bool {
        self.batch.are_bonded(bodies)
    }

    /// The rigid bodies that bonds hold together with one, itself included, ascending.
    pub fn bonded_with(&self, id: BodyId) -> Vec<BodyId> {
        self.batch.bonded_with(&[id], |_| true)
    }

    /// The bodies that were ever bonded and are still there, by the pieces that bonds hold together which are not broken, each
    /// ascending, in the order of their lowest bodies.
    pub fn bonded_pieces(&self) -> Vec<Vec<BodyId>> {
        self.batch.bonded_pieces()
    }

    /// Motions of the bodies of a bond: where its sides are. `None` as for [`bond`](Self::bond).
    pub fn motions_of(&self, id: BondId) -> Option<[&Motion; 2]> {
        let [a, b] = self.bond(id)?.bodies();
        Some([self.motions.get(a as usize)?, self.motions.get(b as usize)?])
    }

    /// Books what the bonds dissipated in the last evaluation.
    pub(super) fn book_bonds(&mut self) {
        let [glue, friction] = self.batch.lost_in_bonds();
        self.flows.bonds.glue += glue;
        self.flows.bonds.friction += friction;
    }

    /// Ends bonds that carry nothing any more. Pairs that no bond holds any more meet again at once.
    pub(super) fn end_bonds(&mut self) -> Result<(), SolveError> {
        let ended = self.batch.end_bonds(&self.motions, self.time)?;
        let mut begun = 0.0;
        if !ended.parted.is_empty() {
            self.evaluate(0.0)?;
            let contacts = self.batch.rigid_contacts().into_iter();
            let new = contacts.filter(|c| match c.a {
                Partner::Body(a) => ended.parted.contains(&(a.min(c.b), a.max(c.b))),
                Partner::Wall(_) => false,
            });
            begun = new.map(|c| c.potential()).sum();
        }
        let more = begun - ended.held;
        self.flows.bonds.lent += more.max(0.0);
        self.flows.bonds.released += (-more).max(0.0);
        Ok(())
    }

    /// Those of a list of free bodies, ascending, all of whose bonded bodies are in it or asleep. Bodies that follow a drive hold
    /// what is bonded to them apart.
    pub(super) fn with_all_bonded(&self, list: Vec<BodyId>) -> Vec<BodyId> {
        if !self.batch.has_bonds() {
            return list;
        }
        let mut left: BTreeSet<BodyId> = list.iter().copied().collect();
        let mut kept = Vec::new();
        while let Some(first) = left.pop_first() {
            let mut piece = self.piece_of(&[first]);
            piece.retain(|i| self.is_free(*i));
            let rests = |i: &BodyId| *i == first || left.contains(i) || !self.batch.is_awake(*i);
            let all_rest = piece.iter().all(rests);
            let own = piece.into_iter().filter(|i| *i == first || left.remove(i));
            // Those that do not rest as a whole are taken out of the list, too.
            let own: Vec<BodyId> = own.collect();
            if all_rest {
                kept.extend(own);
            }
        }
        kept.sort_unstable();
        kept
    }

    /// The sleepers of a list, and those bonded to them.
    pub(super) fn with_bonded_sleepers(&self, list: &[BodyId]) -> Vec<BodyId> {
        if !self.batch.has_bonds() {
            return list.to_vec();
        }
        let mut all = self.piece_of(list);
        all.retain(|i| !self.batch.is_awake(*i));
        all
    }

    /// What bonds hold together with bodies of a list, without what lies behind bodies that follow a drive; these are in it.
    fn piece_of(&self, list: &[BodyId]) -> Vec<BodyId> {
        self.batch.bonded_with(list, |i| self.is_free(i))
    }

    fn is_free(&self, i: BodyId) -> bool {
        self.bodies[i as usize].driven.is_none()
    }

    /// Refuses bonds, with implicit steps and in a relaxation.
    pub(super) fn refuse_bonds(&self, with: &'static str) -> Result<(), SolveError> {
        let count = self.bonds().filter(|(_, bond)| !bond.has_ended()).count();
        check(
            with,
            count as f64,
            count == 0,
            "0: bonds need explicit steps",
        )
    }
}

fn check_explicit(implicit: bool) -> Result<(), SolveError> {
    check(
        "time_step.implicit with bonds",
        f64::from(u8::from(implicit)),
        !implicit,
        "absent: bonds need explicit steps",
    )
}
