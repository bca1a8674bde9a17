//! Bodies that crack and fall into parts: their owners decide, and the guests follow.
//!
//! Contacts are evaluated anew in the step in which a body cracks or falls apart anywhere, by all ranks, as one world does. What
//! becomes of the friction of a contact is found on both sides of a border, from the same numbers and in the same order.

use super::{Share, ranks};
use crate::checkpoint;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use crate::world::active::is_any;
use crate::world::deformables::{Fragment, Fragmentation, GuestFragment, Model, State};
use femdem_contact::BodyId;
use std::collections::BTreeMap;

/// Bodies that have fallen into parts, by number, with the parts.
pub(in crate::world) type Fallen = Vec<(BodyId, Vec<Fragment>)>;

impl World {
    /// Adds the guests that have cracked, with their models, to the own bodies that have, ascending; all guests that are deformable get the
    /// places and velocities of their nodes. Returns whether a body has cracked on any rank.
    pub(in crate::world) fn tell_cracks(
        &mut self,
        cracked: &mut Vec<(BodyId, Model)>,
        halo: &mut dyn Halo,
    ) -> Result<bool, SolveError> {
        let (own, steps) = (!cracked.is_empty(), self.steps);
        let Some(share) = self.share.take() else {
            return Ok(own);
        };
        let mut looks = share.whole.looks.iter();
        let looked = looks.any(|every| steps.is_multiple_of(u64::from(*every)));
        let told = match looked {
            false => Ok(own),
            true => is_any(own, halo).and_then(|any| {
                if any {
                    self.swap_cracks(&share, cracked, halo)?;
                }
                Ok(any)
            }),
        };
        self.share = Some(share);
        told
    }

    fn swap_cracks(
        &mut self,
        share: &Share,
        cracked: &mut Vec<(BodyId, Model)>,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        let mut messages = Vec::new();
        for link in &share.links {
            let mut told: Vec<(BodyId, &Model, State)> = Vec::new();
            for (id, model) in &*cracked {
                if link.lent.binary_search(id).is_ok()
                    && let Some(nodes) = self.deformables.as_mut().and_then(|d| d.nodes_mut(*id))
                {
                    told.push((share.numbers[*id as usize], model, nodes.as_guest()));
                }
            }
            messages.push(checkpoint::encode(&(
                told,
                self.numbers_of_soft(&link.lent),
            ))?);
        }
        for (link, bytes) in share.links.iter().zip(share.exchange(messages, halo)?) {
            let (told, numbers): (Vec<(BodyId, Model, State)>, Vec<u8>) =
                checkpoint::decode(&bytes)?;
            for (number, model, mut state) in told {
                let id = guest(share, &link.guests, number)?;
                let known = self.tets_of(id);
                let nodes = self.deformables.as_mut().and_then(|d| d.nodes_mut(id));
                let (Some(tets), Some(nodes)) = (known, nodes) else {
                    return Err(unknown(number));
                };
                if !state.is_of_guest(&model, tets) {
                    return Err(unfit(number));
                }
                state.model = nodes.model;
                *nodes = state;
                cracked.push((id, model));
            }
            self.place_soft_guests(&link.guests, &numbers)?;
        }
        cracked.sort_by_key(|(id, _)| *id);
        if let Some(twice) = cracked.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(unfit(share.numbers[twice[0].0 as usize]));
        }
        Ok(())
    }

    /// Whether a body has fallen into parts on any rank.
    pub(in crate::world) fn is_any_fallen(
        &self,
        so: bool,
        halo: &mut dyn Halo,
    ) -> Result<bool, SolveError> {
        match self.share.as_deref() {
            None => Ok(so),
            Some(share) if share.whole.looks.is_empty() => Ok(false),
            Some(_) => is_any(so, halo),
        }
    }

    /// Gives the parts of the bodies that have fallen apart their numbers in the whole, which it returns, and place for them here. The
    /// own ones that are given go to their guests, those of guests are added; numbers here may be others from then on.
    pub(in crate::world) fn tell_fallen(
        &mut self,
        mut fallen: Fallen,
        halo: &mut dyn Halo,
    ) -> Result<(Fallen, Vec<Fragmentation>), SolveError> {
        let Some(share) = self.share.as_deref() else {
            return Ok((fallen, Vec::new()));
        };
        let named = |id: BodyId| share.numbers[id as usize];
        // How many parts the bodies of all ranks have.
        let counts: Vec<(BodyId, usize)> = fallen
            .iter()
            .map(|(id, parts)| (named(*id), parts.len()))
            .collect();
        let counts = checkpoint::encode(&counts)?;
        let to_all = (0..halo.size()).map(|rank| (rank, counts.clone()));
        let mut all: BTreeMap<BodyId, usize> = BTreeMap::new();
        for (_, bytes) in halo.send(to_all.collect())? {
            let own: Vec<(BodyId, usize)> = checkpoint::decode(&bytes)?;
            for (number, count) in own {
                let is_there = share.whole.names(number) && count > 1;
                if !is_there || all.insert(number, count).is_some() {
                    return Err(unfit(number));
                }
            }
        }
        let mut messages = Vec::new();
        for link in &share.links {
            let lent = fallen.iter_mut();
            let lent = lent.filter(|(id, _)| link.lent.binary_search(id).is_ok());
            let mut told = Vec::new();
            for (id, parts) in lent {
                let parts = parts.iter_mut().map(Fragment::as_guest);
                told.push((named(*id), parts.collect::<Vec<_>>()));
            }
            messages.push(checkpoint::encode(&told)?);
        }
        let mut here: Fallen = Vec::new();
        for (link, bytes) in share.links.iter().zip(share.exchange(messages, halo)?) {
            let told: Vec<(BodyId, Vec<GuestFragment>)> = checkpoint::decode(&bytes)?;
            for (number, parts) in told {
                guest(share, &link.guests, number)?;
                let parts = parts.into_iter().map(Fragment::of_guest);
                let parts: Option<Vec<Fragment>> = parts.collect::<Result<_, _>>()?;
                let counted = |parts: &Vec<Fragment>| all.get(&number) == Some(&parts.len());
                let parts = parts.filter(counted).ok_or_else(|| unfit(number))?;
                here.push((number, parts));
            }
        }
        let own = fallen.into_iter();
        here.extend(own.map(|(id, parts)| (named(id), parts)));
        here.sort_by_key(|(number, _)| *number);

        let fragmentations = self.number_parts(&all)?;
        let is_here = |body: &BodyId| {
            here.binary_search_by_key(body, |(number, _)| *number)
                .is_ok()
        };
        let rooms = fragmentations.iter().filter(|f| is_here(&f.body));
        let rooms: Vec<BodyId> = rooms.flat_map(|f| &f.fragments).copied().collect();
        if !rooms.is_empty() {
            self.make_room(&rooms)?;
        }
        let mut fallen = Vec::new();
        for (number, parts) in here {
            let id = self.number_here(number).ok_or_else(|| unknown(number))?;
            fallen.push((id, parts));
        }
        Ok((fallen, fragmentations))
    }

    /// Numbers in the whole for the parts of bodies: the body's for the first, and the next that are free.
    fn number_parts(
        &mut self,
        counts: &BTreeMap<BodyId, usize>,
    ) -> Result<Vec<Fragmentation>, SolveError> {
        let Some(share) = self.share.as_deref_mut() else {
            return Ok(Vec::new());
        };
        let whole = &mut share.whole;
        let mut vacant = std::mem::take(&mut whole.vacant).into_iter();
        let mut fragmentations = Vec::new();
        for (&body, &count) in counts {
            let mut fragments = Vec::new();
            for _ in 1..count {
                fragments.push(match vacant.next() {
                    Some(number) => number,
                    None => {
                        let next = whole.total.checked_add(1);
                        let full = || ranks("there are no more numbers for bodies");
                        std::mem::replace(&mut whole.total, next.ok_or_else(full)?)
                    }
                });
            }
            fragmentations.push(Fragmentation { body, fragments });
        }
        whole.vacant = vacant.collect();
        Ok(fragmentations)
    }

    /// Notes that the parts of guests are guests.
    pub(in crate::world) fn follow_whole(&mut self, parts: &Fragmentation) {
        if self.is_guest(parts.body) {
            for id in parts.fragments.iter().chain([&parts.body]) {
                self.batch.make_guest(*id);
            }
        }
    }
}

/// The number here of a guest.
fn guest(share: &Share, guests: &[BodyId], number: BodyId) -> Result<BodyId, SolveError> {
    let id = share.numbers.binary_search(&number).ok();
    let id = id.map(|id| id as BodyId);
    let id = id.filter(|id| guests.binary_search(id).is_ok());
    id.ok_or_else(|| unknown(number))
}

/// What came about a body does not fit together.
fn unfit(number: BodyId) -> SolveError {
    ranks(&format!(
        "a message came about cracks or parts of body {number} that cannot be"
    ))
}

fn unknown(number: BodyId) -> SolveError {
    ranks(&format!(
        "a message came about body {number}, which is no guest here"
    ))
}
