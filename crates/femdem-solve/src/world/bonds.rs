//! Bonds between the rigid bodies of a world.

use super::World;
use super::active::is_any;
use super::hand::Stored;
use crate::error::{SolveError, check};
use crate::halo::Halo;
use femdem_contact::bond::{Bond, BondLaw, BondSection};
use femdem_contact::{BodyId, BondId, Contact, Motion, Partner};
use std::collections::{BTreeMap, BTreeSet};

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

    /// How many bonds of all ranks are not broken, and how many are; those that have ended count too.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] if the world was not shared out over these ranks, and what `halo` reports.
    pub fn bond_counts_on(&self, halo: &mut dyn Halo) -> Result<[u64; 2], SolveError> {
        self.fits(halo)?;
        let is_own = |bond: &&Bond| {
            bond.bodies()
                .into_iter()
                .max()
                .is_some_and(|b| !self.is_guest(b))
        };
        let own = self.bonds().map(|(_, bond)| bond).filter(is_own);
        let mut counts = [0; 2];
        for bond in own.chain(self.ended_bonds()) {
            counts[usize::from(bond.is_broken())] += 1;
        }
        halo.sum(&mut counts)?;
        Ok(counts)
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
    pub(super) fn end_bonds(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let ended = self.batch.end_bonds(&self.motions, self.time)?;
        let mut parted = !ended.parted.is_empty();
        if self.shares_bonds() {
            parted = is_any(parted, halo)?;
        }
        let held = ended.held.into_iter();
        let held = held.filter(|((_, b), _)| !self.is_guest(*b));
        let mut more: BTreeMap<_, f64> = held.map(|(pair, held)| (pair, -held)).collect();
        if parted {
            // Guests have the velocities of the half step.
            self.meet_guests(halo)?;
            let awake = self.awake.len();
            self.evaluate(0.0)?;
            self.tell_woken(awake, halo)?;
            for contact in self.batch.booked_contacts() {
                let Partner::Body(a) = contact.a else {
                    continue;
                };
                let pair = (a.min(contact.b), a.max(contact.b));
                if ended.parted.contains(&pair) {
                    *more.entry(pair).or_default() += contact.potential();
                }
            }
        }
        for more in more.into_values() {
            self.flows.bonds.lent += more.max(0.0);
            self.flows.bonds.released += (-more).max(0.0);
        }
        Ok(())
    }

    /// Wakes what is bonded over borders to bodies that deformable ones have woken in an evaluation before which so many were `awake`: in
    /// one world they wake at once, and move in the same step.
    pub(super) fn tell_woken(
        &mut self,
        awake: usize,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        let may_wake = self.shares_bonds() && self.deformables.is_some();
        if may_wake && is_any(self.awake.len() > awake, halo)? {
            return self.tell_rest(halo);
        }
        Ok(())
    }

    /// Those of a list of free bodies, ascending, all of whose bonded bodies are in it or asleep, on all ranks. Bodies that follow a
    /// drive hold what is bonded to them apart.
    pub(super) fn with_all_bonded(
        &self,
        list: Vec<BodyId>,
        halo: &mut dyn Halo,
    ) -> Result<Vec<BodyId>, SolveError> {
        let shared = self.shares_bonds();
        let none = match shared {
            true => !is_any(!list.is_empty(), halo)?,
            false => !self.batch.has_bonds(),
        };
        if none {
            return Ok(list);
        }
        // Those that do not rest, and what bonds hold to them.
        let mut stays = vec![false; self.bodies.len()];
        for &i in &self.awake {
            stays[i as usize] = self.is_free(i) && list.binary_search(&i).is_err();
        }
        loop {
            let known = (0..).zip(&stays).filter(|(_, stays)| **stays);
            let known: Vec<BodyId> = known.map(|(i, _)| i).collect();
            for i in self.piece_of(&known) {
                stays[i as usize] |= self.is_free(i);
            }
            if !shared {
                break;
            }
            let more = self.tell_marks(&mut stays, halo)?;
            if !is_any(more, halo)? {
                break;
            }
        }
        let rests = |i: &BodyId| !stays[*i as usize];
        Ok(list.into_iter().filter(rests).collect())
    }

    /// The sleepers of a list, and those bonded to them, that belong to this rank.
    pub(super) fn with_bonded_sleepers(&self, list: &[BodyId]) -> Vec<BodyId> {
        if !self.batch.has_bonds() {
            return list.to_vec();
        }
        let mut all = self.piece_of(list);
        all.retain(|i| !self.batch.is_awake(*i) && !self.is_guest(*i));
        all
    }

    /// Sleepers of this rank bonded to bodies that are awake and free: those of another rank, which have just woken.
    pub(super) fn sleepers_beside_bonded(&self) -> Vec<BodyId> {
        let alive = self.bonds().filter(|(_, bond)| !bond.has_ended());
        let beside = alive.filter_map(|(_, bond)| {
            let [a, b] = bond.bodies();
            let sleeper = match [a, b].map(|i| self.batch.is_awake(i)) {
                [true, false] => b,
                [false, true] => a,
                _ => return None,
            };
            let are_free = self.is_free(a) && self.is_free(b);
            (are_free && !self.is_guest(sleeper)).then_some(sleeper)
        });
        Vec::from_iter(beside.collect::<BTreeSet<BodyId>>())
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
