//! Worlds that share bodies: each rank owns those in its box, and has those near it as guests.
//!
//! A pair is evaluated on every rank that owns one of its bodies, to the same bits, so that no force travels. Guests follow their
//! owners: within a step they get the places and velocities after the drift, and at its end the owner says whether they are
//! awake. Local numbers ascend with those of the whole, so that sums are in the same order everywhere.
//!
//! Bodies are dealt anew before one of them can have come near another that its rank does not know of.

mod cuts;
mod deal;
mod join;
mod parts;
mod swap;

use super::World;
use crate::error::SolveError;
use crate::halo::{Alone, Halo};
use cuts::Cuts;
use femdem_contact::BodyId;
pub(super) use join::Whose;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// What a rank knows of the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Share {
    rank: usize,
    cuts: Cuts,
    /// Numbers in the whole, by local number.
    numbers: Vec<BodyId>,
    /// How many numbers the whole has, and how many of them name no body.
    total: u32,
    vacant: u32,
    /// The ranks that have guests of this one, or bodies that are guests here, ascending.
    links: Vec<Link>,
    /// Travel of each body at which all are dealt anew if it is an own one, m.
    until: Vec<f64>,
    /// Whether a guest that sleeps is balanced.
    holds: Vec<bool>,
    /// Processor time and pairs evaluated when bodies were last dealt.
    #[serde(skip)]
    spent: (Duration, u64),
}

/// What two ranks exchange; lists by local number, ascending.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Link {
    rank: usize,
    /// Own bodies that are guests there.
    lent: Vec<BodyId>,
    /// Guests from there.
    guests: Vec<BodyId>,
}

impl World {
    /// Keeps the bodies of this rank, and those near them, of a world that all ranks have built alike. From then on
    /// [`step_on`](Self::step_on) advances it.
    ///
    /// The ids of its bodies are local from then on, until bodies are next dealt: [`number_in_whole`](Self::number_in_whole) is
    /// the number that a body had here.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] for what cannot be shared: deformable and driven bodies, bonds, a periodic cell; if the worlds of the ranks differ, or their programs; and what `halo` reports.
    pub fn share_out(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        self.share_out_with(&(), halo)
    }

    /// As [`share_out`](Self::share_out), if the ranks have also made the same of something else, which decides what they do next.
    ///
    /// # Errors
    /// As [`share_out`](Self::share_out), and [`SolveError::Encoding`] if it cannot be encoded.
    pub fn share_out_with(
        &mut self,
        other: &impl Serialize,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.restored()?;
        self.not_shared("sharing it out again")?;
        self.can_be_shared()?;
        // The step is bounded by all bodies.
        self.renew_cap(&mut Alone)?;
        self.agree(other, halo)?;
        self.deal_whole(halo)
    }

    /// As [`step`](Self::step), of a world that is [shared out](Self::share_out).
    ///
    /// [Implicit](crate::ImplicitStep) steps are taken by the first rank, which has all bodies meanwhile.
    ///
    /// The state of all ranks together is the same bits as that of a world of its own after as many steps, for any number of
    /// ranks.
    ///
    /// # Errors
    /// As [`step`](Self::step), and what `halo` reports.
    pub fn step_on(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        self.fits(halo)?;
        self.advance(&mut |_, _| None, halo)
    }

    /// Whether the world has a part of the bodies of a whole.
    pub fn is_shared(&self) -> bool {
        self.share.is_some()
    }

    /// Whether a body belongs to another rank.
    pub fn is_guest(&self, id: BodyId) -> bool {
        self.batch.is_guest(id)
    }

    /// The number of a body in the whole.
    pub fn number_in_whole(&self, id: BodyId) -> Option<BodyId> {
        let known = self.batch.is_rigid(id).then_some(id);
        match &self.share {
            Some(share) => share.numbers.get(known? as usize).copied(),
            None => known,
        }
    }

    /// Refuses ranks over which the world was not shared out.
    fn fits(&self, halo: &dyn Halo) -> Result<(), SolveError> {
        let own = self.share.as_deref();
        let [rank, size] = own.map_or([0, 1], |share| [share.rank, share.cuts.ranks()]);
        if [rank, size] == [halo.rank(), halo.size()] {
            return Ok(());
        }
        Err(ranks("the world was not shared out over these ranks"))
    }

    /// Refuses what a part of a whole cannot do alone.
    pub(super) fn not_shared(&self, what: &'static str) -> Result<(), SolveError> {
        if self.share.is_some() {
            return Err(SolveError::Ranks {
                why: format!(
                    "{what} is not possible in a world that is shared out: gather it first"
                ),
            });
        }
        Ok(())
    }

    fn can_be_shared(&self) -> Result<(), SolveError> {
        let driven = self.live_bodies().any(|(_, body)| body.driven.is_some());
        let by_host = self
            .wall_drives
            .iter()
            .any(|(guide, _)| guide.drive().is_none());
        for (what, is_there) in [
            ("walls that a host moves", by_host),
            ("bonds", self.batch.bonds().next().is_some()),
            ("deformable bodies", self.deformables.is_some()),
            ("driven bodies", driven),
            ("a periodic cell", self.cell().is_some()),
        ] {
            if is_there {
                return Err(SolveError::Ranks {
                    why: format!("a world with {what} cannot be shared out: run it on one rank"),
                });
            }
        }
        Ok(())
    }

    /// Checks that the ranks have the same program, the same world and the same of something else.
    fn agree(&self, other: &impl Serialize, halo: &mut dyn Halo) -> Result<(), SolveError> {
        let hash = crate::checkpoint::hash(&(self, other))?;
        let mine = [
            f64::from(crate::checkpoint::VERSION),
            f64::from(hash as u32),
            f64::from((hash >> 32) as u32),
        ];
        let mut least = [mine, mine.map(|x| -x)].concat();
        halo.least(&mut least)?;
        let agrees = (0..3).all(|k| least[k] == -least[3 + k]);
        if agrees {
            return Ok(());
        }
        Err(ranks(
            "the ranks have different programs, or have made different worlds or jobs: start all with the same program and input",
        ))
    }

    /// Whether no body can have come near another that its rank does not know, and several ranks have bodies: more than 0 if so.
    pub(super) fn slack(&self) -> f64 {
        let Some(share) = &self.share else {
            return f64::INFINITY;
        };
        if share.cuts.are_to_first() {
            return 0.0;
        }
        let left = |&i: &BodyId| share.until[i as usize] - self.bodies[i as usize].travelled;
        self.awake.iter().map(left).fold(f64::INFINITY, f64::min)
    }
}

fn ranks(why: &str) -> SolveError {
    SolveError::Ranks {
        why: why.to_owned(),
    }
}
