//! Worlds that share bodies: each rank owns those in its box, and has those near it as guests.
//!
//! A pair is evaluated on every rank that owns one of its bodies, to the same bits, so that no force travels. Guests follow their
//! owners: within a step they get the places and velocities after the drift, and at its end the owner says whether they are
//! awake. Local numbers ascend with those of the whole, so that sums are in the same order everywhere.
//!
//! Bodies are dealt anew before one of them can have come near another that its rank does not know of. In periodic space a body
//! belongs to the rank in whose box its image in the cell is.

mod bonds;
mod break_up;
mod cuts;
mod deal;
mod edges;
mod gather;
mod join;
mod leave;
mod map;
mod parts;
mod swap;

use super::World;
use super::time_step::LARGEST_MOVE;
use crate::error::SolveError;
use crate::guide::Guide;
use crate::halo::Halo;
use cuts::Cuts;
use edges::{Edges, carried};
use femdem_contact::{BodyId, PairRecord, Partner};
use femdem_fem::{Boundary, Driven};
pub(super) use join::Whose;
use map::Map;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::time::Duration;

/// How far a body may travel before all are dealt anew, over the largest radius; the last step adds at most
/// [`LARGEST_MOVE`].
const WAY: f64 = 0.5;

/// What a rank knows of the others.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Share {
    rank: usize,
    cuts: Cuts,
    /// Numbers in the whole, by local number.
    numbers: Vec<BodyId>,
    whole: Whole,
    /// The ranks that have guests of this one, or bodies that are guests here, ascending.
    links: Vec<Link>,
    /// Of each body, when all are dealt anew if it is an own one.
    until: Vec<Until>,
    /// Whether a guest that sleeps is balanced.
    holds: Vec<bool>,
    /// Bonds that have ended, by the numbers of their bodies in the whole; each is on one rank.
    ended: Vec<PairRecord>,
    /// Processor time and pairs evaluated when bodies were last dealt.
    #[serde(skip)]
    spent: (Duration, u64),
}

/// What all ranks know of the whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Whole {
    /// How many numbers there are, and those of them that name no body, ascending.
    total: u32,
    vacant: Vec<BodyId>,
    /// The largest radius of all bodies and shapes when they were dealt, m.
    largest: f64,
    /// The largest distance of the bodies of a bond that had not ended then, m.
    bonded: f64,
    /// The edges of the periodic cell at that time.
    edges: Edges,
    /// How bodies are driven, and nodes of deformable ones: functions of time.
    guides: Vec<Guide>,
    boundaries: Vec<Boundary>,
    /// Whether some bodies are bonded.
    bonds: bool,
    /// After how many steps each the stresses of bodies that may break are looked at.
    looks: BTreeSet<u32>,
}

impl Whole {
    /// How far a body may travel before all are dealt anew, m.
    fn way(&self) -> f64 {
        WAY * self.largest
    }

    /// Whether a number names a body.
    fn names(&self, number: BodyId) -> bool {
        number < self.total && self.vacant.binary_search(&number).is_err()
    }

    /// Of a world that has all bodies.
    fn of(world: &World, halo: &mut dyn Halo) -> Result<Self, SolveError> {
        let [largest, bonded] = world.lengths(halo)?;
        let total = world.bodies.len() as BodyId;
        let vacant = (0..total).filter(|id| !world.batch.contains(*id));
        let mut guides: Vec<Guide> = Vec::new();
        for (_, body) in world.live_bodies() {
            if let Some((guide, _)) = body.driven.as_deref()
                && !guides.contains(guide)
            {
                guides.push(*guide);
            }
        }
        let boundaries = world.own_nodes().map(|(_, nodes, _)| &nodes.boundary);
        let breakable = world.own_nodes();
        let breakable = breakable.filter_map(|(_, nodes, _)| nodes.breakable.as_deref());
        let looks = breakable.map(|breakable| breakable.fracture.every);
        let will_move = |b: &&Boundary| b.is_driven(world.time, f64::INFINITY);
        Ok(Self {
            total,
            vacant: vacant.collect(),
            largest,
            bonded,
            edges: world.edges(WAY * largest, halo)?,
            guides,
            boundaries: boundaries.filter(will_move).cloned().collect(),
            bonds: world.batch.has_bonds(),
            looks: looks.collect(),
        })
    }
}

impl Share {
    /// Whether a body, or nodes of one, move as prescribed at time `t` or within `ahead` after it, s.
    pub(super) fn is_driven(&self, t: f64, ahead: f64) -> bool {
        let Whole {
            guides, boundaries, ..
        } = &self.whole;
        guides.iter().any(|guide| guide.is_active(t, ahead))
            || boundaries.iter().any(|b| b.is_driven(t, ahead))
    }

    /// Whether several ranks share the whole.
    pub(super) fn is_of_many(&self) -> bool {
        self.cuts.ranks() > 1
    }

    /// Whether bodies of the whole were bonded when it was shared out.
    pub(super) fn has_bonds(&self) -> bool {
        self.whole.bonds
    }

    /// The number in the whole of a body that is here.
    pub(super) fn named(&self, id: usize) -> usize {
        self.numbers[id] as usize
    }
}

/// How far a body may go before all are dealt anew.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
struct Until {
    /// Its travel, m.
    travelled: f64,
    /// Its radius; that of a deformable body may grow, m.
    radius: f64,
    /// In periodic space: by how many edges it was away from the middle.
    away: [f64; 3],
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
    /// the number that a body had here. The ids of models that were added after a body had cracked may change, too, since the models
    /// that such bodies have alone come after all others.
    ///
    /// # Errors
    /// [`SolveError::Ranks`] for what cannot be shared: bodies that a host moves, bonded bodies that
    /// are far apart, bodies that break under custom laws, and [friction that begins](Self::begin_friction); if the worlds of the ranks differ, or their programs; and what `halo` reports.
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
    /// As [`step`](Self::step), and what `halo` reports. Over several ranks also [`SolveError::Ranks`] for a driven body that moves
    /// by more than a quarter of the largest radius of all bodies in a step, and [`SolveError::BodyFailed`] for driven nodes that
    /// move by more than a quarter of the depth of their body.
    pub fn step_on(&mut self, halo: &mut dyn Halo) -> Result<(), SolveError> {
        self.step_with_on(|_, _| None, halo)
    }

    /// As [`step_on`](Self::step_on), with a host that moves walls, as [`step_with`](Self::step_with): it says the same on all
    /// ranks.
    ///
    /// # Errors
    /// As [`step_on`](Self::step_on) and [`step_with`](Self::step_with).
    pub fn step_with_on(
        &mut self,
        mut host: impl FnMut(Partner, f64) -> Option<Driven>,
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.fits(halo)?;
        self.advance(&mut host, halo)
    }

    /// Whether the world has a part of the bodies of a whole.
    pub fn is_shared(&self) -> bool {
        self.share.is_some()
    }

    /// Whether a body of the whole may break.
    #[must_use]
    pub fn may_break(&self) -> bool {
        let mut own = self.own_nodes();
        match &self.share {
            Some(share) => !share.whole.looks.is_empty(),
            None => own.any(|(_, nodes, _)| nodes.breakable.is_some()),
        }
    }

    /// Whether a body belongs to another rank.
    pub fn is_guest(&self, id: BodyId) -> bool {
        self.batch.is_guest(id)
    }

    /// The number of a body in the whole.
    pub fn number_in_whole(&self, id: BodyId) -> Option<BodyId> {
        let known = self.batch.contains(id).then_some(id);
        match &self.share {
            Some(share) => share.numbers.get(known? as usize).copied(),
            None => known,
        }
    }

    /// Refuses ranks over which the world was not shared out.
    pub(super) fn fits(&self, halo: &dyn Halo) -> Result<(), SolveError> {
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

    /// Refuses what cannot be shared, as [`share_out`](Self::share_out).
    ///
    /// # Errors
    /// [`SolveError::Ranks`].
    pub fn can_be_shared(&self) -> Result<(), SolveError> {
        let of_bodies = self.live_bodies();
        let mut guides = of_bodies.filter_map(|(_, body)| body.driven.as_deref());
        let by_host = guides.any(|(guide, _)| guide.drive().is_none());
        for (what, is_there) in [
            ("bodies that a host moves", by_host),
            (
                "bodies that are deformable near their strength only",
                self.adaptive_bodies().next().is_some(),
            ),
            ("friction that begins", self.batch.begins_friction()),
        ] {
            if is_there {
                return Err(SolveError::Ranks {
                    why: format!("a world with {what} cannot be shared out: run it on one rank"),
                });
            }
        }
        if let Some(law) = self.custom_law_that_breaks() {
            return Err(SolveError::Ranks {
                why: format!(
                    "a world with bodies that break under the custom law \"{law}\" cannot be shared out, since that law does not travel: run it on one rank"
                ),
            });
        }
        self.check_bonds()
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

    /// Whether ranks share bonded bodies.
    pub(super) fn shares_bonds(&self) -> bool {
        self.share.as_deref().is_some_and(Share::has_bonds)
    }

    /// Bodies of other ranks that are driven: they are moved here too.
    pub(super) fn driven_guests(&self) -> Vec<BodyId> {
        let share = self.share.as_deref();
        let Some(share) = share.filter(|share| !share.whole.guides.is_empty()) else {
            return Vec::new();
        };
        let guests = share.links.iter().flat_map(|link| &link.guests).copied();
        guests.filter(|id| self.is_driven_body(*id)).collect()
    }

    fn is_driven_body(&self, id: BodyId) -> bool {
        self.bodies[id as usize].driven.is_some()
    }

    /// The largest of the speeds of driven bodies that the ranks give, m/s.
    pub(super) fn fastest_driven(&self, own: f64, halo: &mut dyn Halo) -> Result<f64, SolveError> {
        let share = self.share.as_deref();
        let mut least = [-own];
        if share.is_some_and(|share| !share.whole.guides.is_empty()) {
            halo.least(&mut least)?;
        }
        Ok(-least[0])
    }

    /// Refuses a driven body that moves so far in a step, m, that it may meet bodies that its rank does not know.
    pub(super) fn check_way(&self, body: usize, moved: f64) -> Result<(), SolveError> {
        let share = self.share.as_deref().filter(|share| share.is_of_many());
        if share.is_none_or(|share| moved <= LARGEST_MOVE * share.whole.largest) {
            return Ok(());
        }
        Err(SolveError::Ranks {
            why: format!(
                "driven body {} moves by more than {LARGEST_MOVE} of the largest radius of all bodies in a step: lower time_step.largest, or run it on one rank",
                self.number_in_whole(body as BodyId).unwrap_or_default()
            ),
        })
    }

    /// Whether no body can have come near another that its rank does not know, and several ranks have bodies: more than 0 if so.
    pub(super) fn slack(&self) -> f64 {
        let Some(share) = &self.share else {
            return f64::INFINITY;
        };
        if share.cuts.are_to_first() {
            return 0.0;
        }
        let paths = share.whole.edges.since(self.batch.edge_paths());
        let left = |i: BodyId| {
            let (until, way) = (share.until[i as usize], self.batch.way_and_reach(i));
            let grown = way.is_some_and(|[_, reach]| reach > until.radius);
            if grown {
                0.0
            } else {
                until.travelled - self.travelled(i) - carried(until.away, paths)
            }
        };
        let soft = self.own_nodes().map(|(id, ..)| id);
        let awake = self.awake.iter().copied().chain(soft);
        let edges = share.whole.edges.slack(share.whole.way(), paths);
        awake.map(left).fold(edges, f64::min)
    }

    /// Running bound of the distance any point of a body has travelled, m.
    fn travelled(&self, id: BodyId) -> f64 {
        let soft = self.batch.way_and_reach(id);
        soft.map_or(self.bodies[id as usize].travelled, |[way, _]| way)
    }
}

fn ranks(why: &str) -> SolveError {
    SolveError::Ranks {
        why: why.to_owned(),
    }
}
