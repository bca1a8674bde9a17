//! What a simulation has from the pack from which it started, and what its scene has added.

use serde::{Deserialize, Serialize};

/// What a simulation has from a pack, and which walls its scene has added.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Number of bodies of the pack: they are the first members.
    pub bodies: usize,
    /// Walls of the pack, by number in the world, without those that the scene has removed.
    pub container: Vec<u32>,
    /// Walls in the world of each `[[wall]]` of the scene: its own, or the wall of the pack of that name.
    pub walls: Vec<Vec<u32>>,
    /// Number of bodies of each `[[body]]` of the scene.
    pub members: Vec<usize>,
}
