//! The common part of a tetrahedron of A and one of B, and its faces.

use super::piece::{Moments, Piece};
use super::posed::Posed;
use femdem_mesh::Vector3;

/// Labels of the faces: 0 to 3 of A's tetrahedron, 4 to 7 of B's.
pub(crate) const LABEL: [u8; 2] = [0, 4];

/// Planes whose normals have a larger cosine may coincide.
const SAME_NORMAL: f64 = 1.0 - 1e-12;

/// Distance within which planes coincide, over the size of the tetrahedra.
pub(crate) const FLAT: f64 = 1e-12;

/// Which faces of its tetrahedra bound a piece.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Faces {
    /// Bits by label.
    pub bits: u8,
    /// Whether a face of A's tetrahedron coincides with one of B's.
    pub coincide: bool,
}

/// Cuts the tetrahedra's common part into `piece`; `None` if there is none, otherwise whether faces
/// of both may coincide.
pub(crate) fn intersect(a: &Posed, b: &Posed, piece: &mut Piece) -> Option<bool> {
    if !a.is_near(b) {
        return None;
    }
    let (of_a, of_b) = (a.faces_across(b)?, b.faces_across(a)?);
    let flush = of_a.flush != 0 && of_b.flush != 0;
    // The smaller one is cut, so that round-off scales with its size.
    let (small, large, faces, labels) = if a.size < b.size {
        (a, b, of_b, LABEL)
    } else {
        (b, a, of_a, [LABEL[1], LABEL[0]])
    };
    piece.load(&small.corners, labels[0]);
    let mut left = faces.cut;
    while left != 0 {
        // The plane that removes most comes first, so that little is left for the others to cut.
        let mut next = left.trailing_zeros() as usize;
        for k in next + 1..4 {
            if left >> k & 1 == 1 && faces.most[k] < faces.most[next] {
                next = k;
            }
        }
        left &= !(1 << next);
        let depth = |x: &Vector3| large.depth(next, x);
        if !piece.cut(labels[1] + next as u8, depth) {
            return None;
        }
    }
    Some(flush)
}

/// A lower bound of the distance of two tetrahedra without a common part, m.
pub(crate) fn distance(a: &Posed, b: &Posed) -> f64 {
    let gap = a.gap(b, f64::INFINITY);
    if gap > 0.0 {
        gap
    } else {
        a.edge_gap(b).max(0.0)
    }
}

/// Calls `skin` with the label, the corners and the weight of every polygon of the piece that lies
/// on a skin; returns the piece's faces and moments.
///
/// Where a face of A's tetrahedron coincides with one of B's, the piece's face has the label of one of them
/// by chance, and a flat piece behind it may have the other. Flat pieces are skipped, and the polygons of the
/// others count for both faces.
pub(crate) fn for_skins(
    [a, b]: [&Posed; 2],
    flush: bool,
    piece: &mut Piece,
    mut skin: impl FnMut(u8, &[Vector3], f64),
) -> (Faces, Moments) {
    let skins = a.skin | b.skin << 4;
    let least = FLAT * a.size.max(b.size);
    let plane = |label: u8| {
        let tet = if label < LABEL[1] { a } else { b };
        (tet, usize::from(label % 4))
    };
    let twins = if flush { twins(a, b) } else { [None; 8] };
    let mut thick = 0_u8;
    for label in (0..8).filter(|l| skins >> l & 1 == 1) {
        let (tet, k) = plane(label);
        let deep = piece.vertices().iter().any(|x| tet.depth(k, x) > least);
        thick |= u8::from(deep) << label;
    }
    let counted = skins & thick;
    let mut also = 0_u8;
    let (mut faces, mut bits) = (Faces::default(), 0_u8);
    // Without twins only the faces on skins are needed.
    let wanted = if flush { u8::MAX } else { counted };
    let whole = piece.moments_and_faces(wanted, &mut bits, |label, polygon| {
        let twin = twins[usize::from(label)].filter(|&twin| {
            let (tet, k) = plane(twin);
            polygon.iter().all(|x| tet.depth(k, x) <= least)
        });
        let own = counted >> label & 1 == 1;
        let Some(twin) = twin else {
            if own {
                skin(label, polygon, 1.0);
            }
            return;
        };
        faces.coincide = true;
        also |= 1 << twin;
        let others = counted >> twin & 1 == 1;
        // Of two skins that coincide, one takes all of the area if the bodies move one way and the other if
        // they move the other way. The mean of A's area less B's is zero.
        let weight = if own && others { 0.0 } else { 1.0 };
        if own {
            skin(label, polygon, weight);
        }
        if others {
            skin(twin, polygon, weight);
        }
    });
    faces.bits = bits | also;
    (faces, whole)
}

/// By label, the face of the other tetrahedron with the same outward normal.
fn twins(a: &Posed, b: &Posed) -> [Option<u8>; 8] {
    let mut twins = [None; 8];
    for k in 0..4 {
        for l in 0..4 {
            if a.normals[k].dot(&b.normals[l]) > SAME_NORMAL {
                twins[k] = Some(4 + l as u8);
                twins[4 + l] = Some(k as u8);
            }
        }
    }
    twins
}

/// Integral of a tetrahedron's field over a part with the given moments.
pub(crate) fn integral(tet: &Posed, part: &Moments) -> f64 {
    tet.level * part.volume + tet.gradient.dot(&part.first)
}
