//! Share of a cube on one side of a plane.

use femdem_mesh::Vector3;

/// Share of the cube `|x|, |y|, |z| <= 1` in which `slope · x <= offset`.
///
/// The cases of Scardovelli and Zaleski (J. Comput. Phys. 164, 228, 2000): slopes made positive and scaled to
/// the sum 1 in ascending order, the offset taken from the lowest corner, the larger half by symmetry.
pub(super) fn share_below(slope: &Vector3, offset: f64) -> f64 {
    let total = slope.abs().sum();
    if total <= 0.0 || total.is_nan() {
        return if offset < 0.0 { 0.0 } else { 1.0 };
    }
    let mut m: [f64; 3] = slope.abs().into();
    m.sort_by(f64::total_cmp);
    // Differences that cancel are divided by the smallest slopes; slopes below this have less effect than
    // round-off.
    let [m1, m2, m3] = m.map(|x| (x / total).max(1e-6));
    let height = (0.5 * (offset / total + 1.0)).clamp(0.0, 1.0);
    let low = height.min(1.0 - height);
    let share = small_share([m1, m2, m3], low).clamp(0.0, 0.5);
    if height <= 0.5 { share } else { 1.0 - share }
}

/// For a height up to 1/2.
fn small_share([m1, m2, m3]: [f64; 3], height: f64) -> f64 {
    let product = 6.0 * m1 * m2 * m3;
    let beyond = |m: f64| m * m * (m - 3.0 * height);
    if height < m1 {
        height.powi(3) / product
    } else if height < m2 {
        height * (height - m1) / (2.0 * m2 * m3) + m1 * m1 / (6.0 * m2 * m3)
    } else if height < m3.min(m1 + m2) {
        (height * height * (3.0 * (m1 + m2) - height) + beyond(m1) + beyond(m2)) / product
    } else if m3 < m1 + m2 {
        (height * height * (3.0 - 2.0 * height) + beyond(m1) + beyond(m2) + beyond(m3)) / product
    } else {
        (2.0 * height - m1 - m2) / (2.0 * m3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::Bounds;
    use crate::clip::Clipper;
    use femdem_mesh::Point3;
    use proptest::prelude::*;

    fn by_clipping(slope: &Vector3, offset: f64) -> f64 {
        let mut clipper = Clipper::default();
        clipper.load_box(&Bounds {
            min: Point3::from([-1.0; 3]),
            max: Point3::from([1.0; 3]),
        });
        clipper.clip(slope, offset);
        clipper.volume() / 8.0
    }

    proptest! {
        #[test]
        fn formula_agrees_with_clipping(slope in prop::array::uniform3(-1.0..1.0_f64), offset in -3.0..3.0_f64) {
            let slope = Vector3::from(slope);
            let (found, expected) = (share_below(&slope, offset), by_clipping(&slope, offset));
            prop_assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
    }

    #[test]
    fn planes_along_axes_and_none() {
        for (slope, offset, expected) in [
            ([2.0, 0.0, 0.0], 0.0, 0.5),
            ([0.0, -2.0, 0.0], 1.0, 0.75),
            ([1.0, 1.0, 0.0], -1.0, 0.125),
            ([1.0, 1.0, 1.0], -2.0, 1.0 / 48.0),
            ([0.0, 0.0, 0.0], 0.1, 1.0),
            ([0.0, 0.0, 1.0], 7.0, 1.0),
        ] {
            let found = share_below(&Vector3::from(slope), offset);
            assert!(
                (found - expected).abs() < 3e-6,
                "{slope:?} {offset}: {found}"
            );
        }
    }
}
