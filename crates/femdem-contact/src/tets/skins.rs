//! The polygons in which the skins of two meshes lie in each other's tetrahedra, and what they tell of the overlap.
//!
//! Integrals over the part of a tetrahedron i that lies in the other body need no part to be cut out. φ is Σ φ_k N_k over
//! the corners k. With g = 1 - N_k, the field w = (x - x_k) (1/3 - g/4 - 1/(12 g³)) has the divergence N_k except at x_k; it
//! lies in the three faces that meet in x_k and is zero on the fourth. So ∫ N_k dV is its flux through the triangles of
//! the other's skin in i, plus a quarter of i's volume if x_k lies in the other body. Over a triangle of area T the mean of g
//! is the mean of its corner values g_c, and that of 1/g³ is 1/(g_1 g_2 g_3). With the elementary symmetric polynomials e
//! of the corner values a_c of N_k,
//!
//! flux = -(x - x_k)·n T/12 (e_1² - e_2 + e_3 - e_1 e_2 + e_1 e_3)/((1 - a_1)(1 - a_2)(1 - a_3)),
//!
//! in which nothing cancels for slight overlaps. The volume of the part of i that is in the other body is found alike, with
//! (x - x_k) (1/3 - 1/(3 g³)) of one corner inside its own body and the whole volume of i if that corner lies in the other.

use super::clip::{Clip, Flux, Left, depths, is_outside, sunken};
use super::current::Current;
use super::polygon::PolygonSums;
use super::row::Lanes;
use femdem_mesh::Vector3;

/// How the skins of a pair of tetrahedra met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Met {
    /// They are apart, or neither has a skin in the other.
    Apart,
    /// They may overlap, but neither has a face on its skin.
    Inside,
    /// The skin of one is in the other.
    Skins,
    /// Round-off would decide: a skin lies in a face inside the other body, or at a node with pressure.
    Unclear,
}

/// The part of a triangle of one side's skin that lies in a tetrahedron of the other.
#[derive(Debug)]
pub(crate) struct Polygon {
    /// 0 if the triangle belongs to A.
    pub side: usize,
    /// Face of its tetrahedron.
    pub face: usize,
    /// Outwards.
    pub normal: Vector3,
    pub sums: PolygonSums,
    pub flux: Flux,
    /// What its edges lie on: see [`Clip::edges`].
    pub edges: u8,
}

/// What is done with the polygons of a pair of tetrahedra. (Not a closure, whose inlining cannot be forced.)
pub(crate) trait Gather {
    /// Corners with pressure of one side's tetrahedron, as bits, that lie in the other's.
    fn note(&mut self, side: usize, sunken: u8);

    fn add(&mut self, polygon: &Polygon);
}

/// Finds the polygons of two tetrahedra.
#[inline(always)]
pub(crate) fn meet<L: Lanes>(lanes: L, [a, b]: [&Current; 2], to: &mut impl Gather) -> Met {
    if !a.is_near(b) {
        return Met::Apart;
    }
    let depths = [depths(lanes, b, a), depths(lanes, a, b)];
    if is_outside(&depths[0]) || is_outside(&depths[1]) {
        return Met::Apart;
    }
    let mut clip = Clip::new(lanes);
    let mut met = if a.skin | b.skin == 0 {
        Met::Inside
    } else {
        Met::Apart
    };
    for side in 0..2 {
        let (own, host) = ([a, b][side], [b, a][side]);
        to.note(side, sunken(own, &depths[side]));
        for face in (0..4).filter(|k| own.skin >> k & 1 == 1) {
            match clip.load((own, face, &depths[side]), (host, &depths[1 - side])) {
                Left::Nothing => continue,
                Left::Polygon => {}
                Left::Unclear => return Met::Unclear,
            }
            // The shape function of the opposite corner is the depth over the height.
            let height = 1.0 / own.slopes[face].norm();
            let normal = own.normal(face);
            let of_host = depths[1 - side].map(|shares| shares.get()[face] * height);
            let Some((sums, flux)) = clip.integrate(&normal, host, of_host) else {
                return Met::Unclear;
            };
            to.add(&Polygon {
                side,
                face,
                normal,
                sums,
                flux,
                edges: clip.edges(),
            });
            met = Met::Skins;
        }
    }
    met
}
