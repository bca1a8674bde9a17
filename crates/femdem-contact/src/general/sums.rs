//! Sums over the pieces of a patch, for unit penalty, about the local origin.

use crate::foundation::FoundationSums;
use femdem_mesh::Vector3;
use std::ops::AddAssign;

/// Sums over pieces and over the polygons on which they touch the skins (or the contact surface).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sums {
    pub volume: f64,
    /// Integral of the energy density.
    pub energy: f64,
    /// Force and torque on B.
    pub force: Vector3,
    pub torque: Vector3,
    /// Integrals of phi, x phi, |x|^2 phi over the polygons.
    pub pressure: f64,
    pub pressure_moment: Vector3,
    pub pressure_second: f64,
    /// Of the polygons.
    pub stiffness: FoundationSums,
    /// Integral of n over A's polygons less that over B's.
    pub area: Vector3,
}

impl AddAssign<&Self> for Sums {
    fn add_assign(&mut self, other: &Self) {
        self.volume += other.volume;
        self.energy += other.energy;
        self.force += other.force;
        self.torque += other.torque;
        self.pressure += other.pressure;
        self.pressure_moment += other.pressure_moment;
        self.pressure_second += other.pressure_second;
        self.stiffness += other.stiffness;
        self.area += other.area;
    }
}

/// A polygon to be added: its outward normal, the field on it, its stiffness per area, and its sign (1 for
/// A's skin, -1 for B's).
pub(crate) struct Face<'a> {
    pub polygon: &'a [Vector3],
    pub normal: Vector3,
    pub gradient: Vector3,
    pub level: f64,
    pub weight: f64,
    pub side: f64,
}

impl Sums {
    /// Adds a plane convex polygon, triangle by triangle; on each, products of linear functions
    /// are integrated exactly.
    pub fn add_face(&mut self, face: &Face) {
        let Some((x, rest)) = face.polygon.split_first() else {
            return;
        };
        let field = |x: &Vector3| face.level + face.gradient.dot(x);
        let mut area = 0.0;
        let fx = field(x);
        for edge in rest.windows(2) {
            let (y, z) = (&edge[0], &edge[1]);
            let (fy, fz) = (field(y), field(z));
            let t = 0.5 * face.normal.dot(&(y - x).cross(&(z - x)));
            let (sum, total) = (x + y + z, fx + fy + fz);
            let squares = [x.norm_squared(), y.norm_squared(), z.norm_squared()];
            let square = squares.iter().sum::<f64>();
            let weighted = x * fx + y * fy + z * fz;
            let cubes = squares[0] * fx + squares[1] * fy + squares[2] * fz;
            area += t;
            if face.weight > 0.0 {
                self.stiffness.add_triangle(face.weight * t, &[*x, *y, *z]);
            }
            self.pressure += t / 3.0 * total;
            self.pressure_moment += (sum * total + weighted) * (t / 12.0);
            self.pressure_second += t / 60.0
                * ((sum.norm_squared() + square) * total + 2.0 * (sum.dot(&weighted) + cubes));
        }
        self.area += face.normal * (face.side * area);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square at height 1 with phi = x, against integrals done by hand.
    #[test]
    fn integrals_over_a_square() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let polygon = corners.map(|[x, y]| Vector3::new(x, y, 1.0));
        let mut s = Sums::default();
        s.add_face(&Face {
            polygon: &polygon,
            normal: Vector3::z(),
            gradient: Vector3::x(),
            level: 0.0,
            weight: 2.0,
            side: -1.0,
        });
        assert!((s.pressure - 0.5).abs() < 1e-15);
        let first = Vector3::new(1.0 / 3.0, 0.25, 0.5);
        assert!((s.pressure_moment - first).norm() < 1e-15);
        // x^3 + x y^2 + x.
        assert!((s.pressure_second - (0.25 + 1.0 / 6.0 + 0.5)).abs() < 1e-15);
        assert!((s.stiffness.total - 2.0).abs() < 1e-15);
        // 2 x^2, 2 x y, 2 x, 2 y and 2 over the square.
        let second = s.stiffness.second;
        assert!((second.trace() - 2.0 * (1.0 / 3.0 + 1.0 / 3.0 + 1.0)).abs() < 1e-14);
        assert!((second.m12 - 0.5).abs() < 1e-14 && (second.m13 - 1.0).abs() < 1e-14);
        assert!((s.area + Vector3::z()).norm() < 1e-15);
    }
}
