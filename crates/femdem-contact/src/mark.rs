//! Bound of the relative motion of two bodies since a recorded pose.
//!
//! The sum of their travels is a bound that costs hardly anything, but bodies that fall or slide together
//! travel far while their relative pose stays the same.

use femdem_mesh::nalgebra::{Quaternion, Rotation3};
use femdem_mesh::{Matrix3, Rotation, Vector3};
use serde::{Deserialize, Serialize};

/// Bound of the rounding error of single precision, relative to the size of the stored numbers.
const SINGLE: f64 = 8.0 * f32::EPSILON as f64;

/// Recorded pose of B in A's axes. Every pair stores one, hence the single precision.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mark {
    /// Unit quaternion: i, j, k, w.
    rotation: [f32; 4],
    /// m.
    offset: [f32; 3],
}

impl Mark {
    pub fn new(rotation: &Matrix3, offset: &Vector3) -> Self {
        let turned = Rotation::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation));
        Self {
            rotation: turned.coords.map(|x| x as f32).into(),
            offset: offset.map(|x| x as f32).into(),
        }
    }

    /// Upper bound, m, of how far any point of B within `radius` of its origin has moved in A's axes, and any
    /// such point of A in B's axes. Not finite outside the range of single precision.
    pub fn moved(&self, rotation: &Matrix3, offset: &Vector3, radius: f64) -> f64 {
        let turned = Quaternion::from(self.rotation.map(f64::from));
        let was = Rotation::new_unchecked(turned).to_rotation_matrix();
        // Spectral norm of the difference of two rotations.
        let turn = (rotation - was.matrix()).norm() * std::f64::consts::FRAC_1_SQRT_2;
        let shift = (offset - Vector3::from(self.offset.map(f64::from))).norm();
        let lost = SINGLE * (offset.norm() + radius) + f64::from(f32::MIN_POSITIVE);
        shift + turn * radius + lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vector3> {
        prop::array::uniform3(-size..size).prop_map(Vector3::from)
    }

    fn matrix(turning: &Vector3) -> Matrix3 {
        Rotation::from_scaled_axis(*turning)
            .to_rotation_matrix()
            .into_inner()
    }

    proptest! {
        /// The bound holds for every point of B, and for every point of A that B reaches. It is never more
        /// than the shift and the rotation of the farthest point together.
        #[test]
        fn every_point_has_moved_less(
            first in vector(3.0),
            turning in vector(0.1),
            offset in vector(2.0),
            shift in vector(0.1),
            point in vector(0.5),
        ) {
            let radius = 0.9;
            let (was, now) = (matrix(&first), matrix(&turning) * matrix(&first));
            let moved = Mark::new(&was, &offset).moved(&now, &(offset + shift), radius);
            let of_b = (now - was) * point + shift;
            prop_assert!(of_b.norm() <= moved, "{} {moved}", of_b.norm());
            // The point of A that coincides with that point of B now.
            let of_a = point - was.tr_mul(&(now * point + shift));
            prop_assert!(of_a.norm() <= moved, "{} {moved}", of_a.norm());
            prop_assert!(moved <= shift.norm() + turning.norm() * radius + 1e-5, "{moved}");
        }
    }

    #[test]
    fn what_is_too_large_for_single_precision_is_not_known() {
        let offset = Vector3::new(1e299, 0.0, 0.0);
        let mark = Mark::new(&Matrix3::identity(), &offset);
        let moved = mark.moved(&Matrix3::identity(), &offset, 1e298);
        assert!(!moved.is_finite(), "{moved}");
    }
}
