//! What the cuts of a contact did the last time.
//!
//! From step to step the polygons of a contact mostly keep the edges that cut them. A cut that is known beforehand needs
//! no decision on its numbers, which the processor would often guess wrong: the cut looks up what it did, checks it at the
//! corners next to the crossings, and only if it did something else looks at all corners.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// What a line did to a polygon of fewer than 16 corners, in a byte.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Outcome(u8);

/// The same in words. Wrong ones do no harm: they are checked where they are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Told {
    /// Nothing is cut away; this corner is the nearest to the line.
    Whole(usize),
    /// Nothing is left; this corner is the nearest to the line.
    Empty(usize),
    /// So many corners are cut away, from this one on.
    Part { from: usize, count: usize },
}

/// Polygons with as many corners have no outcome that fits.
pub(crate) const TOO_LONG: usize = 16;

const EMPTY: u8 = 15;

impl Outcome {
    /// An outcome on a polygon of fewer than [`TOO_LONG`] corners.
    #[inline]
    pub fn new(told: Told) -> Self {
        let (corner, count) = match told {
            Told::Whole(corner) => (corner, 0),
            Told::Empty(corner) => (corner, EMPTY),
            Told::Part { from, count } => (from, count as u8),
        };
        Self((corner as u8) << 4 | count & 15)
    }

    #[inline(always)]
    pub fn told(self) -> Told {
        let corner = usize::from(self.0 >> 4);
        match self.0 & 15 {
            0 => Told::Whole(corner),
            EMPTY => Told::Empty(corner),
            count => Told::Part {
                from: corner,
                count: usize::from(count),
            },
        }
    }
}

/// The outcomes of the cuts of a contact, in the order in which they are made. A cut that is made no more, or is new, shifts
/// the ones after it, which then do not help once.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Trail {
    outcomes: SmallVec<[Outcome; 32]>,
    #[serde(skip)]
    at: usize,
}

impl Trail {
    /// Goes back to the first cut.
    #[inline(always)]
    pub fn begin(&mut self) {
        self.at = 0;
    }

    /// The outcome of the next cut the last time, to be replaced if it is another now.
    #[inline(always)]
    pub fn next(&mut self) -> &mut Outcome {
        let at = self.at;
        if at >= self.outcomes.len() {
            self.outcomes.resize(at + 1, Outcome::default());
        }
        self.at += 1;
        &mut self.outcomes[at]
    }
}
