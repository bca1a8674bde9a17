//! Standard errors of means and ratios by resampling blocks.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::error::AnalysisError;

/// With fewer blocks their scatter says nothing.
const FEWEST: usize = 4;

/// How a block bootstrap draws: the error of a mean over a pack, whose neighbouring parts are alike.
///
/// The region is cut into equal blocks; as many blocks as there are, are drawn with replacement; the mean is
/// taken over the draw; and the standard deviation of that mean over `resamples` draws is reported, times sqrt(n/(n - 1))
/// for n blocks. It measures scatter within one pack: what differs from pour to pour as a whole it cannot see. With
/// fewer than some 8 blocks it is rough, with fewer than 4 there is none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BlockBootstrap {
    /// Least side of a block over the mean diameter; above 0. Default 1.5, a length beyond which the
    /// density of a random pack is but weakly correlated.
    pub block_over_d: f64,
    /// Number of draws, 2 to 1e6. Default 1000.
    pub resamples: u32,
    /// Seed of the random stream. Default 1.
    pub seed: u64,
}

impl Default for BlockBootstrap {
    fn default() -> Self {
        Self {
            block_over_d: 1.5,
            resamples: 1000,
            seed: 1,
        }
    }
}

/// Most draws: their results are kept.
pub(crate) const MOST_DRAWS: u32 = 1_000_000;

/// Refuses a number of draws that is not `within`.
pub(crate) fn check_draws(
    name: &'static str,
    draws: u32,
    within: RangeInclusive<u32>,
    allowed: &'static str,
) -> Result<(), AnalysisError> {
    if within.contains(&draws) {
        return Ok(());
    }
    Err(AnalysisError::Option {
        name,
        value: f64::from(draws),
        allowed,
    })
}

/// Refuses a confidence that no interval can have.
pub(crate) fn check_confidence(confidence: f64) -> Result<(), AnalysisError> {
    // Written so that NaN fails it too.
    if confidence > 0.0 && confidence < 1.0 {
        return Ok(());
    }
    Err(AnalysisError::Option {
        name: "confidence",
        value: confidence,
        allowed: "above 0 and below 1",
    })
}

/// How often each of the sample's values is in a draw with replacement. One stream per draw, so that draws may be shared
/// among threads.
pub(crate) fn draw_counts(seed: u64, draw: usize, counts: &mut [u32]) {
    let mut stream = SplitMix64 { state: seed };
    let offset = stream.next();
    let mut stream = SplitMix64 {
        state: offset ^ (draw as u64).wrapping_mul(0xD1B5_4A32_D192_ED03),
    };
    counts.fill(0);
    for _ in 0..counts.len() {
        counts[stream.below(counts.len())] += 1;
    }
}

/// Value of sorted numbers below which the share `level` of them lies, between neighbours by line.
pub(crate) fn quantile(sorted: &[f64], level: f64) -> f64 {
    let at = level.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64)
}

impl BlockBootstrap {
    pub(crate) fn validate(&self) -> Result<(), AnalysisError> {
        if !self.block_over_d.is_finite() || self.block_over_d <= 0.0 {
            return Err(AnalysisError::Option {
                name: "block_over_d",
                value: self.block_over_d,
                allowed: "above zero and finite",
            });
        }
        check_draws("resamples", self.resamples, 2..=MOST_DRAWS, "2 to 1e6")
    }

    /// Standard error of the mean of one value per block; `None` for fewer than four.
    pub(crate) fn mean_error(&self, values: &[f64]) -> Option<f64> {
        let blocks: Vec<[f64; 2]> = values.iter().map(|v| [*v, 1.0]).collect();
        self.ratio_error(&blocks)
    }

    /// Standard error of `sum of the first / sum of the second` of blocks' `[value, weight]`; `None` with
    /// fewer than four blocks of weight above zero.
    pub(crate) fn ratio_error(&self, blocks: &[[f64; 2]]) -> Option<f64> {
        let weighty: Vec<[f64; 2]> = blocks.iter().copied().filter(|b| b[1] > 0.0).collect();
        resample(weighty.len(), self.resamples, self.seed, |draw| {
            let sums = draw
                .map(|i| weighty[i])
                .fold([0.0; 2], |sum, b| [sum[0] + b[0], sum[1] + b[1]]);
            sums[0] / sums[1]
        })
    }
}

/// Standard deviation of `statistic` over draws of `count` indices with replacement.
///
/// The draws come from [`SplitMix64`] started at `seed`, so they are the same on every machine.
fn resample(
    count: usize,
    resamples: u32,
    seed: u64,
    statistic: impl Fn(&mut dyn Iterator<Item = usize>) -> f64,
) -> Option<f64> {
    if count < FEWEST || resamples < 2 {
        return None;
    }
    let mut stream = SplitMix64 { state: seed };
    let found: Vec<f64> = (0..resamples)
        .map(|_| statistic(&mut (0..count).map(|_| stream.below(count))))
        .collect();
    let mean = found.iter().sum::<f64>() / f64::from(resamples);
    let squares: f64 = found.iter().map(|m| (m - mean).powi(2)).sum();
    // Draws scatter about the mean of the blocks, which follows them.
    let low = count as f64 / (count - 1) as f64;
    Some((low * squares / f64::from(resamples - 1)).sqrt())
}

/// Steele, Lea and Flood's SplitMix64 (OOPSLA 2014).
pub(crate) struct SplitMix64 {
    pub(crate) state: u64,
}

impl SplitMix64 {
    pub(crate) fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in `0..n`; the bias is below `n / 2^64`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
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
        let with = |resamples, seed| {
            let options = BlockBootstrap {
                resamples,
                seed,
                ..BlockBootstrap::default()
            };
            options.mean_error(&values).unwrap()
        };
        let found = with(4000, 7);
        assert!(
            (found / expected - 1.0).abs() < 0.04,
            "{found} against {expected}"
        );
        assert_eq!(with(100, 7).to_bits(), with(100, 7).to_bits());
        assert_ne!(with(100, 7).to_bits(), with(100, 8).to_bits());
    }

    /// With equal weights the ratio is the mean; blocks without weight play no part.
    #[test]
    fn error_of_a_ratio() {
        let options = BlockBootstrap::default();
        let values = [0.2, 0.5, 0.9, 0.4, 0.7];
        let blocks: Vec<[f64; 2]> = values.iter().map(|v| [3.0 * v, 3.0]).collect();
        let found = options.ratio_error(&blocks).unwrap();
        let plain = options.mean_error(&values).unwrap();
        assert!((found - plain).abs() < 1e-12);
        let padded = [&blocks[..], &[[0.0, 0.0]]].concat();
        assert_eq!(options.ratio_error(&padded), Some(found));
        assert_eq!(options.ratio_error(&blocks[..1]), None);
    }

    #[test]
    fn bad_options_are_named() {
        let bad = |block_over_d, resamples| BlockBootstrap {
            block_over_d,
            resamples,
            seed: 1,
        };
        for (options, name) in [
            (bad(0.0, 10), "block_over_d"),
            (bad(f64::NAN, 10), "block_over_d"),
            (bad(1.0, 1), "resamples"),
        ] {
            assert!(
                matches!(options.validate(), Err(AnalysisError::Option { name: n, .. }) if n == name)
            );
        }
    }
}
