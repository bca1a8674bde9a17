//! Standard error of a mean by resampling blocks.

/// Standard deviation of the mean of `values` drawn with replacement; `None` for fewer than two.
///
/// The draws come from [`SplitMix64`] started at `seed`, so they are the same on every machine.
pub(crate) fn standard_error(values: &[f64], resamples: u32, seed: u64) -> Option<f64> {
    if values.len() < 2 || resamples < 2 {
        return None;
    }
    let mut stream = SplitMix64 { state: seed };
    let mut mean_of_draw = || {
        let sum: f64 = (0..values.len())
            .map(|_| values[stream.below(values.len())])
            .sum();
        sum / values.len() as f64
    };
    let means: Vec<f64> = (0..resamples).map(|_| mean_of_draw()).collect();
    let mean = means.iter().sum::<f64>() / f64::from(resamples);
    let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    Some((squares / f64::from(resamples - 1)).sqrt())
}

/// Steele, Lea and Flood's SplitMix64 (OOPSLA 2014).
struct SplitMix64 {
    state: u64,
}

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in `0..n`; the bias is below `n / 2^64`.
    fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.next()) * n as u128) >> 64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First outputs of the reference implementation (Vigna's splitmix64.c) from state 1234567.
    #[test]
    fn stream_is_splitmix64() {
        let mut stream = SplitMix64 { state: 1_234_567 };
        assert_eq!(
            [stream.next(), stream.next()],
            [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]
        );
    }

    /// The bootstrap of a mean tends to `sqrt(sum of squared deviations) / n`.
    #[test]
    fn error_of_a_mean() {
        let values: Vec<f64> = (0..40).map(|i| f64::from(i * i % 17)).collect();
        let mean = values.iter().sum::<f64>() / 40.0;
        let expected = values
            .iter()
            .map(|v| (v - mean).powi(2))
            .sum::<f64>()
            .sqrt()
            / 40.0;
        let found = standard_error(&values, 4000, 7).unwrap();
        assert!(
            (found / expected - 1.0).abs() < 0.04,
            "{found} against {expected}"
        );
        assert_eq!(
            standard_error(&values, 100, 7),
            standard_error(&values, 100, 7)
        );
        assert_ne!(
            standard_error(&values, 100, 7),
            standard_error(&values, 100, 8)
        );
        assert_eq!(standard_error(&values[..1], 100, 7), None);
    }
}
