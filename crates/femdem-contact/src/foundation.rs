//! The normal stiffness of a contact patch as an elastic foundation: springs spread over the patch.

use crate::axes::complete;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Integrals of the normal stiffness per area over a patch, about some origin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct FoundationSums {
    /// N/m.
    pub total: f64,
    /// First moment, N.
    pub first: Vector3,
    /// Second moments, int x x^T dK, N m.
    pub second: Matrix3,
}

impl std::iter::Sum for FoundationSums {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        let mut sum = Self::default();
        parts.for_each(|part| sum += part);
        sum
    }
}

impl std::ops::Mul<f64> for FoundationSums {
    type Output = Self;

    fn mul(self, by: f64) -> Self {
        Self {
            total: self.total * by,
            first: self.first * by,
            second: self.second * by,
        }
    }
}

impl std::ops::AddAssign for FoundationSums {
    fn add_assign(&mut self, other: Self) {
        self.total += other.total;
        self.first += other.first;
        self.second += other.second;
    }
}

/// The elastic foundation of a patch, in the plane across its normal n.
///
/// Rocking of B against A by a small angle theta about an axis e in that plane, through the foundation's centre,
/// changes the depth at x by theta (e x (x - centre)).n, and is resisted by the moment J theta, with J the second
/// moment of the stiffness about e. In general J is different about every axis: a patch of length L and width w
/// has the moments K w^2/12 about its length and K L^2/12 about its width.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Foundation {
    /// Normal stiffness K, N/m: minus the trace of the Hessian of the contact energy, an upper bound of the
    /// stiffness in any direction.
    pub stiffness: f64,
    /// Centre of the stiffness, from the contact point (the centre of pressure), m.
    pub centre: Vector3,
    /// Direction in the plane in which the patch is longest, a unit vector. The other principal axis is n x axis.
    pub axis: Vector3,
    /// Rocking stiffness about `axis` and about n x `axis`, N m: the smallest and the largest.
    pub rocking: [f64; 2],
}

impl Foundation {
    /// From integrals about an origin, for a patch with unit normal `n` and its contact point at `point` from that
    /// origin, m.
    pub(crate) fn new(sums: &FoundationSums, n: &Vector3, point: &Vector3) -> Self {
        let [_, e1, e2] = complete(n);
        // Also for a body deep inside another, where the stiffness vanishes up to rounding.
        if sums.total.is_nan() || sums.total <= 0.0 {
            return Self {
                stiffness: 0.0,
                centre: Vector3::zeros(),
                axis: e1,
                rocking: [0.0; 2],
            };
        }
        let centre = sums.first / sums.total;
        let second = |a: &Vector3, b: &Vector3| {
            a.dot(&(sums.second * b)) - a.dot(&centre) * b.dot(&centre) * sums.total
        };
        let (xx, yy, xy) = (second(&e1, &e1), second(&e2, &e2), second(&e1, &e2));
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let radius = half.hypot(xy);
        // cos and sin of the angle from e1 to the direction of the largest second moment.
        let is_round = radius <= 1e-12 * mean.abs();
        let (c, s) = if is_round {
            (1.0, 0.0)
        } else if half >= 0.0 {
            let c = (0.5 * (1.0 + half / radius)).sqrt();
            (c, 0.5 * xy / (radius * c))
        } else {
            let s = (0.5 * (1.0 - half / radius)).sqrt();
            (0.5 * xy / (radius * s), s)
        };
        Self {
            stiffness: sums.total,
            centre: centre - point,
            axis: e1 * c + e2 * s,
            rocking: [mean - radius, mean + radius].map(|moment| moment.max(0.0)),
        }
    }

    /// The same with its vectors mapped by a rotation.
    pub(crate) fn rotated(&self, rotation: &Matrix3) -> Self {
        Self {
            centre: rotation * self.centre,
            axis: rotation * self.axis,
            ..*self
        }
    }

    /// A round patch: its centre from the contact point (m), any direction in its plane, its stiffness (N/m) and polar
    /// second moment (N m).
    pub(crate) fn round(centre: Vector3, axis: Vector3, stiffness: f64, polar: f64) -> Self {
        Self {
            stiffness,
            centre,
            axis,
            rocking: [0.5 * polar; 2],
        }
    }

    /// The principal axes in the plane across the patch's normal.
    pub fn axes(&self, normal: &Vector3) -> [Vector3; 2] {
        [self.axis, normal.cross(&self.axis)]
    }

    /// Polar second moment of the stiffness, N m: the torsional stiffness of springs in the plane that are as stiff
    /// as those across it.
    pub fn polar(&self) -> f64 {
        self.rocking[0] + self.rocking[1]
    }

    /// Ratio of the mean distance of the pressure from its centre to the root of the mean square. It is 0.943
    /// for a uniform disc, 0.937 for a square, and between 0.83 and 0.87 for a line; this is within 1 % for uniform
    /// ellipses and rectangles, and within 3 % for pressures that decrease to zero at the edge.
    pub(crate) fn mean_over_rms(&self) -> f64 {
        let [small, large] = self.rocking;
        let aspect = if large > 0.0 {
            (small / large).sqrt()
        } else {
            1.0
        };
        0.857 + 0.083 * aspect * (2.0 - aspect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rectangle of 4 x 1 with unit stiffness per area, turned in the plane, about a distant origin.
    #[test]
    fn a_rectangle_has_its_moments_about_its_own_axes() {
        let n = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let [_, e1, e2] = complete(&n);
        for angle in [0.0_f64, 0.3, 0.9, 1.6, 2.8] {
            let u = e1 * angle.cos() + e2 * angle.sin();
            let v = n.cross(&u);
            let centre = Vector3::new(0.3, -0.7, 0.2);
            let sums = FoundationSums {
                total: 4.0,
                first: centre * 4.0,
                second: u * u.transpose() * (16.0 / 3.0)
                    + v * v.transpose() * (1.0 / 3.0)
                    + centre * centre.transpose() * 4.0,
            };
            let found = Foundation::new(&sums, &n, &(centre + u * 0.1));
            assert!((found.rocking[0] - 1.0 / 3.0).abs() < 1e-13);
            assert!((found.rocking[1] - 16.0 / 3.0).abs() < 1e-13);
            assert!((found.axis.dot(&u).abs() - 1.0).abs() < 1e-13);
            assert!((found.centre + u * 0.1).norm() < 1e-13);
            assert!((found.mean_over_rms() - 0.893).abs() < 2e-3);
        }
    }
}
