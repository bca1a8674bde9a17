//! Axis-aligned boxes around bodies.

use femdem_mesh::Point3;

/// Closed axis-aligned box (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) min: Point3,
    pub(crate) max: Point3,
}

impl Bounds {
    /// Smallest box around `points`; inverted (`min > max`) when there are none.
    pub(crate) fn around(points: impl IntoIterator<Item = Point3>) -> Self {
        let mut bounds = Self {
            min: Point3::from([f64::INFINITY; 3]),
            max: Point3::from([f64::NEG_INFINITY; 3]),
        };
        for point in points {
            bounds.min = bounds.min.inf(&point);
            bounds.max = bounds.max.sup(&point);
        }
        bounds
    }

    /// Whether the two boxes have a point in common.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Whether `other` lies wholly inside this box.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.min[k] && other.max[k] <= self.max[k])
    }
}
