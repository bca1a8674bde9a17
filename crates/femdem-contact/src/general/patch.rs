//! Connected parts of an overlap.

use super::pieces::Record;
use crate::disjoint::{find, join};
use crate::kernel::Overlap;
use crate::tets::cells::{Cells, NONE};

/// One connected part of the overlap of two bodies (or of a wall A and a body B).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its contact, as the convex kernel would return it.
    pub overlap: Overlap,
    /// The first pair of tetrahedra (of A, of B) in it. Patches come in the order of their keys.
    pub key: [u32; 2],
}

/// Finds for every piece the first one of its patch. Pieces come in the order of their pairs.
///
/// Pieces are joined across the faces of tetrahedra that bound both. Where a face of A coincides with one of
/// B, they are also joined across both at once.
pub(crate) fn connect(pieces: &[Record], a: &Cells, b: &Cells, root: &mut Vec<u32>) {
    root.clear();
    root.extend(0..pieces.len() as u32);
    let place = |pair: [u32; 2]| pieces.binary_search_by_key(&pair, |r| r.pair).ok();
    let join = |root: &mut [u32], n: u32, other: Option<usize>| {
        if let Some(m) = other {
            join(root, n, m as u32);
        }
    };
    for (n, piece) in (0..).zip(pieces) {
        let [i, j] = piece.pair;
        let bits = piece.faces.bits;
        for k in 0..4 {
            let beside_i = across(a, i, k, bits);
            let beside_j = across(b, j, k, bits >> 4);
            join(root, n, beside_i.and_then(|i| place([i, j])));
            join(root, n, beside_j.and_then(|j| place([i, j])));
            if let (Some(i), true) = (beside_i, piece.faces.coincide) {
                for l in 0..4 {
                    let beside_j = across(b, j, l, bits >> 4);
                    join(root, n, beside_j.and_then(|j| place([i, j])));
                }
            }
        }
    }
    for n in 0..root.len() {
        root[n] = find(root, n as u32);
    }
}

/// The tetrahedron across face k, if that face bounds the piece.
fn across(cells: &Cells, i: u32, k: usize, faces: u8) -> Option<u32> {
    let cell = cells.list.get(i as usize)?;
    let next = cell.neighbours[k];
    (faces >> k & 1 == 1 && next != NONE).then_some(next)
}
