//! Boxes in the axes of two bodies.

use femdem_mesh::bvh::Aabb;
use femdem_mesh::{Matrix3, Vector3};

/// Test whether a box in A's axes and one in B's axes come within a margin, along the axes of both.
pub(crate) struct BoxTest {
    rotation: Matrix3,
    inverse: Matrix3,
    /// Absolute values of the rotation and its transpose.
    spread: Matrix3,
    back: Matrix3,
    offset: Vector3,
    margin: f64,
}

impl BoxTest {
    pub fn new(rotation: &Matrix3, offset: &Vector3, margin: f64) -> Self {
        let inverse = rotation.transpose();
        Self {
            rotation: *rotation,
            inverse,
            spread: rotation.abs(),
            back: inverse.abs(),
            offset: *offset,
            margin,
        }
    }

    #[inline]
    pub fn meet(&self, a: &Aabb, b: &Aabb) -> bool {
        let (half_a, half_b) = ((a.high - a.low) * 0.5, (b.high - b.low) * 0.5);
        let between = self.rotation * b.center().coords + self.offset - a.center().coords;
        let reach = half_a + self.spread * half_b;
        if (0..3).any(|k| between[k].abs() > reach[k] + self.margin) {
            return false;
        }
        let between = self.inverse * between;
        let reach = half_b + self.back * half_a;
        (0..3).all(|k| between[k].abs() <= reach[k] + self.margin)
    }
}

/// Largest gap between a box and a rotated box along the first one's axes, m.
pub(crate) fn gap_along_axes(a: &Aabb, b: &Aabb, rotation: &Matrix3, offset: &Vector3) -> f64 {
    let half = rotation.abs() * ((b.high - b.low) * 0.5);
    let centre = rotation * b.center().coords + offset;
    (0..3)
        .map(|k| (centre[k] - half[k] - a.high[k]).max(a.low[k] - centre[k] - half[k]))
        .fold(f64::NEG_INFINITY, f64::max)
}
