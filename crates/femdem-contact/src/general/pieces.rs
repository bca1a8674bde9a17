//! Integrals over one piece, the common part of a tetrahedron of A and one of B.

use super::sums::{Face, Sums};
use crate::tets::piece::{Moments, Piece};
use crate::tets::pieces::{Faces, LABEL, for_skins, integral};
use crate::tets::posed::Posed;
use femdem_mesh::Vector3;

/// A piece's sums, its tetrahedra, and which of their faces bound it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Record {
    pub pair: [u32; 2],
    pub faces: Faces,
    pub sums: Sums,
}

/// The sums of the piece in the buffer, and its faces; `None` if it has no volume. `flush`: faces
/// of both tetrahedra may coincide.
pub(crate) fn integrate(
    a: &Posed,
    b: &Posed,
    flush: bool,
    piece: &mut Piece,
) -> Option<(Faces, Sums)> {
    let mut sums = Sums::default();
    let (faces, whole) = add_skins(a, b, flush, piece, &mut sums);
    if whole.volume.is_nan() || whole.volume <= 0.0 {
        return None;
    }
    sums.volume = whole.volume;
    let gradient = b.gradient - a.gradient;
    sums.force = gradient * whole.volume;
    sums.torque = whole.first.cross(&gradient);
    sums.energy = integral(a, &whole) + integral(b, &whole);
    Some((faces, sums))
}

/// Adds the polygons of the piece that lie on a skin; returns its faces and moments.
fn add_skins(
    a: &Posed,
    b: &Posed,
    flush: bool,
    piece: &mut Piece,
    sums: &mut Sums,
) -> (Faces, Moments) {
    for_skins([a, b], flush, piece, |label, polygon, counts| {
        add_skin(a, b, label, polygon, counts, sums);
    })
}

/// Adds a polygon of A's skin in B or of B's skin in A.
fn add_skin(a: &Posed, b: &Posed, label: u8, polygon: &[Vector3], counts: f64, sums: &mut Sums) {
    let (skin, field, side) = if label < LABEL[1] {
        (a, b, 1.0)
    } else {
        (b, a, -1.0)
    };
    let normal = skin.normals[usize::from(label % 4)];
    sums.add_face(&Face {
        polygon,
        normal,
        gradient: field.gradient,
        level: field.level,
        weight: normal.dot(&field.gradient).max(0.0),
        side: side * counts,
    });
}
