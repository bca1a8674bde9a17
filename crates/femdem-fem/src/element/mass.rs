//! Lumped masses.

use super::Element;

/// Part of an element's mass at each of its nodes. Ten nodes: HRZ lumping (E. Hinton, T. Rock and O.
/// C. Zienkiewicz, Earthquake Engng Struct. Dyn. 4 (1976) 245-249): the diagonal of the consistent
/// matrix, scaled to the element's mass. The corners' row sums would be negative.
pub(crate) fn lumped(element: Element) -> &'static [f64] {
    const CORNER: f64 = 1.0 / 36.0;
    const MIDDLE: f64 = 4.0 / 27.0;
    if element.is_quadratic() {
        &[
            CORNER, CORNER, CORNER, CORNER, MIDDLE, MIDDLE, MIDDLE, MIDDLE, MIDDLE, MIDDLE,
        ]
    } else {
        &[0.25; 4]
    }
}
