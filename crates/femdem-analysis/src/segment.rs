//! The point of a segment nearest to another point.

use femdem_mesh::{Point3, Vector3};

/// The point nearest to `point` of the segment from `start` to `start + along`.
pub(crate) fn on_segment(start: &Point3, along: &Vector3, point: &Point3) -> Point3 {
    let square = along.norm_squared();
    if square <= 0.0 {
        return *start;
    }
    start + along * ((point - start).dot(along) / square).clamp(0.0, 1.0)
}
