//! Sides of a body: parts of its skin whose normals are nearly parallel.

use femdem_mesh::Vector3;

/// At most about this many parts of the skin are tried as centres of a side.
const SIDES: usize = 256;

/// Parts of the skin whose normals have a larger cosine (18 degrees) count as one side: a contact
/// on a finely faceted skin spans many facets.
pub(crate) const ONE_SIDE: f64 = 0.95;

/// The largest sum over a side, from the unit normals of the parts of the skin and their stiffnesses.
pub(crate) fn stiffest(parts: &[(Vector3, f64)]) -> f64 {
    let stride = parts.len().div_ceil(SIDES).max(1);
    let about = |normal: &Vector3| {
        let beside = parts.iter().filter(|(n, _)| n.dot(normal) > ONE_SIDE);
        beside.map(|part| part.1).sum::<f64>()
    };
    let sides = parts.iter().step_by(stride).map(|part| about(&part.0));
    sides.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A side of many parts is as stiff as one of a single part, and opposite sides do not add up.
    #[test]
    fn parts_of_a_side_add_up() {
        let tilted = |angle: f64| Vector3::new(angle.sin(), 0.0, angle.cos());
        let whole = [(Vector3::z(), 2.0), (-Vector3::z(), 1.0)];
        assert_eq!(stiffest(&whole), 2.0);
        let parts = [0.0, 0.1, -0.1, 1.0].map(|angle| (tilted(angle), 0.5));
        assert_eq!(stiffest(&parts), 1.5);
        assert_eq!(stiffest(&[]), 0.0);
    }
}
