//! Mean stresses of bodies: what their tables share.

use femdem_mesh::Matrix3;

/// Places of the components xx, yy, zz, yz, zx, xy.
pub(crate) const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1)];

pub(crate) fn symmetric(m: &Matrix3) -> Matrix3 {
    (m + m.transpose()) * 0.5
}

/// Norm of the difference over that of `stress`; 0 without stress.
pub(crate) fn difference(stress: &Matrix3, other: &Matrix3) -> f64 {
    let size = stress.norm();
    if size > 0.0 {
        (stress - other).norm() / size
    } else {
        0.0
    }
}

/// Median and largest of some numbers; 0 without any.
pub(crate) fn median_and_largest(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut all: Vec<f64> = numbers.collect();
    all.sort_by(f64::total_cmp);
    let at = |i: usize| all.get(i).copied().unwrap_or(0.0);
    [at(all.len() / 2), at(all.len().saturating_sub(1))]
}
