//! Integrals over plane polygons.

use super::posed::Posed;
use femdem_mesh::{Matrix3, Vector3};

/// Integrals over a plane polygon.
#[derive(Debug, Default)]
pub(crate) struct PolygonSums {
    pub area: f64,
    pub first: Vector3,
    pub second: Matrix3,
    pub pressure: f64,
    pub moment: Vector3,
}

impl PolygonSums {
    /// Integrals of 1, x, x x^T, p and x p over a plane convex polygon with the field p, exactly.
    pub fn new(polygon: &[Vector3], normal: &Vector3, field: &Posed) -> Self {
        let mut sums = Self::default();
        let Some((x, rest)) = polygon.split_first() else {
            return sums;
        };
        let value = |x: &Vector3| field.level + field.gradient.dot(x);
        let fx = value(x);
        for edge in rest.windows(2) {
            let (y, z) = (&edge[0], &edge[1]);
            let (fy, fz) = (value(y), value(z));
            let area = 0.5 * normal.dot(&(y - x).cross(&(z - x)));
            let (sum, total) = (x + y + z, fx + fy + fz);
            sums.area += area;
            sums.first += sum * (area / 3.0);
            let squares = x * x.transpose() + y * y.transpose() + z * z.transpose();
            sums.second += (sum * sum.transpose() + squares) * (area / 12.0);
            sums.pressure += area / 3.0 * total;
            sums.moment += (sum * total + x * fx + y * fy + z * fz) * (area / 12.0);
        }
        sums
    }
}
