//! The bonds of a batch.

use super::ContactBatch;
#[cfg(feature = "parallel")]
use super::SERIAL_BELOW;
use crate::bond::{Bond, BondLaw, BondSection, between_shapes};
use crate::contact::{BodyId, Load, RigidContact};
use crate::disjoint::{find, join};
use crate::error::{ContactError, check};
use crate::generalized::Resistance;
use crate::glue::GlueLoss;
use crate::motion::Motion;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Number of a bond, by order of addition. Numbers of bonds that have gone are not given again.
pub type BondId = u32;

/// Bonds that have ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EndedBonds {
    /// What they held, by pair of bodies, the lower number first, J.
    pub held: BTreeMap<(BodyId, BodyId), f64>,
    /// Pairs of bodies that no bond holds any more, ascending: they meet by the kernel again.
    pub parted: BTreeSet<(BodyId, BodyId)>,
}

/// All bonds, and which bodies they hold.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Bonds {
    /// Those that have not gone, ascending.
    list: Vec<(BondId, Bond)>,
    /// How many were added.
    added: BondId,
    /// Those of each body that have not ended, ascending.
    of: BTreeMap<BodyId, Vec<BondId>>,
    /// Pairs that such bonds hold, lower number first, and how many.
    pairs: BTreeMap<(BodyId, BodyId), u32>,
    /// What the last update dissipated, J.
    lost: [f64; 2],
    /// Whether bonds change nothing for good.
    #[serde(skip)]
    held: bool,
}

/// A pair, lower number first. A bond is on the books of the batch that the other one belongs to, as a contact.
fn key([a, b]: [BodyId; 2]) -> (BodyId, BodyId) {
    (a.min(b), a.max(b))
}

impl Bonds {
    /// Whether a bond holds the two, the lower number first.
    pub fn hold(&self, pair: (BodyId, BodyId)) -> bool {
        !self.pairs.is_empty() && self.pairs.contains_key(&pair)
    }

    /// Whether any that has not ended holds a body.
    pub fn hold_any(&self, body: BodyId) -> bool {
        self.of.contains_key(&body)
    }

    fn enter(&mut self, id: BondId, bodies: [BodyId; 2]) {
        for body in bodies {
            self.of.entry(body).or_default().push(id);
        }
        *self.pairs.entry(key(bodies)).or_default() += 1;
    }

    /// Takes a bond out of the lists. Returns whether it was the last of its pair.
    fn leave(&mut self, id: BondId, bodies: [BodyId; 2]) -> bool {
        for body in bodies {
            if let Some(list) = self.of.get_mut(&body) {
                list.retain(|other| *other != id);
                if list.is_empty() {
                    self.of.remove(&body);
                }
            }
        }
        let Some(count) = self.pairs.get_mut(&key(bodies)) else {
            return false;
        };
        *count -= 1;
        let was_last = *count == 0;
        if was_last {
            self.pairs.remove(&key(bodies));
        }
        was_last
    }

    /// Those of a body that have not ended.
    fn of(&self, body: BodyId) -> impl Iterator<Item = &Bond> {
        let list = self.of.get(&body);
        let ids = list.into_iter().flatten();
        ids.filter_map(|id| self.get(*id))
    }

    fn get(&self, id: BondId) -> Option<&Bond> {
        let at = self.list.binary_search_by_key(&id, |(id, _)| *id).ok()?;
        Some(&self.list[at].1)
    }

    fn iter(&self) -> impl Iterator<Item = &Bond> {
        self.list.iter().map(|(_, bond)| bond)
    }

    fn alive(&self) -> impl Iterator<Item = &Bond> {
        self.iter().filter(|bond| !bond.has_ended())
    }

    /// Takes all out.
    pub fn take(&mut self) -> Vec<(BondId, Bond)> {
        let list = std::mem::take(&mut self.list);
        self.index();
        list
    }

    /// Gives bonds where there are none.
    pub fn give(&mut self, mut bonds: Vec<(BondId, Bond)>) {
        bonds.sort_by_key(|(id, _)| *id);
        self.list = bonds;
        self.index();
    }

    /// The bodies that bonds hold to one.
    pub fn partners(&self, body: BodyId) -> impl Iterator<Item = BodyId> {
        let other = move |bond: &Bond| bond.bodies().into_iter().find(|i| *i != body);
        self.of(body).filter_map(other)
    }

    /// Removes the bonds of a body.
    pub fn forget(&mut self, body: BodyId) {
        let before = self.list.len();
        self.list.retain(|(_, bond)| !bond.bodies().contains(&body));
        if self.list.len() < before {
            self.index();
        }
    }

    /// Makes the lists of the bonds that have not ended.
    fn index(&mut self) {
        let alive = self.list.iter().filter(|(_, bond)| !bond.has_ended());
        let alive: Vec<_> = alive.map(|(id, bond)| (*id, bond.bodies())).collect();
        self.of.clear();
        self.pairs.clear();
        for (id, bodies) in alive {
            self.enter(id, bodies);
        }
    }

    /// Whether all fits together, with bodies for which `is_rigid` holds.
    pub fn are_sound(&self, is_rigid: impl Fn(BodyId) -> bool) -> bool {
        let mut right = self.clone();
        right.index();
        let ascending = self.list.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let last = self.list.last();
        let numbered = ascending && last.is_none_or(|(id, _)| *id < self.added);
        let fits = |bond: &Bond| {
            let [a, b] = bond.bodies();
            a != b && is_rigid(a) && is_rigid(b) && bond.is_sound()
        };
        numbered && right.of == self.of && right.pairs == self.pairs && self.iter().all(fits)
    }

    /// Evaluates all that hold an awake body; `is_guest` tells bodies of other batches.
    pub fn update(&mut self, bodies: &[Motion], awake: &[bool], is_guest: impl Fn(BodyId) -> bool) {
        self.lost = [0.0; 2];
        if self.pairs.is_empty() {
            return;
        }
        let takes = !self.held;
        let evaluate = |(_, bond): &mut (BondId, Bond)| {
            let moves = |i: BodyId| awake.get(i as usize).copied().unwrap_or(false);
            if bond.has_ended() || !bond.bodies().into_iter().any(moves) {
                return GlueLoss::default();
            }
            let motions = bond.bodies().map(|i| &bodies[i as usize]);
            bond.evaluate(motions, takes)
        };
        #[cfg(feature = "parallel")]
        let losses: Vec<GlueLoss> =
            if self.list.len() >= SERIAL_BELOW && rayon::current_num_threads() > 1 {
                use rayon::prelude::*;
                self.list.par_iter_mut().map(evaluate).collect()
            } else {
                self.list.iter_mut().map(evaluate).collect()
            };
        #[cfg(not(feature = "parallel"))]
        let losses: Vec<GlueLoss> = self.list.iter_mut().map(evaluate).collect();
        let booked = losses.iter().zip(self.iter());
        let booked = booked.filter(|(_, bond)| !is_guest(key(bond.bodies()).1));
        let mut lost = [0.0; 2];
        for (loss, _) in booked {
            lost[0] += loss.glue;
            lost[1] += loss.friction;
        }
        self.lost = lost;
    }

    /// Adds the loads of the bonds of awake bodies, in the order of the bonds.
    pub fn add_loads(&self, awake: &[bool], loads: &mut [Load]) {
        if self.pairs.is_empty() {
            return;
        }
        for bond in self.alive() {
            for (k, i) in bond.bodies().into_iter().enumerate() {
                if awake[i as usize] {
                    add_to(&mut loads[i as usize], bond, k);
                }
            }
        }
    }

    /// Adds the loads of the bonds of one body.
    pub fn add_load_of(&self, body: BodyId, load: &mut Load) {
        for bond in self.of(body) {
            add_to(load, bond, usize::from(bond.bodies()[1] == body));
        }
    }

    /// Adds the springs and dashpots of the bonds of a body.
    pub fn resist(&self, body: BodyId, is_awake: impl Fn(BodyId) -> bool, to: &mut Resistance) {
        for bond in self.of(body) {
            let k = usize::from(bond.bodies()[1] == body);
            let moves = is_awake(bond.bodies()[1 - k]);
            let side = &bond.sides[k];
            let share = if moves { side.share } else { 1.0 };
            to.stiffness.add_scaled(&side.stiffness, share);
            to.viscosity.add_scaled(&side.stiffness, share * bond.delay);
        }
    }
}

/// Adds what a bond does to side `k`.
fn add_to(load: &mut Load, bond: &Bond, k: usize) {
    let state = bond.state();
    let normal = state.force.dot(&state.normal).abs();
    let side = &bond.sides[k];
    // Springs at points, of the same stiffness along all axes: k (v + w x a)^2 <= k (1/m + a^2/I).
    let springs = [
        side.stiffness.translation.m11,
        0.5 * side.stiffness.turning.trace(),
    ];
    let stiffness = springs.map(|spring| spring * side.share);
    let viscosity = stiffness.map(|spring| spring * bond.delay);
    load.add_bond(
        [&side.elastic, &side.damping],
        normal,
        [stiffness, viscosity],
    );
}

impl ContactBatch {
    /// Bonds two rigid bodies as they lie, without force; `motions` are those of all bodies. Contacts of the two end with their
    /// friction, and the bond alone acts between them until it [ends](Self::end_bonds).
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] for a body that is not there or not rigid, [`ContactError::Parameter`] for a body with itself, in
    /// periodic space, and as [`BondLaw::check`].
    pub fn add_bond(
        &mut self,
        [a, b]: [BodyId; 2],
        section: &BondSection,
        law: BondLaw,
        motions: &[Motion],
    ) -> Result<BondId, ContactError> {
        for body in [a, b] {
            if !self.is_rigid(body) || body as usize >= motions.len() {
                return Err(ContactError::NoSuch {
                    what: "rigid body",
                    index: body as usize,
                    count: self.rigid_count(),
                });
            }
        }
        let allowed = "two bodies: give two different numbers";
        check("bodies of a bond", f64::from(a), a != b, allowed)?;
        let periodic = f64::from(u8::from(self.space.is_some()));
        let allowed = "0: bonds do not reach over the edges of a periodic cell";
        check(
            "bonds in periodic space",
            periodic,
            self.space.is_none(),
            allowed,
        )?;
        let sides = [a, b].map(|body| &motions[body as usize]);
        let bond = Bond::new([a, b], section, law, sides)?;
        let id = self.bonds.added;
        self.bonds.added += 1;
        self.bonds.list.push((id, bond));
        self.bonds.enter(id, [a, b]);
        self.pairs.part(key([a, b]));
        Ok(id)
    }

    /// The section in which two rigid bodies can be bonded, by their shapes; see [`between_shapes`]. `motions` are those of all
    /// bodies.
    ///
    /// # Errors
    /// As [`between_shapes`].
    pub fn section_between(
        &self,
        bodies: [BodyId; 2],
        motions: &[Motion],
        gap: f64,
        ratio: f64,
    ) -> Result<Option<BondSection>, ContactError> {
        let side = |body: BodyId| {
            let shape = self.shapes.get(self.shape_index(body)? as usize)?;
            Some((shape, &motions.get(body as usize)?.frame))
        };
        let [Some(a), Some(b)] = bodies.map(side) else {
            return Ok(None);
        };
        between_shapes([a, b], gap, ratio)
    }

    /// All bonds with their numbers, ascending; those that have ended too.
    pub fn bonds(&self) -> impl Iterator<Item = (BondId, &Bond)> {
        self.bonds.list.iter().map(|(id, bond)| (*id, bond))
    }

    /// A bond; `None` for one that was never added or whose body has gone.
    pub fn bond(&self, id: BondId) -> Option<&Bond> {
        self.bonds.get(id)
    }

    /// Whether any bond has not ended.
    pub fn has_bonds(&self) -> bool {
        !self.bonds.pairs.is_empty()
    }

    /// Whether bonds hold two bodies, which then have no contact.
    pub fn are_bonded(&self, bodies: [BodyId; 2]) -> bool {
        self.bonds.hold(key(bodies))
    }

    /// What bonds dissipated in the last update by glue and by friction, J.
    pub fn lost_in_bonds(&self) -> [f64; 2] {
        self.bonds.lost
    }

    /// How many bonds were added so far; those that have ended or gone count too.
    pub fn bonds_added(&self) -> usize {
        self.bonds.added as usize
    }

    /// Lets bonds change nothing for good from now on: they neither give way nor slide. For displacements that only measure, on a
    /// copy of the batch.
    pub fn hold_bonds(&mut self) {
        self.bonds.held = true;
    }

    /// The largest part of critical damping of the bonds that have not ended.
    pub fn damping_of_bonds(&self) -> f64 {
        let alive = self.bonds.alive();
        alive.map(|bond| bond.law().damping).fold(0.0, f64::max)
    }

    /// The step in which no bond opens or slides by more than `share` of the smaller of G_I/f_t and G_II/c, at the velocities of
    /// `motions`, those of all bodies, s. Linear softening ends after 2 of these, other kinds
    /// [later](crate::glue::Softening::end).
    ///
    /// # Errors
    /// [`ContactError::StateCount`] unless there is a motion for each body.
    pub fn step_of_bonds(&self, motions: &[Motion], share: f64) -> Result<f64, ContactError> {
        self.check_motions(motions)?;
        let awake = |bond: &&Bond| bond.bodies().into_iter().any(|i| self.is_awake(i));
        let alive = self.bonds.alive();
        let steps = alive
            .filter(awake)
            .map(|bond| bond.resolving_step(bond.bodies().map(|i| &motions[i as usize]), share));
        Ok(steps.fold(f64::INFINITY, f64::min))
    }

    fn check_motions(&self, motions: &[Motion]) -> Result<(), ContactError> {
        let (given, expected) = (motions.len(), self.body_shapes.len());
        if given == expected {
            return Ok(());
        }
        Err(ContactError::StateCount {
            what: "body",
            given,
            expected,
        })
    }

    /// Energy stored in the bonds that are on the books here, J; with a body, in those of it alone.
    pub fn stored_in_bonds(&self, body: impl Into<Option<BodyId>>) -> f64 {
        let body = body.into();
        let is_of = |bond: &&Bond| body.is_none_or(|body| bond.bodies().contains(&body));
        let all = self.booked_bonds().filter(is_of);
        0.0 + all.map(|bond| bond.state().energy).sum::<f64>()
    }

    /// Those that no other batch books.
    pub(super) fn booked_bonds(&self) -> impl Iterator<Item = &Bond> {
        let all = self.bonds.iter();
        all.filter(|bond| !self.is_guest(key(bond.bodies()).1))
    }

    /// The bodies that bonds hold together with those of a list, themselves included, ascending. Bonds of bodies that do not
    /// `pass` lead no farther, unless these are in the list.
    pub fn bonded_with(&self, bodies: &[BodyId], pass: impl Fn(BodyId) -> bool) -> Vec<BodyId> {
        let mut all: BTreeSet<BodyId> = bodies.iter().copied().collect();
        let mut new: Vec<BodyId> = bodies.to_vec();
        while let Some(body) = new.pop() {
            for other in self.bonds.partners(body) {
                if all.insert(other) && pass(other) {
                    new.push(other);
                }
            }
        }
        Vec::from_iter(all)
    }

    /// The bodies that were ever bonded and are still there, by the pieces that bonds hold together which are not
    /// [broken](Bond::is_broken), each ascending, in the order of their lowest bodies.
    pub fn bonded_pieces(&self) -> Vec<Vec<BodyId>> {
        let mut root: Vec<u32> = (0..self.body_shapes.len() as u32).collect();
        let mut bodies = BTreeSet::new();
        for (_, bond) in self.bonds() {
            let [a, b] = bond.bodies();
            bodies.extend([a, b]);
            if !bond.is_broken() {
                join(&mut root, a, b);
            }
        }
        let mut pieces: BTreeMap<u32, Vec<BodyId>> = BTreeMap::new();
        for body in bodies {
            pieces.entry(find(&root, body)).or_default().push(body);
        }
        pieces.into_values().collect()
    }

    /// Whether a contact of a rigid body resists its motion. Bonds do not count, nor does a liquid bridge over a gap.
    pub fn is_resisted(&self, body: BodyId) -> bool {
        let load = self.sums.loads.get(body as usize);
        let resists = load.is_some_and(Load::resists);
        // The load of a bonded body has the stiffness of its bonds, too.
        resists
            && (!self.bonds.hold_any(body)
                || self.rigid_contacts_of(body).any(RigidContact::resists))
    }

    /// Ends the broken bonds that carry nothing any more or whose sides have opened or slid too far, and notes the time (s) of
    /// those that have broken. `motions` are those of all bodies.
    ///
    /// # Errors
    /// [`ContactError::StateCount`] unless there is a motion for each body.
    pub fn end_bonds(&mut self, motions: &[Motion], time: f64) -> Result<EndedBonds, ContactError> {
        self.check_motions(motions)?;
        let mut ended = EndedBonds::default();
        if self.bonds.pairs.is_empty() {
            return Ok(ended);
        }
        for at in 0..self.bonds.list.len() {
            let (id, bond) = &mut self.bonds.list[at];
            let (id, bodies) = (*id, bond.bodies());
            if bond.may_end(time, bodies.map(|i| &motions[i as usize])) {
                *ended.held.entry(key(bodies)).or_default() += bond.end();
                if self.bonds.leave(id, bodies) {
                    ended.parted.insert(key(bodies));
                }
            }
        }
        Ok(ended)
    }
}
