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
    /// Integral of |x|^2 p.
    pub spread: f64,
}

impl PolygonSums {
    /// Integrals of 1, x, x x^T, p, x p and |x|^2 p over a plane convex polygon with the field p, exactly.
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
            let second = sum * sum.transpose() + squares;
            sums.second += second * (area / 12.0);
            sums.pressure += area / 3.0 * total;
            sums.moment += (sum * total + x * fx + y * fy + z * fz) * (area / 12.0);
            let weighted = x * fx + y * fy + z * fz;
            let cubes = x.norm_squared() * fx + y.norm_squared() * fy + z.norm_squared() * fz;
            sums.spread +=
                area / 60.0 * (second.trace() * total + 2.0 * (sum.dot(&weighted) + cubes));
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square at height 1 with p = x, against integrals done by hand.
    #[test]
    fn integrals_over_a_square() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let polygon = corners.map(|[x, y]| Vector3::new(x, y, 1.0));
        let field = Posed {
            gradient: Vector3::x(),
            ..Posed::default()
        };
        let s = PolygonSums::new(&polygon, &Vector3::z(), &field);
        assert!((s.area - 1.0).abs() < 1e-15);
        assert!((s.first - Vector3::new(0.5, 0.5, 1.0)).norm() < 1e-15);
        assert!((s.second.trace() - (1.0 / 3.0 + 1.0 / 3.0 + 1.0)).abs() < 1e-14);
        assert!((s.second.m12 - 0.25).abs() < 1e-14 && (s.second.m13 - 0.5).abs() < 1e-14);
        assert!((s.pressure - 0.5).abs() < 1e-15);
        let moment = Vector3::new(1.0 / 3.0, 0.25, 0.5);
        assert!((s.moment - moment).norm() < 1e-15);
        // x^3 + x y^2 + x.
        assert!((s.spread - (0.25 + 1.0 / 6.0 + 0.5)).abs() < 1e-15);
    }
}
