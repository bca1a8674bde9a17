//! The coarse-graining function, and its integral along a line.

use std::f64::consts::PI;

use femdem_mesh::{Point3, Vector3};

/// Lucy's function in three dimensions (L. B. Lucy, Astron. J. 82, 1013, 1977):
///
/// φ(r) = 105/(16 π c³) (1 − 6 q² + 8 q³ − 3 q⁴) with q = r/c below 1, and 0 beyond. Its integral over space is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lucy {
    /// Radius c of the support (m).
    pub(super) radius: f64,
    scale: f64,
}

impl Lucy {
    pub(super) fn new(radius: f64) -> Self {
        Self {
            radius,
            scale: 105.0 / (16.0 * PI * radius.powi(3)),
        }
    }

    /// Value (1/m³) at a squared distance (m²).
    pub(super) fn at(&self, square: f64) -> f64 {
        let q2 = square / (self.radius * self.radius);
        if q2 < 1.0 {
            self.scale * (1.0 - 6.0 * q2 + 8.0 * q2 * q2.sqrt() - 3.0 * q2 * q2)
        } else {
            0.0
        }
    }

    /// Mean over a segment of the value of the function about `at` (1/m³): ∫₀¹ φ(at − start − s along) ds.
    pub(super) fn along(&self, start: &Point3, along: &Vector3, at: &Point3) -> f64 {
        let length = along.norm();
        // A segment without length has the value of its point.
        if length <= 1e-9 * self.radius {
            return self.at((at - start).norm_squared());
        }
        let offset = (start - at) / self.radius;
        let direction = along / length;
        let foot = offset.dot(&direction);
        let gap2 = (offset - direction * foot).norm_squared();
        if gap2 >= 1.0 {
            return 0.0;
        }
        let reach = (1.0 - gap2).sqrt();
        let low = foot.max(-reach);
        let high = (foot + length / self.radius).min(reach);
        if low >= high {
            return 0.0;
        }
        let part = antiderivative(gap2, high) - antiderivative(gap2, low);
        // Round-off must not make it negative.
        (self.scale * part * self.radius / length).max(0.0)
    }
}

/// Antiderivative over t of 1 − 6 q² + 8 q³ − 3 q⁴ with q² = gap² + t².
fn antiderivative(gap2: f64, t: f64) -> f64 {
    let t2 = t * t;
    let q = (gap2 + t2).sqrt();
    let square = t * (gap2 + t2 / 3.0);
    let fourth = t * (gap2 * gap2 + t2 * (2.0 / 3.0 * gap2 + 0.2 * t2));
    // Of the last part nothing is left near the line.
    let log = if gap2 > 1e-20 {
        0.375 * gap2 * gap2 * (t / gap2.sqrt()).asinh()
    } else {
        0.0
    };
    let third = t * q * (0.25 * q * q + 0.375 * gap2) + log;
    t - 6.0 * square + 8.0 * third - 3.0 * fourth
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn its_integral_over_space_is_one() {
        let lucy = Lucy::new(1.7);
        let n = 4000;
        let shell = |k: i32| {
            let r = 1.7 * (f64::from(k) + 0.5) / f64::from(n);
            4.0 * PI * r * r * lucy.at(r * r) * 1.7 / f64::from(n)
        };
        let sum: f64 = (0..n).map(shell).sum();
        assert!((sum - 1.0).abs() < 1e-6, "{sum}");
        assert!(lucy.at(1.7 * 1.7) == 0.0 && lucy.at(4.0) == 0.0);
    }

    proptest! {
        /// Against the mean over many points of the segment; segments through the point itself included.
        #[test]
        fn means_over_segments_are_exact(
            start in [-1.5..1.5_f64, -1.5..1.5, -1.5..1.5],
            along in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
            through in any::<bool>(),
        ) {
            let (lucy, along) = (Lucy::new(1.2), Vector3::from(along));
            let start = if through { Point3::from(along * -0.3) } else { Point3::from(start) };
            let n = 20_000;
            let value = |k: i32| {
                let place = start + along * ((f64::from(k) + 0.5) / f64::from(n));
                lucy.at(place.coords.norm_squared())
            };
            let mean = (0..n).map(value).sum::<f64>() / f64::from(n);
            let found = lucy.along(&start, &along, &Point3::origin());
            prop_assert!((found - mean).abs() < 1e-6, "{} for {}", found, mean);
        }
    }
}
