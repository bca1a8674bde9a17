//! The bodies and pairs of a world as data that travel.

use super::{Share, ranks};
use crate::body::Body;
use crate::checkpoint;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use crate::world::deformables::Soft;
use crate::world::newcomers::Newcomers;
use femdem_contact::bond::Bond;
use femdem_contact::{BodyId, BodyRecord, Motion, PairRecord, Partner};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A body with all that its owner knows of it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Member {
    /// In the whole.
    pub number: BodyId,
    pub body: Body,
    pub motion: Motion,
    pub record: BodyRecord,
    /// Of a deformable body, which has no `body` and `motion`.
    pub nodes: Option<Box<Soft>>,
}

impl Member {
    /// By what its owner is chosen, m.
    pub fn place(&self) -> Vector3 {
        let nodes = self.nodes.as_deref();
        nodes.map_or(self.body.position, |nodes| nodes.state.middle())
    }

    /// No point is farther than this from its [place](Self::place), m; of a deformable body until it is next looked up.
    pub fn radius(&self) -> f64 {
        match self.nodes.as_deref() {
            Some(nodes) => {
                let reach = self.record.reach().unwrap_or_default();
                nodes.state.radius().max(reach)
            }
            None => self.body.radius,
        }
    }

    /// Leaves whether and where it breaks to its owner.
    pub fn forget_fracture(&mut self) {
        if let Some(nodes) = &mut self.nodes {
            nodes.state.breakable = None;
        }
    }

    /// As its guests have it.
    pub fn as_guest(&mut self) -> Self {
        let nodes = self.nodes.take();
        let mut guest = self.clone();
        self.nodes = nodes;
        let nodes = self.nodes.as_deref_mut();
        guest.nodes = nodes.map(|nodes| Box::new(nodes.as_guest()));
        guest
    }
}

/// Bodies and pairs, by their numbers in the whole.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Parts {
    pub members: Vec<Member>,
    pub pairs: Vec<PairRecord>,
    /// Bonds that have ended, which stay where they are.
    pub ended: Vec<PairRecord>,
    /// Of these and of their guests.
    pub newcomers: Newcomers,
}

/// Bodies and nodes, or pairs, that ranks send each other at a time: what is on its way is small beside what a rank keeps.
const PORTION: usize = 1 << 12;

impl Member {
    /// Its share of a portion.
    fn weight(&self) -> usize {
        1 + self.nodes.as_deref().map_or(0, Soft::weight)
    }
}

/// A list in portions of so much weight, or of one that is heavier. They are cut off its end, so that there is no second copy of it.
fn in_portions<T>(
    mut list: Vec<T>,
    weight: impl Fn(&T) -> usize,
) -> impl ExactSizeIterator<Item = Vec<T>> {
    let mut starts: Vec<usize> = Vec::new();
    let mut room = 0;
    for (at, own) in list.iter().map(weight).enumerate() {
        if own > room || starts.is_empty() {
            starts.push(at);
            room = PORTION;
        }
        room = room.saturating_sub(own);
    }
    let mut portions = Vec::with_capacity(starts.len());
    for start in starts.into_iter().rev() {
        portions.push(list.split_off(start));
        list.shrink_to_fit();
    }
    portions.into_iter().rev()
}

/// The items of a list in their order, which gives memory back on the way.
fn released<T>(mut list: Vec<T>) -> impl Iterator<Item = T> {
    list.reverse();
    std::iter::from_fn(move || {
        let item = list.pop();
        if list.len().is_multiple_of(PORTION) {
            list.shrink_to_fit();
        }
        item
    })
}

impl Parts {
    /// Bodies and then pairs, in as many portions on all ranks; without ended bonds and newcomers.
    pub fn portions(
        self,
        halo: &mut dyn Halo,
    ) -> Result<impl Iterator<Item = Self> + use<>, SolveError> {
        let mut members = in_portions(self.members, Member::weight);
        let mut pairs = in_portions(self.pairs, |_| 1);
        let mut least = [members.len(), pairs.len()].map(|length| -(length as f64));
        halo.least(&mut least)?;
        let [of_members, of_pairs] = least.map(|most| -most as usize);
        Ok((0..of_members + of_pairs).map(move |at| {
            let mut portion = Self::default();
            if at < of_members {
                portion.members = members.next().unwrap_or_default();
            } else {
                portion.pairs = pairs.next().unwrap_or_default();
            }
            portion
        }))
    }

    /// Those of all ranks on the first one, and none on the others.
    pub fn gathered(mut self, halo: &mut dyn Halo) -> Result<Self, SolveError> {
        let apart = checkpoint::encode(&(&self.newcomers, &self.ended))?;
        (self.newcomers, self.ended) = Default::default();
        let mut all = Self::default();
        for (_, bytes) in halo.send(vec![(0, apart)])? {
            let (newcomers, ended): (_, Vec<PairRecord>) = checkpoint::decode(&bytes)?;
            all.newcomers.join(newcomers);
            all.ended.extend(ended);
        }
        for portion in self.portions(halo)? {
            for (_, bytes) in halo.send(vec![(0, checkpoint::encode(&portion)?)])? {
                all.join(checkpoint::decode(&bytes)?);
            }
        }
        Ok(all)
    }

    pub fn join(&mut self, other: Self) {
        self.members.extend(other.members);
        self.pairs.extend(other.pairs);
        self.ended.extend(other.ended);
        self.newcomers.join(other.newcomers);
    }
}

impl World {
    /// Takes the bodies out: those of this rank, with the pairs whose B is one of them; and the guests.
    pub(super) fn take_apart(&mut self) -> Result<(Parts, Vec<Member>), SolveError> {
        let (mut parts, is_own) = self.take_all()?;
        let guests = parts
            .members
            .extract_if(.., |member| !is_own(member.number));
        let guests = guests.collect();
        parts.pairs.retain(|pair| is_own(pair.sides().1));
        parts.ended = parts.pairs.extract_if(.., |pair| has_ended(pair)).collect();
        if let Some(share) = &mut self.share {
            parts.ended.append(&mut share.ended);
        }
        Ok((parts, guests))
    }

    /// Takes all bodies and pairs out that are here, with whether a body of a number is one of this rank.
    pub(super) fn take_all(
        &mut self,
    ) -> Result<(Parts, impl Fn(BodyId) -> bool + use<>), SolveError> {
        let newcomers = std::mem::take(&mut self.newcomers);
        let number = |id: BodyId| match &self.share {
            Some(share) => share.numbers.get(id as usize).copied(),
            None => Some(id),
        };
        let guests = self.batch.body_ids().filter(|id| self.is_guest(*id));
        let guests: BTreeSet<BodyId> = guests.filter_map(number).collect();
        let (records, pairs) = self.batch.take_bodies()?;
        let mut models = match &mut self.deformables {
            Some(deformables) => deformables.take_models(&mut self.batch)?,
            None => Vec::new(),
        };
        let pairs = pairs.into_iter();
        let mut all = Parts {
            newcomers: newcomers.renumbered(number),
            pairs: pairs.filter_map(|pair| pair.renumbered(number)).collect(),
            ..Parts::default()
        };
        let bodies = released(std::mem::take(&mut self.bodies));
        let motions = released(std::mem::take(&mut self.motions));
        let mut places = (0..).zip(bodies.zip(motions));
        for (id, mut record) in released(records) {
            let place = places.find(|(place, _)| *place == id);
            let Some(((_, (body, motion)), number)) = place.zip(number(id)) else {
                continue;
            };
            let nodes = match &mut self.deformables {
                Some(deformables) => deformables.take(id, &mut record, &mut models),
                None => None,
            };
            all.members.push(Member {
                number,
                body,
                motion,
                record,
                nodes: nodes.map(Box::new),
            });
        }
        if let Some(deformables) = &mut self.deformables {
            deformables.empty(0);
        }
        self.ahead.clear();
        self.awake.clear();
        Ok((all, move |number| !guests.contains(&number)))
    }

    /// Puts bodies and pairs in where there are none: members ascending by number, each with its owner.
    pub(super) fn put_together(
        &mut self,
        members: Vec<(Member, usize)>,
        pairs: Vec<PairRecord>,
        newcomers: Newcomers,
        rank: usize,
    ) -> Result<Vec<BodyId>, SolveError> {
        let numbers: Vec<BodyId> = members.iter().map(|(member, _)| member.number).collect();
        let local = |number: BodyId| Some(numbers.binary_search(&number).ok()? as BodyId);
        let pairs = pairs
            .into_iter()
            .filter_map(|pair| pair.renumbered(local))
            .collect();
        self.newcomers = newcomers.renumbered(local);
        let total = members.len() as BodyId;
        let members = released(members);
        let members = (0..).zip(members.map(|(member, owner)| (member, owner != rank)));
        self.put(total, members, pairs)?;
        Ok(numbers)
    }

    /// The bodies of all ranks, ascending by number, in the world of one.
    pub(super) fn put_all(&mut self, total: u32, parts: Parts) -> Result<(), SolveError> {
        self.newcomers = parts.newcomers;
        let members = released(parts.members);
        let members = members.map(|member| (member.number, (member, false)));
        let pairs = parts.pairs.into_iter().chain(parts.ended);
        self.put(total, members, pairs.collect())
    }

    /// Puts members in under their numbers, below `total`, with whether they are guests.
    pub(super) fn put(
        &mut self,
        total: BodyId,
        members: impl Iterator<Item = (BodyId, (Member, bool))>,
        pairs: Vec<PairRecord>,
    ) -> Result<(), SolveError> {
        // Numbers are those of the new share from now on.
        self.share = None;
        self.bodies = vec![Body::vacant(); total as usize];
        self.motions = vec![Body::vacant().motion(); total as usize];
        if let Some(deformables) = &mut self.deformables {
            deformables.empty(total as usize);
        }
        let mut records = Vec::new();
        for (id, (mut member, is_guest)) in members {
            if member.record.is_awake_rigid() && !is_guest {
                self.awake.push(id);
            }
            self.bodies[id as usize] = member.body;
            self.motions[id as usize] = member.motion;
            if let Some(nodes) = member.nodes {
                let Some(deformables) = self.deformables.as_mut() else {
                    return Err(ranks(
                        "nodes came of a deformable body where there are none",
                    ));
                };
                deformables.give(id, *nodes, &mut member.record, &mut self.batch)?;
            }
            records.push((id, member.record, is_guest));
        }
        self.batch.give_bodies(total, records, pairs)?;
        // What came from others is not trusted.
        self.check_stored()
    }
}

/// Whether it is a bond that has ended.
pub(super) fn has_ended(pair: &PairRecord) -> bool {
    pair.bond().is_some_and(Bond::has_ended)
}

/// The bodies of a pair.
pub(super) fn bodies_of(pair: &PairRecord) -> impl Iterator<Item = BodyId> {
    let (a, b) = pair.sides();
    let a = match a {
        Partner::Body(a) => Some(a),
        Partner::Wall(_) => None,
    };
    a.into_iter().chain([b])
}

impl Share {
    /// Whether what was read fits a world with so many places for bodies, and so many bodies.
    pub(in crate::world) fn is_sound(&self, [places, bodies]: [usize; 2]) -> bool {
        let lists = [self.numbers.len(), self.until.len(), self.holds.len()];
        let linked = self
            .links
            .iter()
            .flat_map(|link| link.lent.iter().chain(&link.guests));
        let mut linked = linked.copied();
        let all = (self.whole.total as usize).checked_sub(self.whole.vacant.len());
        let lists_of_numbers = [&self.numbers, &self.whole.vacant];
        let ascending = lists_of_numbers.map(|list| list.windows(2).all(|pair| pair[0] < pair[1]));
        let ascending = ascending == [true; 2];
        let counted = all.is_some_and(|all| match self.cuts.ranks() {
            1 => all == bodies,
            _ => all >= bodies,
        });
        let lasts = lists_of_numbers.map(|list| list.last());
        let fits = lasts
            .into_iter()
            .flatten()
            .all(|last| *last < self.whole.total);
        let is_length = |x: f64| x.is_finite() && x >= 0.0;
        let mut until = self.until.iter();
        let lasting = until.all(|until| {
            until.travelled.is_finite()
                && is_length(until.radius)
                && until.away.iter().all(|n| n.is_finite())
        });
        let mut guides = self.whole.guides.iter();
        let guided = guides.all(|guide| guide.drive().is_some() && guide.validate().is_ok());
        let is_there = |number| self.whole.names(number);
        let mut bonds = self.ended.iter();
        let ended = bonds.all(|pair| has_ended(pair) && bodies_of(pair).all(is_there));
        self.cuts.is_sound()
            && is_length(self.whole.largest)
            && is_length(self.whole.bonded)
            && self.whole.edges.is_sound()
            && lasting
            && ended
            && guided
            && counted
            && ascending
            && fits
            && self.rank < self.cuts.ranks()
            && lists == [places; 3]
            && self.links.iter().all(|link| link.rank < self.cuts.ranks())
            && linked.all(|id| (id as usize) < places)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Cuts;
    use super::super::cuts::tests::OneOf;
    use super::*;
    use crate::body::BodySpec;
    use crate::guide::Guide;
    use crate::halo::Alone;
    use crate::parameters::WorldParameters;
    use femdem_fem::Driven;
    use femdem_mesh::Pose;
    use femdem_mesh::catalogue::CatalogueShape;

    #[test]
    fn a_share_that_does_not_fit_is_refused() {
        let mut world = World::new(WorldParameters::default()).unwrap();
        let cube = "P5".parse::<CatalogueShape>().unwrap();
        let cube = cube.polyhedron(0.1).unwrap();
        let shape = world.add_shape("cube", &cube).unwrap();
        let at = |x| BodySpec::at_rest(shape, 2500.0, Pose::translation(x, 0.0, 0.0));
        for k in 0..3 {
            world.add_body(at(f64::from(k))).unwrap();
        }
        world.share_out(&mut Alone).unwrap();
        let read = |change: fn(&mut Share)| {
            let mut world = world.clone();
            change(world.share.as_mut().unwrap());
            World::from_bytes(&world.to_bytes().unwrap())
        };
        assert!(read(|_| {}).is_ok());
        let changes: [fn(&mut Share); 13] = [
            |share| share.whole.largest = f64::NAN,
            |share| share.whole.bonded = f64::NAN,
            |share| share.until[0].away[1] = f64::NAN,
            |share| share.until[1].travelled = f64::INFINITY,
            |share| share.until[1].radius = -1.0,
            |share| share.whole.guides = vec![Guide::host(Driven::default())],
            |share| share.whole.vacant = vec![share.whole.total],
            |share| share.whole.vacant = vec![1],
            |share| share.whole.total = u32::MAX,
            |share| share.whole.total = 2,
            |share| share.numbers.swap(0, 1),
            |share| share.numbers[0] = 1,
            |share| share.numbers[2] = 3,
        ];
        for (k, change) in changes.into_iter().enumerate() {
            let refused = read(change).err().map(|error| error.to_string());
            assert!(
                refused.is_some_and(|error| error.contains("share")),
                "change {k}"
            );
        }
        let mut full = read(|share| {
            share.cuts = Cuts::to_first(2);
            share.whole.total = u32::MAX;
        })
        .unwrap();
        let refused = full.add_body(at(5.0)).unwrap_err().to_string();
        assert!(refused.contains("no more numbers"), "{refused}");
        // No lists of so many are made.
        let gathered = full.gather(&mut OneOf(2)).unwrap_err().to_string();
        assert!(gathered.contains("do not have all bodies"), "{gathered}");
    }
}
