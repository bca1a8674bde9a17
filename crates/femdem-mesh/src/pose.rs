//! Poses given by callers.

use crate::{MeshError, Pose, Rotation};

/// Largest amount by which the length of a quaternion may differ from 1.
const QUATERNION_TOLERANCE: f64 = 1e-6;

/// Squared lengths within this of 1 are those of unit quaternions to rounding.
const EXACT: f64 = 1e-14;

/// The pose as a rigid motion to rounding: with its quaternion normalised, or unchanged, bit for bit, if it has
/// unit length already. None if the pose is not finite, or the length of its quaternion differs from 1 by more
/// than 1e-6.
///
/// A [`Pose`] that was read from a file or built without a check is not verified by nalgebra, and a quaternion
/// of another length distorts what it moves.
///
/// ```
/// use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
/// use femdem_mesh::{Pose, unit_pose};
///
/// let mut pose = Pose::translation(1.0, 2.0, 3.0);
/// assert_eq!(unit_pose(&pose), Some(pose));
/// pose.rotation = UnitQuaternion::new_unchecked(Quaternion::new(1.0 + 1e-7, 0.0, 0.0, 0.0));
/// assert_eq!(unit_pose(&pose), Some(Pose::translation(1.0, 2.0, 3.0)));
/// pose.rotation = UnitQuaternion::new_unchecked(Quaternion::new(2.0, 0.0, 0.0, 0.0));
/// assert_eq!(unit_pose(&pose), None);
/// ```
pub fn unit_pose(pose: &Pose) -> Option<Pose> {
    let square = pose.rotation.coords.norm_squared();
    // The condition is false for NaN.
    let near = (square.sqrt() - 1.0).abs() <= QUATERNION_TOLERANCE;
    if !near || pose.translation.vector.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if (square - 1.0).abs() <= EXACT {
        return Some(*pose);
    }
    let rotation = Rotation::new_normalize(*pose.rotation.quaternion());
    Some(Pose::from_parts(pose.translation, rotation))
}

/// As [`unit_pose`], with an error that says what is wrong.
///
/// # Errors
/// [`MeshError::OutOfRange`] if the translation is not finite, or the length of the quaternion is not 1 to 1e-6.
pub fn checked_pose(pose: &Pose) -> Result<Pose, MeshError> {
    let far = pose.translation.vector.norm();
    let (what, value, allowed) = if far.is_finite() {
        let length = pose.rotation.coords.norm();
        (
            "the length of the quaternion pose.rotation",
            length,
            "1 to 1e-6",
        )
    } else {
        ("the length of pose.translation", far, "finite, in m")
    };
    unit_pose(pose)
        .filter(|_| far.is_finite())
        .ok_or(MeshError::OutOfRange {
            what,
            value,
            allowed,
        })
}
