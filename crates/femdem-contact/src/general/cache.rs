//! Which tetrahedra of a pair can meet, and for how long that is known.

use serde::{Deserialize, Serialize};

/// What the general kernel remembers of a pair: that it is apart, or which tetrahedra can meet. It
/// never changes which contacts are found; a fresh cache gives the same result to round-off.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GeneralCache {
    /// The state holds while the motion is below this, m.
    until: f64,
    /// Motion at the last evaluation, m.
    last: f64,
    /// `None`: the bodies are apart.
    near: Option<Box<Near>>,
}

/// Candidate pairs.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Near {
    /// Tetrahedra of A and of B that appear in pairs, ascending.
    pub in_a: Vec<u32>,
    pub in_b: Vec<u32>,
    /// Places in `in_a` and `in_b`, in ascending order.
    pub pairs: Vec<[u32; 2]>,
}

impl GeneralCache {
    /// Whether the pair was close enough for contact when the cache was last renewed.
    pub fn is_near(&self) -> bool {
        self.near.is_some()
    }

    /// Whether `motion` still lies within what the cache allows without a look at the pair.
    pub fn is_clear(&self, motion: f64) -> bool {
        self.near.is_none() && motion < self.until
    }
}
