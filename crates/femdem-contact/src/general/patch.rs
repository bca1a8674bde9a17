//! Connected parts of an overlap.

use crate::kernel::Overlap;

/// One connected part of the overlap of two bodies (or of a wall A and a body B).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its contact, as the convex kernel gives it.
    pub overlap: Overlap,
    /// The first pair of tetrahedra (of A, of B) in it. Patches come in the order of their keys.
    pub key: [u32; 2],
}
