//! Connected parts of an overlap.

use super::sums::Sums;
use crate::adhesion::VectorArea;
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
    /// The vector area of B's skin in it.
    pub touching: VectorArea,
}

/// What two tetrahedra contribute, and how their common part goes on in others.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Record {
    pub pair: [u32; 2],
    /// Whether the skin of one lies in the other.
    pub has_skin: bool,
    /// Faces of either across which the polygons, or the common part, go on.
    pub faces: Faces,
    /// Edges of either's skin across which it goes on, as bits: 4 k + l for the edge of face k on face l.
    pub edges: [u16; 2],
    pub sums: Sums,
}

/// Groups of records.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    /// The first record of the patch of each.
    pub root: Vec<u32>,
    /// Their pairs, for a search that does not visit the records.
    keys: Vec<u64>,
}

impl Groups {
    /// Finds for every record the first one of its patch. Records come in the order of their pairs.
    ///
    /// They are joined across the faces of tetrahedra that bound both, and across edges of either skin. Where a face of
    /// A coincides with one of B, they are also joined across both at once.
    pub fn connect(&mut self, records: &[Record], solids: [&Cells; 2]) {
        let Self { root, keys } = self;
        root.clear();
        root.extend(0..records.len() as u32);
        keys.clear();
        keys.extend(records.iter().map(|record| key(record.pair)));
        for (n, record) in (0_u32..).zip(records) {
            record.for_next(solids, |pair| {
                // Of two records the first joins both.
                let (wanted, rest) = (key(pair), &keys[n as usize..]);
                if rest.first().is_some_and(|own| wanted > *own)
                    && let Ok(m) = rest.binary_search(&wanted)
                {
                    join(root, n, n + m as u32);
                }
            });
        }
        for n in 0..root.len() {
            root[n] = find(root, n as u32);
        }
    }

    /// Whether every record goes on in another one wherever it should.
    pub fn are_whole(&self, records: &[Record], solids: [&Cells; 2]) -> bool {
        let mut whole = true;
        for record in records {
            record.for_next(solids, |pair| {
                whole &= self.keys.binary_search(&key(pair)).is_ok();
            });
        }
        whole
    }
}

fn key([i, j]: [u32; 2]) -> u64 {
    u64::from(i) << 32 | u64::from(j)
}

impl Record {
    /// Calls `next` with the pairs of tetrahedra in which the common part goes on.
    #[inline]
    fn for_next(&self, [a, b]: [&Cells; 2], mut next: impl FnMut([u32; 2])) {
        let [i, j] = self.pair;
        let (Some(of_i), Some(of_j)) = (a.list.get(i as usize), b.list.get(j as usize)) else {
            return;
        };
        let bits = self.faces.bits;
        for k in ones(u16::from(bits & 0b1111)) {
            let beside_i = of_i.neighbours[k];
            if beside_i == NONE {
                continue;
            }
            next([beside_i, j]);
            if self.faces.coincide {
                for l in ones(u16::from(bits >> 4)) {
                    if of_j.neighbours[l] != NONE {
                        next([beside_i, of_j.neighbours[l]]);
                    }
                }
            }
        }
        for k in ones(u16::from(bits >> 4)) {
            if of_j.neighbours[k] != NONE {
                next([i, of_j.neighbours[k]]);
            }
        }
        for bit in ones(self.edges[0]) {
            next([of_i.beside[bit / 4][bit % 4], j]);
        }
        for bit in ones(self.edges[1]) {
            next([i, of_j.beside[bit / 4][bit % 4]]);
        }
    }
}

/// The places of the bits that are set.
#[inline]
fn ones(mut bits: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (place < 16).then_some(place)
    })
}
