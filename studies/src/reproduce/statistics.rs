//! Means, their errors, and intervals.

/// A mean with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Estimate {
    pub(super) mean: f64,
    /// NaN if unknown.
    pub(super) error: f64,
    /// Runs.
    pub(super) count: usize,
}

impl Estimate {
    /// This minus a published value: the difference, and the same over the combined standard error.
    pub(super) fn against(&self, value: f64, error: f64) -> (f64, f64) {
        let difference = self.mean - value;
        (difference, difference / self.error.hypot(error))
    }
}

/// The mean of several runs, each a value with its own error. The standard error is the larger of that from the
/// scatter between runs and that from their own errors; for one run it is its own.
pub(super) fn estimate(runs: &[(f64, f64)]) -> Option<Estimate> {
    let n = runs.len() as f64;
    if runs.is_empty() {
        return None;
    }
    let mean = runs.iter().map(|r| r.0).sum::<f64>() / n;
    let own = (runs.iter().map(|r| r.1 * r.1).sum::<f64>() / n).sqrt() / n.sqrt();
    let between = match deviation(&runs.iter().map(|r| r.0).collect::<Vec<_>>()) {
        Some(deviation) => deviation / n.sqrt(),
        None => f64::NAN,
    };
    Some(Estimate {
        mean,
        // The larger of the two; if one is NaN, the other.
        error: own.max(between),
        count: runs.len(),
    })
}

/// The sample standard deviation of two values or more.
pub(super) fn deviation(values: &[f64]) -> Option<f64> {
    if values.len() < 2 {
        return None;
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    Some((squares / (n - 1.0)).sqrt())
}

/// The standard deviation within groups of values, and its degrees of freedom.
pub(super) fn pooled(groups: &[Vec<f64>]) -> Option<(f64, usize)> {
    let (mut squares, mut freedom) = (0.0, 0);
    for group in groups {
        if let Some(deviation) = deviation(group) {
            squares += deviation * deviation * (group.len() - 1) as f64;
            freedom += group.len() - 1;
        }
    }
    (freedom > 0).then(|| ((squares / freedom as f64).sqrt(), freedom))
}

/// The 97.5 % point of Student's distribution, by the expansion in 1/freedom (Abramowitz and Stegun
/// 26.7.5); exact for 1 and 2.
pub(super) fn student(freedom: usize) -> f64 {
    let x = 1.959_963_985_f64;
    let n = freedom as f64;
    match freedom {
        0 => f64::NAN,
        1 => 12.706_205,
        2 => 4.302_653,
        _ => {
            let (x3, x5, x7) = (x.powi(3), x.powi(5), x.powi(7));
            let x9 = x.powi(9);
            x + (x3 + x) / (4.0 * n)
                + (5.0 * x5 + 16.0 * x3 + 3.0 * x) / (96.0 * n * n)
                + (3.0 * x7 + 19.0 * x5 + 17.0 * x3 - 15.0 * x) / (384.0 * n.powi(3))
                + (79.0 * x9 + 776.0 * x7 + 1482.0 * x5 - 1920.0 * x3 - 945.0 * x)
                    / (92_160.0 * n.powi(4))
        }
    }
}

/// The 95 % interval of mean(a) - mean(b) by the bootstrap: both resampled with replacement.
pub(super) fn bootstrap_difference(a: &[f64], b: &[f64], resamples: usize) -> Option<[f64; 2]> {
    if a.len() < 2 || b.len() < 2 || resamples < 40 {
        return None;
    }
    let mut random = Random(0x5eed);
    let mut found: Vec<f64> = (0..resamples)
        .map(|_| random.mean_of(a) - random.mean_of(b))
        .collect();
    found.sort_by(f64::total_cmp);
    let at = |part: f64| found[(part * (resamples - 1) as f64).round() as usize];
    Some([at(0.025), at(0.975)])
}

/// Root mean square, and mean, of differences.
pub(super) fn spread(differences: &[f64]) -> Option<(f64, f64)> {
    if differences.is_empty() {
        return None;
    }
    let n = differences.len() as f64;
    let squares: f64 = differences.iter().map(|d| d * d).sum();
    Some(((squares / n).sqrt(), differences.iter().sum::<f64>() / n))
}

/// Splitmix64: the same draws on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn mean_of(&mut self, values: &[f64]) -> f64 {
        let n = values.len();
        let sum: f64 = (0..n).map(|_| values[self.next() as usize % n]).sum();
        sum / n as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_and_own_errors_the_larger_counts() {
        let close = estimate(&[(0.5, 0.04), (0.5, 0.04), (0.5, 0.04), (0.5, 0.04)]).unwrap();
        assert!((close.error - 0.02).abs() < 1e-12 && close.count == 4);
        let far = estimate(&[(0.4, 0.0), (0.6, 0.0)]).unwrap();
        assert!((far.mean - 0.5).abs() < 1e-12 && (far.error - 0.1).abs() < 1e-12);
        assert_eq!(estimate(&[(0.4, 0.01)]).unwrap().error, 0.01);
        let unknown = estimate(&[(0.4, f64::NAN), (0.6, f64::NAN)]).unwrap();
        assert!((unknown.error - 0.1).abs() < 1e-12);
        assert_eq!(estimate(&[]), None);
        let (difference, sigmas) = close.against(0.45, 0.015);
        assert!((difference - 0.05).abs() < 1e-12 && (sigmas - 2.0).abs() < 1e-12);
    }

    /// Against tables.
    #[test]
    fn points_of_students_distribution() {
        for (freedom, wanted) in [
            (1, 12.706),
            (2, 4.303),
            (3, 3.182),
            (4, 2.776),
            (6, 2.447),
            (10, 2.228),
            (30, 2.042),
            (120, 1.980),
        ] {
            let found = student(freedom);
            assert!(
                (found - wanted).abs() < 0.012,
                "{freedom}: {found} {wanted}"
            );
        }
        assert!(student(0).is_nan());
    }

    #[test]
    fn groups_are_pooled_about_their_own_means() {
        let (deviation, freedom) =
            pooled(&[vec![1.0, 3.0], vec![11.0, 13.0], vec![100.0]]).unwrap();
        assert!((deviation - 2_f64.sqrt()).abs() < 1e-12 && freedom == 2);
        assert_eq!(pooled(&[vec![1.0]]), None);
    }

    /// A large sample's interval is that of the normal distribution.
    #[test]
    fn the_bootstrap_agrees_with_the_standard_error() {
        let a: Vec<f64> = (0..400).map(|i| f64::from(i % 20)).collect();
        let b: Vec<f64> = a.iter().map(|v| v - 3.0).collect();
        let [low, high] = bootstrap_difference(&a, &b, 4000).unwrap();
        let error = deviation(&a).unwrap() * (2.0_f64 / 400.0).sqrt();
        assert!((low - (3.0 - 1.96 * error)).abs() < 0.1 * error, "{low}");
        assert!((high - (3.0 + 1.96 * error)).abs() < 0.1 * error, "{high}");
        assert_eq!(bootstrap_difference(&a, &b[..1], 4000), None);
    }

    #[test]
    fn spread_has_size_and_sign() {
        let (size, mean) = spread(&[3.0, -4.0]).unwrap();
        assert!((size - 12.5_f64.sqrt()).abs() < 1e-12 && (mean + 0.5).abs() < 1e-12);
        assert_eq!(spread(&[]), None);
    }
}
