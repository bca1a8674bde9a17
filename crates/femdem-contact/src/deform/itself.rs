//! The sums of a body with itself.
//!
//! Its candidates are pairs of tetrahedra of the mesh. Only where these overlap are the parts looked at into which a
//! centroid may split them: the field is linear in each.

use super::near::{Members, Near};
use super::scratch::DeformableScratch;
use super::shape::DeformableShape;
use super::sums::{Place, Triangles};
use crate::tets::current::Current;
use crate::tets::piece::Piece;
use crate::tets::pieces::intersect;
use crate::tets::posed::Posed;
use femdem_mesh::Vector3;

/// A common part of two tetrahedra is round-off if its volume is below this fraction of the smaller one's: where they have corners
/// in common, or lie on each other.
const SPECK: f64 = 1e-12;

impl DeformableShape {
    /// Tetrahedron `i` of the mesh at positions of the nodes, about an origin; `None` if it is inverted.
    pub(super) fn posed_whole(&self, i: u32, x: &[Vector3], origin: &Vector3) -> Option<Posed> {
        let whole = self.wholes().get(i as usize)?;
        let mut corners = [Vector3::zeros(); 4];
        for (corner, node) in corners.iter_mut().zip(whole.nodes) {
            *corner = x.get(node as usize)? - origin;
        }
        let mut tet = Current::default();
        tet.deform(corners, &[0.0; 4], 1.0, 0).then(|| tet.planes())
    }

    /// Which corners two tetrahedra of the mesh have in common, as bits of each.
    pub(super) fn common_corners(&self, pair: [u32; 2]) -> [u8; 2] {
        let [a, b] = pair.map(|i| self.wholes()[i as usize].nodes);
        let of = |own: &[u32; 4], other: &[u32; 4]| {
            (0..4).fold(0, |bits, k| bits | (u8::from(other.contains(&own[k])) << k))
        };
        [of(&a, &b), of(&b, &a)]
    }

    /// The motion up to which two tetrahedra of the mesh do not overlap, m; more than `enough` is not looked for.
    pub(super) fn gap_of_wholes(&self, pair: [u32; 2], [a, b]: [&Posed; 2], enough: f64) -> f64 {
        let common = self.common_corners(pair);
        if common[0] == 0 {
            a.gap(b, enough)
        } else {
            a.hinge_gap(b, common)
        }
    }
}

/// A body at positions of its nodes (m), whose fields are multiplied by `pressures` (Pa).
pub(super) struct Itself<'a> {
    pub shape: &'a DeformableShape,
    pub x: &'a [Vector3],
    pub pressures: [f64; 2],
}

impl Itself<'_> {
    /// Computes the sums in the scratch. Returns up to which motion no candidates touch. What is inverted does not touch: its
    /// element has no stress, or the body will soon turn it back.
    pub fn sum(&self, near: &mut Near, motion: f64, scratch: &mut DeformableScratch) -> f64 {
        let Near {
            origin,
            sides: members,
            pairs,
        } = near;
        scratch
            .sums
            .reset([0, 1].map(|side| members[side].nodes.len()));
        scratch.candidates = 0;
        for (side, members) in members.iter().enumerate() {
            let count = members.tets.len();
            scratch.tets[side].reset(count);
            scratch.planes[side].reset(count);
            scratch.wholes[side].reset(count);
        }
        let mut clear = f64::INFINITY;
        for candidate in pairs {
            let [i, j] = candidate.places;
            let parts = [(0, i), (1, j)].map(|(side, at)| self.parts(&members[side], at));
            if motion >= candidate.clear
                && let [Some(a), Some(b)] = parts
            {
                let [list_a, list_b] = &mut scratch.wholes;
                let pose = |whole: u32, room: &mut Posed| {
                    *room = self.shape.posed_whole(whole, self.x, origin)?;
                    Some(())
                };
                let (Some(p), Some(q)) = (
                    list_a.get(i, |room| pose(a.whole, room)),
                    list_b.get(j, |room| pose(b.whole, room)),
                ) else {
                    clear = clear.min(motion);
                    continue;
                };
                scratch.candidates += 1;
                let pair = [a.whole, b.whole];
                let gap = self.shape.gap_of_wholes(pair, [p, q], f64::INFINITY);
                candidate.clear = motion + gap.max(0.0);
                if gap <= 0.0 && common_part(p, q, &mut scratch.piece).is_some() {
                    let [of_a, of_b] = [(p, a.count), (q, b.count)]
                        .map(|(tet, count)| reached(tet, count, &scratch.piece));
                    for (k, l) in (0..16).map(|both| (both / 4, both % 4)) {
                        if of_a >> k & of_b >> l & 1 == 1 {
                            self.add([i + k, j + l], members, origin, scratch);
                        }
                    }
                }
            }
            clear = clear.min(candidate.clear);
        }
        clear
    }

    /// Adds the common part of two tetrahedra of the contact mesh, by their places on the lists.
    fn add(
        &self,
        [i, j]: [u32; 2],
        members: &[Members; 2],
        origin: &Vector3,
        scratch: &mut DeformableScratch,
    ) -> Option<()> {
        let DeformableScratch {
            tets: [tets_a, tets_b],
            planes: [planes_a, planes_b],
            piece,
            sums,
            ..
        } = scratch;
        let pose = |side: usize, at: u32, room: &mut Current| {
            let number = *members[side].tets.get(at as usize)?;
            let tet = self.shape.tets().get(number as usize)?;
            let corners = self.shape.corners(number, self.x)?.map(|x| x - origin);
            room.deform(corners, &tet.values, self.pressures[side], tet.skin)
                .then_some(())
        };
        let planes = |tet: &Current, room: &mut Posed| {
            *room = tet.planes();
            Some(())
        };
        let own = tets_a.get(i, |room| pose(0, i, room))?;
        let other = tets_b.get(j, |room| pose(1, j, room))?;
        let posed = [
            planes_a.get(i, |room| planes(own, room))?,
            planes_b.get(j, |room| planes(other, room))?,
        ];
        let flush = common_part(posed[0], posed[1], piece)?;
        let places = [(own, i, 0), (other, j, 1)].map(|(tet, place, side)| Place {
            tet,
            place,
            nodes: members[side].corners.get(place as usize),
        });
        let of_b = &self.shape.tets()[members[1].tets[j as usize] as usize];
        let triangles = Triangles {
            faces: of_b.triangles,
            nearest: of_b.nearest,
        };
        sums.add(places, posed, &triangles, flush, piece);
        Some(())
    }

    /// The tetrahedron of the mesh whose first part is at a place.
    fn parts(&self, members: &Members, place: u32) -> Option<Parts> {
        let first = members.tets.get(place as usize)?;
        let (whole, part) = self.shape.parent(*first)?;
        Some(Parts {
            whole,
            count: if part.is_some() { 4 } else { 1 },
        })
    }
}

/// Cuts the common part of two tetrahedra into `piece`; `None` if it is no more than round-off, otherwise whether faces of both may
/// coincide.
fn common_part(a: &Posed, b: &Posed, piece: &mut Piece) -> Option<bool> {
    let volumes = [a, b].map(Posed::volume);
    let least = SPECK * volumes[0].min(volumes[1]);
    // What is cut out has errors of its own, far smaller than a speck.
    let surely = 0.5 * least;
    if a.part_under(b) * volumes[1] < surely || b.part_under(a) * volumes[0] < surely {
        return None;
    }
    let flush = intersect(a, b, piece)?;
    let common = piece.moments_and_faces(0, &mut 0, |_, _| ()).volume;
    (common > least).then_some(flush)
}

/// Which parts of a tetrahedron a piece of it can reach, as bits. Part k is where the share of corner k is the least of all.
fn reached(tet: &Posed, count: u32, piece: &Piece) -> u8 {
    if count == 1 {
        return 1;
    }
    // Bit l of below[k]: somewhere the share of k is at most that of l.
    let mut below = [0_u8; 4];
    let heights = [0, 1, 2, 3].map(|k| tet.depth(k, &tet.corners[k]));
    for x in piece.vertices() {
        let shares = [0, 1, 2, 3].map(|k| tet.depth(k, x) / heights[k]);
        for (k, bits) in below.iter_mut().enumerate() {
            for (l, share) in shares.iter().enumerate() {
                *bits |= u8::from(shares[k] <= *share) << l;
            }
        }
    }
    (0..4).fold(0, |parts, k| parts | (u8::from(below[k] == 0b1111) << k))
}

/// A tetrahedron of the mesh, and how many parts it has.
struct Parts {
    whole: u32,
    count: u32,
}
