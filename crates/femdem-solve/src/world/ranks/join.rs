//! Bodies that are added to a shared world, and what all ranks know of the bodies of the whole.

use super::{Link, Share, Until, ranks};
use crate::body::Body;
use crate::checkpoint;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use crate::world::lists::place;
use femdem_contact::BodyId;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Free numbers, the lowest, that get places at a time: lists are made anew for them, and the others would be idle in them.
const ROOMS: usize = 64;

/// Whose a new body is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::world) enum Whose {
    /// In a world that has all bodies.
    Only,
    /// With its number here.
    Own(BodyId),
    /// That of another rank, and near, with its number here.
    Guest(BodyId),
    /// That of another rank, with its number in the whole.
    Other(BodyId),
}

impl World {
    /// Gives a new body the lowest number that is free in the whole, and a place here if it is kept: as many free numbers as are
    /// [given together](ROOMS) get one then.
    pub(in crate::world) fn enlist(&mut self, body: &Body) -> Result<Whose, SolveError> {
        let Some(share) = self.share.as_deref() else {
            return Ok(Whose::Only);
        };
        let (rank, total) = (share.rank, share.whole.total);
        let free = share.whole.vacant.first().copied();
        let Some(next) = total.checked_add(u32::from(free.is_none())) else {
            return Err(ranks("there are no more numbers for bodies"));
        };
        let number = free.unwrap_or(total);
        let map = self.map(&share.cuts);
        let reach = self.reach_in(&share.whole);
        let (owner, near) = (
            map.owner(&body.position),
            map.near(&body.position, reach(body.radius)),
        );
        let is_kept = near.contains(&rank);
        let away = share.whole.edges.away(self.cell(), &body.position);
        if free.is_some() && is_kept && share.numbers.binary_search(&number).is_err() {
            let rooms: Vec<BodyId> = share.whole.vacant.iter().take(ROOMS).copied().collect();
            self.make_room(&rooms)?;
        }
        let Some(share) = self.share.as_deref_mut() else {
            return Ok(Whose::Only);
        };
        share.whole.total = next;
        share.whole.vacant.retain(|other| *other != number);
        share.whole.edges.reach(away);
        if !is_kept {
            return Ok(Whose::Other(number));
        }
        let id = share.numbers.partition_point(|other| *other < number);
        place(&mut share.numbers, id as BodyId, number);
        place(&mut share.holds, id as BodyId, false);
        let until = Until {
            travelled: body.travelled + share.whole.way(),
            radius: body.radius,
            away,
        };
        place(&mut share.until, id as BodyId, until);
        if owner != rank {
            insert(&mut share.link(owner).guests, id as BodyId);
            return Ok(Whose::Guest(id as BodyId));
        }
        for other in near.into_iter().filter(|other| *other != owner) {
            insert(&mut share.link(other).lent, id as BodyId);
        }
        Ok(Whose::Own(id as BodyId))
    }

    /// The number here of a body by its number in the whole; `None` if only other ranks have it.
    pub fn number_here(&self, number: BodyId) -> Option<BodyId> {
        let here = match &self.share {
            Some(share) => share.numbers.binary_search(&number).ok()? as BodyId,
            None => number,
        };
        self.batch.contains(here).then_some(here)
    }

    /// How many bodies the whole has.
    #[must_use]
    pub fn count_in_whole(&self) -> usize {
        let share = self.share.as_deref();
        share.map_or(self.body_count(), |s| {
            s.whole.total as usize - s.whole.vacant.len()
        })
    }

    /// The bodies here that belong to no other rank and whose numbers in the whole are at least `number`, ascending.
    pub fn own_bodies(&self, number: BodyId) -> impl DoubleEndedIterator<Item = BodyId> {
        let share = self.share.as_deref();
        let first = share.map_or(number, |share| {
            share.numbers.partition_point(|other| *other < number) as BodyId
        });
        let last = self.bodies.len() as BodyId;
        (first..last).filter(|&id| self.batch.contains(id) && !self.is_guest(id))
    }

    /// What there is to say of each body of the whole, in the order of their numbers: all ranks get all of it.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] if the world was not shared out over these ranks, and what `halo` reports.
    pub fn of_whole<T: Serialize + DeserializeOwned>(
        &self,
        halo: &mut dyn Halo,
        of: impl Fn(&Self, BodyId) -> T,
    ) -> Result<Vec<T>, SolveError> {
        self.fits(halo)?;
        let Some(share) = self.share.as_deref() else {
            return Ok(self.body_ids().map(|id| of(self, id)).collect());
        };
        let own = self.own_bodies(0);
        let own: Vec<(BodyId, T)> = own
            .map(|id| (share.numbers[id as usize], of(self, id)))
            .collect();
        let message = checkpoint::encode(&own)?;
        let messages = (0..halo.size()).map(|rank| (rank, message.clone()));
        let mut all = Vec::new();
        for (_, bytes) in halo.send(messages.collect())? {
            let part: Vec<(BodyId, T)> = checkpoint::decode(&bytes)?;
            all.extend(part);
        }
        all.sort_by_key(|(number, _)| *number);
        Ok(all.into_iter().map(|(_, value)| value).collect())
    }
}

/// Puts a number into a list, ascending.
fn insert(list: &mut Vec<BodyId>, id: BodyId) {
    let at = list.partition_point(|other| *other < id);
    list.insert(at, id);
}

impl Share {
    /// The link with a rank, a new one if need be.
    fn link(&mut self, rank: usize) -> &mut Link {
        let at = self.links.partition_point(|link| link.rank < rank);
        if self.links.get(at).is_none_or(|link| link.rank != rank) {
            let (lent, guests) = Default::default();
            self.links.insert(at, Link { rank, lent, guests });
        }
        &mut self.links[at]
    }
}
