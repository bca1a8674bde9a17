//! Integrals over one piece, the common part of a tetrahedron of A and one of B.

use super::patch::Record;
use super::sums::Sums;
use crate::tets::piece::Piece;
use crate::tets::pieces::{LABEL, for_skins, integral};
use crate::tets::polygon::PolygonSums;
use crate::tets::posed::Posed;

/// The record of the piece in the buffer, but its pair; `None` if it has no volume. `flush`: faces of both tetrahedra may
/// coincide.
pub(crate) fn integrate(a: &Posed, b: &Posed, flush: bool, piece: &mut Piece) -> Option<Record> {
    let mut sums = Sums::default();
    let (faces, whole) = for_skins([a, b], flush, piece, |label, polygon, counts| {
        let side = usize::from(label >= LABEL[1]);
        let (skin, field) = ([a, b][side], [b, a][side]);
        let normal = skin.normals[usize::from(label % 4)];
        let integrals = PolygonSums::new(polygon, &normal, field);
        sums.add_polygon(side, &integrals, &normal, &field.gradient, counts);
    });
    if whole.volume.is_nan() || whole.volume <= 0.0 {
        return None;
    }
    sums.volume = whole.volume;
    let gradient = b.gradient - a.gradient;
    sums.force = gradient * whole.volume;
    sums.torque = whole.first.cross(&gradient);
    sums.energy = integral(a, &whole) + integral(b, &whole);
    let skins = a.skin | b.skin << 4;
    Some(Record {
        has_skin: skins & faces.bits != 0,
        faces,
        sums,
        ..Record::default()
    })
}
