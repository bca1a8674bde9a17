//! Bodies and walls that are removed from a shared world, and the places that they leave.

use super::parts::{bodies_of, has_ended};
use super::{Until, ranks};
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use crate::world::active::is_any;
use femdem_contact::{BodyId, PairRecord};

impl World {
    /// As [`remove_body`](Self::remove_body), of bodies by their numbers in the whole, in a world that is
    /// [shared out](Self::share_out), by all ranks with the same numbers.
    ///
    /// # Errors
    /// As [`remove_body`](Self::remove_body), [`SolveError::Ranks`] for a body that is driven, or whose nodes are, in a world that is
    /// shared out, and what `halo` reports.
    pub fn remove_bodies_on(
        &mut self,
        numbers: &[BodyId],
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.fits(halo)?;
        let driven = self.share.is_some() && numbers.iter().any(|number| self.drives(*number));
        if is_any(driven, halo)? {
            return Err(ranks(
                "removing a driven body is not possible in a world that is shared out: gather it first",
            ));
        }
        for &number in numbers {
            if self.share.is_some() {
                self.strike(number)?;
            } else {
                self.take_away(number)?;
            }
        }
        // Some have woken.
        self.tell_rest(halo)
    }

    /// As [`remove_wall`](Self::remove_wall), of walls of a world that is [shared out](Self::share_out), by all ranks.
    ///
    /// # Errors
    /// As [`remove_wall`](Self::remove_wall), and what `halo` reports.
    pub fn remove_walls_on(
        &mut self,
        walls: &[u32],
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.fits(halo)?;
        for &wall in walls {
            self.take_wall_away(wall)?;
        }
        self.tell_rest(halo)
    }

    /// Whether a body of a number of the whole is here and driven.
    fn drives(&self, number: BodyId) -> bool {
        self.number_here(number).is_some_and(|id| {
            let nodes = self.nodes_of(id);
            let moves =
                nodes.is_some_and(|nodes| nodes.boundary.is_driven(self.time, f64::INFINITY));
            moves || (self.batch.is_rigid(id) && self.is_driven_body(id))
        })
    }

    /// Strikes a number off the list of the whole, and takes its body away if it is here.
    fn strike(&mut self, number: BodyId) -> Result<(), SolveError> {
        let here = self.number_here(number);
        let count = self.count_in_whole();
        if let Some(share) = self.share.as_deref_mut() {
            let vacant = &mut share.whole.vacant;
            let at = vacant.partition_point(|other| *other < number);
            if number >= share.whole.total || vacant.get(at) == Some(&number) {
                return Err(SolveError::NoSuch {
                    what: "body",
                    index: number as usize,
                    count,
                });
            }
            vacant.insert(at, number);
            let stays = |pair: &PairRecord| bodies_of(pair).all(|other| other != number);
            share.ended.retain(stays);
            for link in &mut share.links {
                for list in [&mut link.lent, &mut link.guests] {
                    list.retain(|other| Some(*other) != here);
                }
            }
        }
        match here {
            Some(id) => self.take_away(id),
            None => self.note_removal(),
        }
    }

    /// Takes the places of removed bodies out of the lists here, and puts in those for bodies of these numbers in the whole, ascending:
    /// they are the ones that are free then.
    pub(super) fn make_room(&mut self, rooms: &[BodyId]) -> Result<(), SolveError> {
        let (all, is_own) = self.take_all()?;
        let Some(mut share) = self.share.take() else {
            return Ok(());
        };
        let mut numbers: Vec<BodyId> = all.members.iter().map(|member| member.number).collect();
        for &number in rooms {
            let at = numbers.partition_point(|other| *other < number);
            numbers.insert(at, number);
        }
        let local = |number: BodyId| Some(numbers.binary_search(&number).ok()? as BodyId);
        let moved = |id: &BodyId| local(share.numbers[*id as usize]);
        for link in &mut share.links {
            for list in [&mut link.lent, &mut link.guests] {
                *list = list.iter().filter_map(moved).collect();
            }
        }
        let before = |number: &BodyId| share.numbers.binary_search(number).ok();
        let until = |number| before(number).map_or(Until::default(), |id| share.until[id]);
        let until = numbers.iter().map(until).collect();
        let holds = |number| before(number).is_some_and(|id| share.holds[id]);
        let holds = numbers.iter().map(holds).collect();
        (share.until, share.holds) = (until, holds);
        // The other body of an ended bond need not be here.
        let (ended, pairs): (Vec<_>, Vec<_>) = all.pairs.into_iter().partition(has_ended);
        let ended = ended.into_iter();
        let ended = ended.filter(|pair| is_own(pair.sides().1));
        share.ended.extend(ended);
        let pairs = pairs.into_iter();
        let pairs = pairs.filter_map(|pair| pair.renumbered(local)).collect();
        self.newcomers = all.newcomers.renumbered(local);
        let members = all.members.into_iter().filter_map(|member| {
            let is_guest = !is_own(member.number);
            Some((local(member.number)?, (member, is_guest)))
        });
        self.put(numbers.len() as BodyId, members, pairs)?;
        share.numbers = numbers;
        self.share = Some(share);
        Ok(())
    }
}
