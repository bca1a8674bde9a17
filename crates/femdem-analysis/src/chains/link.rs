//! A link of a chain.

use serde::{Deserialize, Serialize};

/// A link of a chain, for tables and pictures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChainLink {
    /// One body.
    pub first: u32,
    /// The other; the higher index.
    pub second: u32,
    /// Force of the pair, friction included (N).
    pub force: f64,
    /// Number of its chain.
    pub chain: u32,
}
