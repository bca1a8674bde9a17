//! Bodies are given to the ranks in whose boxes they are, and lent to those near them.

use super::bonds::too_far;
use super::map::in_cell;
use super::parts::{Parts, bodies_of};
use super::{Cuts, Link, Map, Share, Until, WAY, Whole, ranks};
use crate::body::Body;
use crate::checkpoint;
use crate::error::SolveError;
use crate::halo::{Alone, Halo};
use crate::ledger::Flows;
use crate::world::World;
use crate::world::time_step::LARGEST_MOVE;
use femdem_contact::{BodyId, PairRecord};
use femdem_mesh::Vector3;
use std::collections::BTreeMap;

/// Two bodies become candidates at a distance of at most this many times the sum of their radii: their skins, and what they have
/// moved since they were looked up.
const SKINS: f64 = 1.1;

/// Space is cut anew when the rank of the largest cost has this many times the mean.
const UNEVEN: f64 = 1.1;

impl World {
    /// Keeps the part of this rank of a world that all have whole.
    pub(super) fn deal_whole(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        // The costs of all, found once and not by every rank.
        let of_first = if halo.rank() == 0 {
            self.costs()
        } else {
            Vec::new()
        };
        let cuts = self.cut(&of_first, halo)?;
        let whole = Whole::of(self, halo)?;
        let (mut parts, _) = self.take_apart()?;
        if halo.rank() > 0 {
            parts.ended.clear();
        }
        self.leave_books(halo);
        self.keep(cuts, whole, parts, halo)
    }

    /// Shares out a world that the first rank has, and no other: the others get the bodies that they own or have near, and all
    /// shapes, models and walls.
    ///
    /// # Errors
    /// As [`share_out`](Self::share_out); [`SolveError::Ranks`] also for a world that another rank gives, or the first does not.
    pub fn share_from_first(world: Option<Self>, halo: &mut dyn Halo) -> Result<Self, SolveError> {
        are_of_one_program(halo)?;
        let is_wrong = world.is_some() != (halo.rank() == 0);
        let mut wrong = [u64::from(is_wrong)];
        halo.sum(&mut wrong)?;
        if wrong[0] > 0 {
            return Err(ranks(
                "the first rank gives the world, and no other rank does",
            ));
        }
        let Some(mut world) = world else {
            return Self::share_with_first(halo);
        };
        world.restored()?;
        world.not_shared("sharing it out again")?;
        world.can_be_shared()?;
        let whole = Whole::of(&world, &mut Alone)?;
        let (costs, (parts, _)) = (world.costs(), world.take_apart()?);
        let frame = (world.to_bytes()?, &whole, &parts.newcomers);
        from_first(Some(checkpoint::encode(&frame)?), halo)?;
        world.receive(&costs, whole, parts, halo)
    }

    /// The part of a rank that is not the first of what that one [gives](Self::share_from_first).
    fn share_with_first(halo: &mut dyn Halo) -> Result<Self, SolveError> {
        let frame = from_first(None, halo)?;
        let (frame, whole, newcomers): (Vec<u8>, Whole, _) = checkpoint::decode(&frame)?;
        let parts = Parts {
            newcomers,
            ..Parts::default()
        };
        Self::from_bytes(&frame)?.receive(&[], whole, parts, halo)
    }

    /// Sends what there is of a whole to its owners, and keeps what comes: of `parts` that only the first rank has, whose costs
    /// are these.
    fn receive(
        mut self,
        costs: &[(Vector3, u64)],
        whole: Whole,
        mut parts: Parts,
        halo: &mut dyn Halo,
    ) -> Result<Self, SolveError> {
        let cuts = self.cut(costs, halo)?;
        let mut own = Parts {
            ended: std::mem::take(&mut parts.ended),
            newcomers: parts.newcomers.clone(),
            ..Parts::default()
        };
        let mut owners = BTreeMap::new();
        for portion in parts.portions(halo)? {
            let map = self.map(&cuts);
            let of_portion = portion.members.iter();
            owners.extend(of_portion.map(|member| (member.number, map.owner(&member.place()))));
            own.join(self.pass_on((&cuts, &whole), portion, &owners, halo)?);
        }
        own.members.sort_by_key(|member| member.number);
        self.leave_books(halo);
        self.keep(cuts, whole, own, halo)?;
        Ok(self)
    }

    /// Cuts space by what bodies cost, those of all ranks.
    fn cut(&self, costs: &[(Vector3, u64)], halo: &mut dyn Halo) -> Result<Cuts, SolveError> {
        if self.is_for_first() {
            return Ok(Cuts::to_first(halo.size()));
        }
        Cuts::find(costs, halo)
    }

    /// Leaves the books of the whole to the first rank.
    fn leave_books(&mut self, halo: &dyn Halo) {
        if halo.rank() > 0 {
            self.flows = Flows::default();
            self.initial_energy = 0.0;
        }
    }

    /// Whether the first rank has all bodies: contacts of implicit steps are solved together, and have friction of the last step
    /// to come.
    fn is_for_first(&self) -> bool {
        self.parameters.time_step.implicit.is_some() || self.behind > 0.0
    }

    /// Gives all bodies to the first rank, for implicit steps.
    pub(in crate::world) fn deal_to_first(
        &mut self,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        let cuts = self.share.as_deref().map(|share| &share.cuts);
        if cuts.is_none_or(|cuts| cuts.ranks() == 1 || cuts.are_to_first()) {
            return Ok(());
        }
        self.deal_again(halo)
    }

    /// Deals the bodies of all ranks anew.
    pub(in crate::world) fn deal_again(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let Some(share) = self.share.as_deref() else {
            return Ok(());
        };
        let (mut whole, mut cuts) = (share.whole.clone(), share.cuts.clone());
        let costs = self.costs();
        let own: u64 = costs.iter().map(|(_, cost)| cost).sum();
        let (mut sum, mut most) = ([own], [-(own as f64)]);
        halo.sum(&mut sum)?;
        halo.least(&mut most)?;
        let is_uneven = -most[0] > UNEVEN * sum[0] as f64 / halo.size() as f64;
        if self.is_for_first() {
            cuts = Cuts::to_first(halo.size());
        } else if is_uneven || cuts.are_to_first() {
            cuts = Cuts::find(&costs, halo)?;
        }
        [whole.largest, whole.bonded] = self.lengths(halo)?;
        whole.edges = self.edges(whole.way(), halo)?;
        let (parts, guests) = self.take_apart()?;
        let map = self.map(&cuts);
        let own = parts.members.iter();
        let own = own.map(|member| (member.number, map.owner(&member.place())));
        let guests = guests.iter();
        let guests = guests.map(|member| (member.number, map.owner(&member.place())));
        let owners = own.chain(guests).collect();
        let parts = self.pass_on((&cuts, &whole), parts, &owners, halo)?;
        self.keep(cuts, whole, parts, halo)
    }

    /// Where the own bodies are, and what they cost. A bond counts as a pair.
    pub(super) fn costs(&self) -> Vec<(Vector3, u64)> {
        let counters = &self.counters;
        let (time, pairs) = self
            .share
            .as_ref()
            .map_or_else(Default::default, |s| s.spent);
        let spent = counters.contact_time.saturating_sub(time).as_nanos() as u64;
        let of_pair = (spent / (counters.pair_evaluations - pairs).max(1)).clamp(1, 1 << 20);
        let (cell, bonds) = (self.cell(), self.bonds_of_bodies());
        let cost = |(i, body): (usize, &Body)| {
            let awake = self.batch.is_awake(i as BodyId);
            let pairs = if awake {
                self.batch.candidates_of(i as BodyId) as u64 + bonds[i]
            } else {
                0
            };
            (in_cell(cell, &body.position), of_pair * (1 + pairs))
        };
        let rigid = self.live_bodies().map(cost);
        let soft = self.own_nodes();
        let soft = soft.map(|(_, nodes, model)| (in_cell(cell, &nodes.middle()), model.costs()));
        rigid.chain(soft).collect()
    }

    /// Within what distance of a box a body of some radius may meet one that was in it, until all are dealt anew, m. `largest` is
    /// the largest radius of all.
    pub(super) fn reach(&self, largest: f64) -> impl Fn(f64) -> f64 + use<> {
        let attraction = self.batch.laws().attraction_range();
        let mut moved = 2.0 * (WAY + LARGEST_MOVE) * largest;
        if self.deformables.is_some() {
            // A rigid body that is looked up finds a deformable one where it was before a last step.
            moved += LARGEST_MOVE * largest;
        }
        if self.cell().is_some() {
            // The edges carry images as far, and each body in a last step.
            moved += (WAY + 3.0 * LARGEST_MOVE) * largest;
        }
        move |radius| SKINS * (largest + radius) + attraction + moved
    }

    /// Where bodies are among ranks with these boxes.
    pub(super) fn map<'a>(&'a self, cuts: &'a Cuts) -> Map<'a> {
        let cell = self.cell();
        Map { cuts, cell }
    }

    /// As [`reach`](Self::reach), and so far that the owner of a bonded body knows the other one, too.
    pub(super) fn reach_in(&self, whole: &Whole) -> impl Fn(f64) -> f64 + use<> {
        let (reach, bonded) = (self.reach(whole.largest), whole.bonded);
        // Whatever is rounded.
        move |radius| reach(radius).max(bonded * (1.0 + 1e-12))
    }

    /// The largest radius of all shapes and of the deformable bodies of all ranks, and the distance of the bodies of their longest
    /// bond, m.
    pub(super) fn lengths(&self, halo: &mut dyn Halo) -> Result<[f64; 2], SolveError> {
        let radii = self.batch.shapes().iter().map(|shape| shape.radius());
        let rigid = radii.fold(0.0, f64::max);
        let soft = self.own_nodes().map(|(id, nodes, _)| {
            let [_, reach] = self.batch.way_and_reach(id).unwrap_or_default();
            nodes.radius().max(reach)
        });
        let mut least = [-soft.fold(rigid, f64::max), -self.longest_bond()];
        if self.deformables.is_some() || self.shares_bonds() {
            halo.least(&mut least)?;
        }
        Ok(least.map(|least| -least))
    }

    /// Sends the bodies to their owners and to those near them, and the pairs to the owners of their bodies, which are known.
    fn pass_on(
        &self,
        (cuts, whole): (&Cuts, &Whole),
        parts: Parts,
        owners: &BTreeMap<BodyId, usize>,
        halo: &mut dyn Halo,
    ) -> Result<Parts, SolveError> {
        let reach = self.reach_in(whole);
        let map = self.map(cuts);
        let mut bags: BTreeMap<usize, Parts> = BTreeMap::new();
        for mut member in parts.members {
            let near = map.near(&member.place(), reach(member.radius()));
            let owner = map.owner(&member.place());
            for rank in near.into_iter().filter(|rank| *rank != owner) {
                bags.entry(rank)
                    .or_default()
                    .members
                    .push(member.as_guest());
            }
            bags.entry(owner).or_default().members.push(member);
        }
        for pair in parts.pairs {
            let mut to: Vec<usize> = Vec::with_capacity(2);
            for number in bodies_of(&pair) {
                let owner = owners.get(&number);
                to.extend(owner.filter(|owner| !to.contains(owner)));
            }
            let last = to.pop();
            for rank in to {
                bags.entry(rank).or_default().pairs.push(pair.clone());
            }
            if let Some(rank) = last {
                bags.entry(rank).or_default().pairs.push(pair);
            }
        }
        for bag in bags.values_mut() {
            bag.newcomers = parts.newcomers.clone();
        }
        let mut own = bags.remove(&halo.rank()).unwrap_or_default();
        own.ended = parts.ended;
        let encoded = bags
            .iter()
            .map(|(rank, bag)| Ok((*rank, checkpoint::encode(bag)?)));
        let encoded = encoded.collect::<Result<Vec<_>, SolveError>>()?;
        for (_, bytes) in halo.send(encoded)? {
            own.join(checkpoint::decode(&bytes)?);
        }
        own.members.sort_by_key(|member| member.number);
        Ok(own)
    }

    /// Keeps what belongs to this rank or near it, of members ascending by number.
    fn keep(
        &mut self,
        cuts: Cuts,
        whole: Whole,
        parts: Parts,
        halo: &dyn Halo,
    ) -> Result<(), SolveError> {
        let (rank, reach, way) = (halo.rank(), self.reach_in(&whole), whole.way());
        let mut links: BTreeMap<usize, (Vec<BodyId>, Vec<BodyId>)> = BTreeMap::new();
        let (mut kept, mut until) = (Vec::new(), Vec::new());
        let map = self.map(&cuts);
        for mut member in parts.members {
            let (x, radius) = (member.place(), member.radius());
            let (owner, near) = (map.owner(&x), map.near(&x, reach(radius)));
            let id = kept.len() as BodyId;
            if owner == rank {
                for other in near.into_iter().filter(|other| *other != rank) {
                    links.entry(other).or_default().0.push(id);
                }
            } else if near.contains(&rank) {
                links.entry(owner).or_default().1.push(id);
                member.forget_fracture();
            } else {
                continue;
            }
            until.push((radius, whole.edges.away(self.cell(), &x)));
            kept.push((member, owner));
        }
        let is_own = |number: &BodyId| {
            let at = kept.binary_search_by_key(number, |(member, _)| member.number);
            at.is_ok_and(|at| kept[at].1 == rank)
        };
        let pairs: Vec<PairRecord> = parts
            .pairs
            .into_iter()
            .filter(|pair| bodies_of(pair).any(|number| is_own(&number)))
            .collect();
        let is_here = |number: BodyId| kept.binary_search_by_key(&number, |(m, _)| m.number);
        for bond in pairs.iter().filter_map(PairRecord::bond) {
            let [a, b] = bond.bodies();
            if is_here(a).is_err() || is_here(b).is_err() {
                return Err(too_far([a, b]));
            }
        }
        let numbers = self.put_together(kept, pairs, parts.newcomers, rank)?;
        let until = (0..).zip(until).map(|(id, (radius, away))| Until {
            travelled: self.travelled(id) + way,
            radius,
            away,
        });
        let until = until.collect();
        let links = links
            .into_iter()
            .map(|(rank, (lent, guests))| Link { rank, lent, guests });
        self.share = Some(Box::new(Share {
            rank,
            cuts,
            whole,
            links: links.collect(),
            until,
            holds: vec![false; numbers.len()],
            ended: parts.ended,
            numbers,
            spent: (self.counters.contact_time, self.counters.pair_evaluations),
        }));
        let moving = self
            .awake
            .iter()
            .map(|&i| &self.bodies[i as usize])
            .filter(|body| body.driven.is_none())
            .map(Body::kinetic_energy);
        let soft = self.own_nodes();
        let soft = soft.map(|(_, nodes, model)| nodes.kinetic_energy(model.model.masses()));
        let moving = moving.sum::<f64>() + soft.sum::<f64>();
        self.flows.last = [moving, self.flows.work_in, self.flows.load_work];
        Ok(())
    }
}

/// Refuses ranks of different programs, which would not read what others send.
pub(super) fn are_of_one_program(halo: &mut dyn Halo) -> Result<(), SolveError> {
    let version = f64::from(checkpoint::VERSION);
    let mut least = [version, -version];
    halo.least(&mut least)?;
    if least != [version, -version] {
        return Err(ranks("the ranks have different programs"));
    }
    Ok(())
}

/// What the first rank gives, on all ranks; no more than one copy is on its way.
pub(super) fn from_first(
    given: Option<Vec<u8>>,
    halo: &mut dyn Halo,
) -> Result<Vec<u8>, SolveError> {
    let mut bytes = Vec::new();
    for rank in 1..halo.size() {
        let message = given.iter().map(|given| (rank, given.clone())).collect();
        for (_, received) in halo.send(message)? {
            bytes = received;
        }
    }
    Ok(given.unwrap_or(bytes))
}
