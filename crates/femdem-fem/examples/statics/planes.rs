//! Planes across the axes.

use femdem_fem::Selection;
use femdem_mesh::Vector3;

/// The nodes at a place on an axis, m.
pub fn plane(axis: usize, offset: f64) -> Selection {
    Selection::Plane {
        normal: Vector3::from_fn(|k, _| if k == axis { 1.0 } else { 0.0 }),
        offset,
        tolerance: 1e-9,
    }
}
