//! The whole from its parts: in one world, or dealt to other ranks than those that had them.

use super::deal::{are_of_one_program, from_first};
use super::parts::{Member, Parts};
use super::{Cuts, Share, Until, Whole, ranks};
use crate::checkpoint;
use crate::error::SolveError;
use crate::halo::{Alone, Halo};
use crate::ledger::Flows;
use crate::world::World;
use crate::world::time_step::StepControl;
use std::collections::BTreeMap;

/// What a rank has of the books of the whole: flows, initial energy, and the bounds of the step.
type Books = (Flows, f64, StepControl);

impl World {
    /// All bodies in one world on the first rank, as if there were no others; the world here stays as it is. The models that bodies
    /// which have cracked have alone are numbered by their bodies there.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] if the world was not shared out over these ranks, and what `halo` reports.
    pub fn gather(&self, halo: &mut dyn Halo) -> Result<Option<Self>, SolveError> {
        self.fits(halo)?;
        let Some(share) = self.share.as_deref() else {
            return Ok(Some(self.clone()));
        };
        let mut whole = self.clone();
        let (parts, _) = whole.take_apart()?;
        let all = parts.gathered(halo)?;
        let received = halo.send(vec![(0, checkpoint::encode(&self.books())?)])?;
        if halo.rank() > 0 {
            return Ok(None);
        }
        (whole.flows, whole.initial_energy) = (Flows::default(), 0.0);
        for (_, bytes) in received {
            whole.add_books(&checkpoint::decode(&bytes)?);
        }
        whole.put_whole(&share.whole, all)?;
        Ok(Some(whole))
    }

    /// The whole, as if there had been no ranks, of which these are the parts of all ranks, at the same time.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] if they are not, and the first error among them.
    pub fn of_parts(
        parts: impl IntoIterator<Item = Result<Self, SolveError>>,
    ) -> Result<Self, SolveError> {
        let mut joined = Joined::default();
        for part in parts {
            joined.add(part?)?;
        }
        let Some((mut world, whole)) = joined.first else {
            return Err(ranks("a whole has at least one part"));
        };
        world.take_books(joined.books);
        world.put_whole(&whole, joined.parts)?;
        Ok(world)
    }

    /// Shares out a whole whose parts, as other ranks had them, the ranks have read: each some or none, the first one at least one.
    ///
    /// # Errors
    /// As [`of_parts`](Self::of_parts), and what `halo` reports. If parts are refused, all ranks get an error.
    pub fn share_parts(parts: Vec<Self>, halo: &mut dyn Halo) -> Result<Self, SolveError> {
        are_of_one_program(halo)?;
        let rank = halo.rank();
        // Some may be among the bodies of another part.
        let mut guests = BTreeMap::new();
        let join = || {
            let mut joined = Joined::default();
            for part in parts {
                let of_part = joined.add(part)?.into_iter();
                guests.extend(of_part.map(|guest| (guest.number, guest)));
            }
            let given = match &joined.first {
                Some((world, whole)) if rank == 0 => {
                    Some(checkpoint::encode(&(world.to_bytes()?, whole))?)
                }
                _ => None,
            };
            Ok::<_, SolveError>((joined, given))
        };
        let (joined, given) = unless_another_failed(join(), halo)?;
        let (bytes, whole): (Vec<u8>, Whole) = checkpoint::decode(&from_first(given, halo)?)?;
        let mut world = Self::from_bytes(&bytes)?;
        let first = joined.first.as_ref();
        let is_other = first.is_some_and(|(first, known)| !world.is_with(first) || *known != whole);
        let mut counts = [joined.parts.members.len() as u64, u64::from(is_other)];
        halo.sum(&mut counts)?;
        if counts != [u64::from(whole.total) - whole.vacant.len() as u64, 0] {
            return Err(not_all());
        }
        world.take_books(joined.books);
        world.step_control.share_steps(halo)?;
        let parts = joined.parts;
        let mut members: Vec<(Member, usize)> = Vec::new();
        for member in parts.members {
            guests.remove(&member.number);
            members.push((member, rank));
        }
        // Those of any other rank, until all are dealt.
        members.extend(guests.into_values().map(|guest| (guest, usize::MAX)));
        members.sort_by_key(|(member, _)| member.number);
        let numbers = world.put_together(members, parts.pairs, parts.newcomers, rank);
        let numbers = unless_another_failed(numbers, halo)?;
        world.share = Some(Box::new(Share {
            rank,
            cuts: Cuts::to_first(halo.size()),
            whole,
            links: Vec::new(),
            until: vec![Until::default(); numbers.len()],
            holds: vec![false; numbers.len()],
            ended: parts.ended,
            numbers,
            spent: Default::default(),
        }));
        world.deal_again(halo)?;
        Ok(world)
    }

    /// A checksum of all bits of the motion: of the bodies, the contacts and their friction, and what is remembered of them. It is
    /// the same for any number of threads and of ranks ([`checksum_of_motion_on`](Self::checksum_of_motion_on)); the books are not
    /// part of it.
    ///
    /// # Errors
    /// As [`share_out`](Self::share_out) for what cannot be shared.
    pub fn checksum_of_motion(&self) -> Result<u64, SolveError> {
        self.not_shared("a checksum")?;
        self.checksum_of_motion_on(&mut Alone)
    }

    /// As [`checksum_of_motion`](Self::checksum_of_motion), of the whole of a world that may be [shared out](Self::share_out), by all
    /// ranks.
    ///
    /// # Errors
    /// As [`checksum_of_motion`](Self::checksum_of_motion), and what `halo` reports.
    pub fn checksum_of_motion_on(&self, halo: &mut dyn Halo) -> Result<u64, SolveError> {
        self.fits(halo)?;
        let (parts, _) = self.clone().take_apart()?;
        // Sums of the halves of what each has, which do not depend on their order.
        let mut sums = [0_u64; 2];
        let members = parts.members.iter().map(checkpoint::hash);
        let pairs = parts.pairs.iter().chain(&parts.ended);
        for hash in members.chain(pairs.map(checkpoint::hash)) {
            let hash = hash?;
            sums[0] += hash & u64::from(u32::MAX);
            sums[1] += hash >> 32;
        }
        halo.sum(&mut sums)?;
        let mut control = self.step_control;
        control.share_steps(halo)?;
        checkpoint::hash(&(self.time, self.steps, control, sums))
    }

    fn books(&self) -> Books {
        (self.flows, self.initial_energy, self.step_control)
    }

    fn add_books(&mut self, (flows, initial, control): &Books) {
        self.flows += *flows;
        self.initial_energy += initial;
        self.step_control.join(control);
    }

    /// Has only these books.
    fn take_books(&mut self, books: Vec<Books>) {
        (self.flows, self.initial_energy) = (Flows::default(), 0.0);
        for books in &books {
            self.add_books(books);
        }
    }

    /// Whether two parts are of the same step.
    fn is_with(&self, other: &Self) -> bool {
        (self.steps, self.time.to_bits()) == (other.steps, other.time.to_bits())
    }

    /// Puts all bodies of a whole in.
    fn put_whole(&mut self, whole: &Whole, mut all: Parts) -> Result<(), SolveError> {
        all.members.sort_by_key(|member| member.number);
        // All numbers of the whole are among what came, before lists of so many are made.
        let Whole { total, vacant, .. } = whole;
        let fits = all.members.iter().all(|member| member.number < *total);
        if !fits || all.members.len() + vacant.len() != *total as usize {
            return Err(not_all());
        }
        self.put_all(*total, all)
    }
}

fn not_all() -> SolveError {
    ranks("the ranks do not have all bodies of the whole, at one time")
}

/// What a rank has made, unless it or another has failed: then all have an error.
fn unless_another_failed<T>(
    made: Result<T, SolveError>,
    halo: &mut dyn Halo,
) -> Result<T, SolveError> {
    let mut failed = [u64::from(made.is_err())];
    halo.sum(&mut failed)?;
    if made.is_ok() && failed[0] > 0 {
        return Err(ranks("the parts that another rank has read are refused"));
    }
    made
}

/// Parts of a whole that are taken together.
#[derive(Default)]
struct Joined {
    /// The first of them, without its bodies.
    first: Option<(World, Whole)>,
    parts: Parts,
    books: Vec<Books>,
}

impl Joined {
    /// Takes a part, and returns its guests.
    fn add(&mut self, mut part: World) -> Result<Vec<Member>, SolveError> {
        part.restored()?;
        let books = part.books();
        let (own, guests) = part.take_apart()?;
        let Some(share) = part.share.take() else {
            return Err(ranks(
                "a world that was not shared out is no part of a whole",
            ));
        };
        self.books.push(books);
        self.parts.join(own);
        match &self.first {
            Some((first, whole)) if !part.is_with(first) || *whole != share.whole => {
                return Err(not_all());
            }
            Some(_) => {}
            None => self.first = Some((part, share.whole)),
        }
        Ok(guests)
    }
}
