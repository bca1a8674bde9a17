//! Planes of a field, seen from the other body.

use super::clip::Line;
use crate::shape::{ConvexShape, PlaneFrame};
use femdem_mesh::{Matrix3, Vector3};

/// A plane of the field body in the skin body's axes: phi = level - gradient.x.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FieldPlane {
    /// Along the outward normal.
    pub gradient: Vector3,
    pub level: f64,
}

impl FieldPlane {
    /// phi on the plane of a polygon.
    #[inline]
    pub fn on(&self, frame: &PlaneFrame) -> Line {
        Line {
            a: self.gradient.dot(&frame.e1),
            b: self.gradient.dot(&frame.e2),
            c: self.level - self.gradient.dot(&frame.origin),
        }
    }

    /// Stiffness weight for a polygon with unit normal `n`: the rate at which phi grows as
    /// the polygon moves along -n, if it does.
    #[inline]
    pub fn weight(&self, n: &Vector3) -> f64 {
        (-n.dot(&self.gradient)).max(0.0)
    }
}

/// Planes of the field body expressed in the skin body's axes. The field body is posed
/// by `rotation`, `offset` in those axes.
#[inline]
pub(crate) fn pose_planes(
    field: &ConvexShape,
    list: &[u16],
    rotation: &Matrix3,
    offset: &Vector3,
    out: &mut Vec<FieldPlane>,
) {
    out.clear();
    out.extend(list.iter().map(|&k| {
        let gradient = rotation * field.planes[usize::from(k)].gauge;
        FieldPlane {
            gradient,
            level: 1.0 + gradient.dot(offset),
        }
    }));
}
