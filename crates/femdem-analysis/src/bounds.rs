//! Axis-aligned boxes around bodies.

use femdem_mesh::{Point3, Vector3};

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

    /// Whether the two boxes have a common point.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// Whether `other` lies wholly inside this box.
    pub(crate) fn holds(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.min[k] && other.max[k] <= self.max[k])
    }

    /// The part of this box inside `other`; inverted where there is none.
    pub(crate) fn clamped_to(&self, other: &Self) -> Self {
        Self {
            min: self.min.sup(&other.min),
            max: self.max.inf(&other.max),
        }
    }

    /// Centre and half the extents.
    pub(crate) fn middle_and_half(&self) -> (Point3, Vector3) {
        let half = (self.max - self.min) * 0.5;
        (self.min + half, half)
    }

    /// The points between `low` and `high` along axis `k`, all points along the others.
    pub(crate) fn slab(k: usize, low: f64, high: f64) -> Self {
        let mut slab = Self {
            min: Point3::from([f64::NEG_INFINITY; 3]),
            max: Point3::from([f64::INFINITY; 3]),
        };
        (slab.min[k], slab.max[k]) = (low, high);
        slab
    }
}
