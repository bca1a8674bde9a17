//! Second and fourth moments of axes, and where a Legendre polynomial averaged over them is largest.

use femdem_mesh::{Matrix3, Vector3};

/// Exponents of x, y, z in the monomials of degree 4, and how often each is in the expansion of `(u · n)^4`.
const MONOMIALS: [([i32; 3], f64); 15] = [
    ([4, 0, 0], 1.0),
    ([0, 4, 0], 1.0),
    ([0, 0, 4], 1.0),
    ([3, 1, 0], 4.0),
    ([3, 0, 1], 4.0),
    ([1, 3, 0], 4.0),
    ([0, 3, 1], 4.0),
    ([1, 0, 3], 4.0),
    ([0, 1, 3], 4.0),
    ([2, 2, 0], 6.0),
    ([2, 0, 2], 6.0),
    ([0, 2, 2], 6.0),
    ([2, 1, 1], 12.0),
    ([1, 2, 1], 12.0),
    ([1, 1, 2], 12.0),
];

fn monomials(v: &Vector3) -> [f64; 15] {
    let powers = |x: f64| [1.0, x, x * x, x * x * x, x * x * x * x];
    let [x, y, z] = [v.x, v.y, v.z].map(powers);
    MONOMIALS.map(|(e, _)| x[e[0] as usize] * y[e[1] as usize] * z[e[2] as usize])
}

/// Sums over axes.
#[derive(Clone, Debug, Default)]
pub(super) struct Moments {
    second: Matrix3,
    fourth: [f64; 15],
    count: f64,
}

impl Moments {
    pub(super) fn add(&mut self, axis: &Vector3) {
        self.second += axis * axis.transpose();
        for (sum, value) in self.fourth.iter_mut().zip(monomials(axis)) {
            *sum += value;
        }
        self.count += 1.0;
    }

    /// Mean of `u uᵀ`.
    pub(super) fn mean_square(&self) -> Matrix3 {
        self.second / self.count
    }

    /// Mean of `(u · n)^4`.
    fn mean_fourth(&self, n: &Vector3) -> f64 {
        let terms = self.fourth.iter().zip(monomials(n)).zip(MONOMIALS);
        terms
            .map(|((sum, value), (_, times))| times * sum * value)
            .sum::<f64>()
            / self.count
    }

    /// Mean of `P4(u · n) = (35 (u · n)^4 - 30 (u · n)² + 3) / 8`.
    fn mean_p4(&self, n: &Vector3) -> f64 {
        let square = n.dot(&(self.second * n)) / self.count;
        (35.0 * self.mean_fourth(n) - 30.0 * square + 3.0) / 8.0
    }

    /// The direction where the mean of `P4` is largest, and its value.
    ///
    /// A pattern search, with steps halved down to 1e-9, from every direction of a net that may lead to the
    /// largest value.
    pub(super) fn largest_p4(&self) -> (Vector3, f64) {
        let heights: Vec<(Vector3, f64)> = net().map(|n| (n, self.mean_p4(&n))).collect();
        let most = heights
            .iter()
            .map(|h| h.1)
            .fold(f64::NEG_INFINITY, f64::max);
        let is_peak = |(n, height): &&(Vector3, f64)| {
            let beside = heights.iter().filter(|(m, _)| n.dot(m).abs() > BESIDE);
            *height >= most - RISE && beside.into_iter().all(|(_, other)| other <= height)
        };
        let peaks = heights.iter().filter(is_peak).map(|peak| self.climb(*peak));
        let higher = |a: (Vector3, f64), b: (Vector3, f64)| if b.1 > a.1 { b } else { a };
        peaks
            .reduce(higher)
            .unwrap_or((Vector3::z(), self.mean_p4(&Vector3::z())))
    }

    /// The local maximum reached from a direction with its value.
    fn climb(&self, (mut best, mut most): (Vector3, f64)) -> (Vector3, f64) {
        let value = |n: &Vector3| self.mean_p4(n);
        let mut step = 0.1;
        while step > 1e-9 {
            let across = best.cross(&Vector3::ith(best.iamin(), 1.0)).normalize();
            let along = best.cross(&across);
            let trials = [across, -across, along, -along].map(|t| (best + step * t).normalize());
            let better = trials.into_iter().map(|n| (n, value(&n)));
            match better.max_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((n, found)) if found > most => (best, most) = (n, found),
                _ => step *= 0.5,
            }
        }
        (best, most)
    }
}

/// Cosine of the angle (14 degrees) within which directions of the net are neighbours.
const BESIDE: f64 = 0.97;

/// Largest rise of `P4` from the nearest direction of the net, at most 6.5 degrees away, to a maximum: its
/// second derivative is at most 10.
const RISE: f64 = 0.065;

/// `P4(x)`.
pub(super) fn p4(x: f64) -> f64 {
    let square = x * x;
    ((35.0 * square - 30.0) * square + 3.0) / 8.0
}

/// Evenly spread directions of a hemisphere, about 9 degrees apart: the Fibonacci lattice.
fn net() -> impl Iterator<Item = Vector3> {
    let golden = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
    (0..250).map(move |i| {
        let z = (f64::from(i) + 0.5) / 250.0;
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vector3::new(r * cos, r * sin, z)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Rotation;

    /// The moments give the same mean of P4 as the axes themselves, in any direction.
    #[test]
    fn moments_hold_the_mean() {
        let axes: Vec<Vector3> = net().skip(7).step_by(11).collect();
        let mut moments = Moments::default();
        axes.iter().for_each(|a| moments.add(a));
        for n in net().step_by(17) {
            let plain = axes.iter().map(|a| p4(a.dot(&n))).sum::<f64>() / axes.len() as f64;
            assert!((moments.mean_p4(&n) - plain).abs() < 1e-13);
        }
        assert!((moments.mean_square().trace() - 1.0).abs() < 1e-14);
    }

    /// The largest of several maxima of similar height is found: no direction of a fine scan is higher.
    #[test]
    fn no_direction_is_higher() {
        let mut state = 3_u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let scan: Vec<Vector3> = (0..4000)
            .map(|_| Vector3::new(draw(), draw(), draw()).normalize())
            .collect();
        for count in 1..200 {
            let mut moments = Moments::default();
            for _ in 0..3 * (1 + count % 7) {
                moments.add(&Vector3::new(draw(), draw(), draw()).normalize());
            }
            let (_, most) = moments.largest_p4();
            let scanned = scan.iter().map(|n| moments.mean_p4(n)).fold(-1.0, f64::max);
            assert!(scanned <= most + 1e-12, "{count}: {scanned} {most}");
        }
    }

    /// Three axes at right angles: P4 is largest along one of them, (1 + 2 · 3/8)/3 = 7/12.
    #[test]
    fn largest_is_found() {
        for k in 0..20 {
            let turn = Rotation::from_euler_angles(0.3 * f64::from(k), 1.1, -0.7 * f64::from(k));
            let mut moments = Moments::default();
            (0..3).for_each(|k| moments.add(&(turn * Vector3::ith(k, 1.0))));
            let (n, value) = moments.largest_p4();
            assert!((value - 7.0 / 12.0).abs() < 1e-12, "{value}");
            let along = (0..3).map(|k| (turn * Vector3::ith(k, 1.0)).dot(&n).abs());
            assert!(along.fold(0.0, f64::max) > 1.0 - 1e-9);
        }
    }
}
