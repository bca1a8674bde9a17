//! Connected parts of an overlap.

use super::sums::Sums;
use crate::disjoint::{find, join};
use crate::kernel::Overlap;
use crate::tets::cells::{Cells, NONE};
use crate::tets::pieces::Faces;

/// One connected part of the overlap of two bodies (or of a wall A and a body B).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its contact, as the convex kernel would return it.
    pub overlap: Overlap,
    /// The first pair of tetrahedra (of A, of B) in it with the skin of one in the other. Patches come in the order of their
    /// keys.
    pub key: [u32; 2],
}

/// What two tetrahedra contribute, and how their common part goes on in others.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Record {
    pub pair: [u32; 2],
    /// Whether the skin of one lies in the other.
    pub has_skin: bool,
    /// Faces of either across which the common part goes on.
    pub faces: Faces,
    /// Edges of either's skin across which it goes on, as bits: 4 k + l for the edge of face k on face l.
    pub edges: [u16; 2],
    pub sums: Sums,
}

/// Finds for every record the first one of its patch. Records come in the order of their pairs.
///
/// They are joined across the faces of tetrahedra that bound both, and across edges of either skin. Where a face of A
/// coincides with one of B, they are also joined across both at once.
pub(crate) fn connect(records: &[Record], [a, b]: [&Cells; 2], root: &mut Vec<u32>) {
    root.clear();
    root.extend(0..records.len() as u32);
    let join = |root: &mut [u32], n: u32, pair: [u32; 2]| {
        // The other record of two joins them if it comes first.
        if pair > records[n as usize].pair
            && let Ok(m) = records.binary_search_by_key(&pair, |r| r.pair)
        {
            join(root, n, m as u32);
        }
    };
    for (n, record) in (0..).zip(records) {
        let [i, j] = record.pair;
        let bits = record.faces.bits;
        for k in 0..4 {
            let beside_i = across(a, i, k, bits);
            if let Some(i) = beside_i {
                join(root, n, [i, j]);
            }
            if let Some(j) = across(b, j, k, bits >> 4) {
                join(root, n, [i, j]);
            }
            if let (Some(i), true) = (beside_i, record.faces.coincide) {
                for l in 0..4 {
                    if let Some(j) = across(b, j, l, bits >> 4) {
                        join(root, n, [i, j]);
                    }
                }
            }
        }
        for i in round_edges(a, i, record.edges[0]) {
            join(root, n, [i, j]);
        }
        for j in round_edges(b, j, record.edges[1]) {
            join(root, n, [i, j]);
        }
    }
    for n in 0..root.len() {
        root[n] = find(root, n as u32);
    }
}

/// The tetrahedron across face k, if that face bounds the common part.
fn across(cells: &Cells, i: u32, k: usize, faces: u8) -> Option<u32> {
    if faces >> k & 1 == 0 {
        return None;
    }
    let next = cells.list.get(i as usize)?.neighbours[k];
    (next != NONE).then_some(next)
}

/// The tetrahedra behind the next triangles of the skin.
fn round_edges(cells: &Cells, i: u32, edges: u16) -> impl Iterator<Item = u32> {
    let beside = cells.list.get(i as usize).map(|cell| &cell.beside);
    let mut left = edges;
    std::iter::from_fn(move || {
        (left != 0).then(|| {
            let bit = left.trailing_zeros() as usize;
            left &= left - 1;
            beside.map_or(NONE, |beside| beside[bit / 4][bit % 4])
        })
    })
}
