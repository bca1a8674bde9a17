//! The sums of a body with itself.
//!
//! Its candidates are pairs of tetrahedra of the mesh. Only where these overlap are the parts looked at into which a
//! centroid may split them: the field is linear in each.

use super::near::Near;
use super::scratch::DeformableScratch;
use super::shape::DeformableShape;
use super::sums::{Place, Triangles};
use crate::tets::current::Current;
use crate::tets::pieces::intersect;
use crate::tets::posed::{Posed, PosedList};
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
        tet.deform(corners, &[0.0; 4], 1.0, whole.skin)
            .then(|| tet.planes())
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
        let DeformableScratch {
            tets,
            planes,
            wholes,
            piece,
            sums,
            candidates,
            ..
        } = scratch;
        let Near {
            origin,
            sides: members,
            pairs,
        } = near;
        sums.reset([0, 1].map(|side| members[side].nodes.len()));
        *candidates = 0;
        for (side, members) in members.iter().enumerate() {
            let count = members.tets.len();
            tets[side].reset(count);
            planes[side].reset(count);
            wholes[side].reset(count);
        }
        let (mut clear, [list_a, list_b], [tets_a, tets_b]) = (f64::INFINITY, wholes, tets);
        let [planes_a, planes_b] = planes;
        for candidate in pairs {
            let places = candidate.places;
            if motion >= candidate.clear
                && let [Some(a), Some(b)] =
                    [0, 1].map(|side| self.parts(members[side].tets.get(places[side] as usize)))
            {
                let pair = [a.whole, b.whole];
                let pose = |i: u32, room: &mut Posed| {
                    *room = self.shape.posed_whole(i, self.x, origin)?;
                    Some(())
                };
                let (Some(p), Some(q)) = (
                    list_a.get(places[0], |room| pose(a.whole, room)),
                    list_b.get(places[1], |room| pose(b.whole, room)),
                ) else {
                    continue;
                };
                *candidates += 1;
                if p.is_apart(q) {
                    candidate.clear = motion
                        + self
                            .shape
                            .gap_of_wholes(pair, [p, q], f64::INFINITY)
                            .max(0.0);
                } else {
                    let only_skin = self.shape.were_joined(pair);
                    let skinned = |at: &u32, side: usize| {
                        let tet = members[side].tets[*at as usize];
                        !only_skin || self.shape.tets()[tet as usize].skin != 0
                    };
                    for i in (places[0]..places[0] + a.count).filter(|at| skinned(at, 0)) {
                        for j in (places[1]..places[1] + b.count).filter(|at| skinned(at, 1)) {
                            let (Some(own), Some(other)) = (
                                self.place(tets_a, planes_a, members, 0, i, origin),
                                self.place(tets_b, planes_b, members, 1, j, origin),
                            ) else {
                                continue;
                            };
                            let Some(flush) = intersect(own.1, other.1, piece) else {
                                continue;
                            };
                            let common = piece.moments_and_faces(0, &mut 0, |_, _| ()).volume;
                            let smaller = own.0.tet.six_volumes.min(other.0.tet.six_volumes) / 6.0;
                            if common > SPECK * smaller {
                                let tet = &self.shape.tets()[members[1].tets[j as usize] as usize];
                                let triangles = Triangles {
                                    faces: tet.triangles,
                                    nearest: tet.nearest,
                                };
                                sums.add(
                                    [own.0, other.0],
                                    [own.1, other.1],
                                    &triangles,
                                    flush,
                                    piece,
                                );
                            }
                        }
                    }
                }
            }
            clear = clear.min(candidate.clear);
        }
        clear
    }

    /// The tetrahedron of the mesh whose first part this is.
    fn parts(&self, first: Option<&u32>) -> Option<Parts> {
        let (whole, part) = self.shape.parent(*first?)?;
        Some(Parts {
            whole,
            count: if part.is_some() { 4 } else { 1 },
        })
    }

    /// A part by its place on the list of a side.
    fn place<'p>(
        &self,
        tets: &'p mut PosedList<Current>,
        planes: &'p mut PosedList<Posed>,
        members: &'p [super::near::Members; 2],
        side: usize,
        at: u32,
        origin: &Vector3,
    ) -> Option<(Place<'p>, &'p Posed)> {
        let members = &members[side];
        let number = *members.tets.get(at as usize)?;
        let tet = tets.get(at, |room| {
            let corners = self.shape.corners(number, self.x)?.map(|x| x - origin);
            let tet = self.shape.tets().get(number as usize)?;
            let pressure = self.pressures[side];
            room.deform(corners, &tet.values, pressure, tet.skin)
                .then_some(())
        })?;
        let posed = planes.get(at, |room| {
            *room = tet.planes();
            Some(())
        })?;
        let place = Place {
            tet,
            place: at,
            nodes: members.corners.get(at as usize),
        };
        Some((place, posed))
    }
}

/// A tetrahedron of the mesh, and how many parts it has.
struct Parts {
    whole: u32,
    count: u32,
}
