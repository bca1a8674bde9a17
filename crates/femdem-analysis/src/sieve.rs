//! The sieve curve of a pack.

use serde::{Deserialize, Serialize};

use crate::table::{Cell, Table};

/// A size, and the part of the mass in bodies of this size and smaller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SievePoint {
    /// Size \[m\].
    pub size: f64,
    /// Part of the mass, 0 to 1.
    pub passing: f64,
}

/// The sizes of bodies as a sieve curve by mass: a point for each size, rising.
///
/// What counts as the size is up to the caller; in this project it is the circumscribed diameter, which for bodies that are
/// no balls is larger than the square mesh that they fall through.
///
/// ```
/// use femdem_analysis::SieveCurve;
///
/// let bodies = [(0.02, 3.0), (0.01, 1.0), (0.02, 4.0)];
/// let curve = SieveCurve::new(bodies);
/// assert_eq!(curve.points.len(), 2);
/// assert_eq!(curve.points[0].passing, 0.125);
/// assert_eq!(curve.size_passing(0.5), Some(0.02));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SieveCurve {
    /// The points, by rising size.
    pub points: Vec<SievePoint>,
}

impl SieveCurve {
    /// The curve of bodies given by size \[m\] and mass \[kg\], or any other weight. Sizes that differ by less than a
    /// billionth are one.
    #[must_use]
    pub fn new(bodies: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut bodies: Vec<(f64, f64)> = bodies.into_iter().collect();
        bodies.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = bodies.iter().map(|(_, mass)| mass).sum();
        let mut points: Vec<SievePoint> = Vec::new();
        let mut sum = 0.0;
        for (size, mass) in bodies {
            sum += mass;
            let passing = sum / total;
            match points.last_mut() {
                Some(last) if size <= last.size * (1.0 + 1e-9) => last.passing = passing,
                _ => points.push(SievePoint { size, passing }),
            }
        }
        if let Some(last) = points.last_mut() {
            last.passing = 1.0;
        }
        Self { points }
    }

    /// The smallest size that a part of the mass does not exceed \[m\], such as d50 for 0.5; `None` without bodies.
    #[must_use]
    pub fn size_passing(&self, part: f64) -> Option<f64> {
        let reached = self.points.iter().find(|point| point.passing >= part);
        reached.map(|point| point.size)
    }
}

impl Table for SieveCurve {
    fn columns(&self) -> &'static [&'static str] {
        &["size_m", "passing"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let points = self.points.iter();
        Box::new(points.map(|point| vec![point.size.into(), point.passing.into()]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_rises_to_one_whatever_the_order_of_the_bodies() {
        let sizes = [0.03, 0.01, 0.02, 0.01, 0.03_f64];
        let curve = SieveCurve::new(sizes.map(|size| (size, size.powi(3))));
        assert_eq!(curve.to_csv().lines().next(), Some("size_m,passing"),);
        let passing: Vec<f64> = curve.points.iter().map(|p| p.passing).collect();
        // Masses 1, 1, 8, 27 and 27 of 64.
        assert_eq!(passing.len(), 3);
        for (found, wanted) in passing.iter().zip([2.0 / 64.0, 10.0 / 64.0, 1.0]) {
            assert!((found - wanted).abs() < 1e-12, "{passing:?}");
        }
        assert_eq!(curve.size_passing(0.1), Some(0.02));
        assert_eq!(SieveCurve::new([]).size_passing(0.5), None);
    }
}
