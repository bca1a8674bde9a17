//! The tail of a distribution: its exponent by maximum likelihood, where it starts, how sure that is.

use serde::{Deserialize, Serialize};

use crate::bootstrap::{MOST_DRAWS, check_confidence, check_draws, draw_counts, quantile};
use crate::error::AnalysisError;
use crate::ordered::ordered_map;

/// Fewest values a tail may have.
const LEAST: usize = 20;

/// Values whose mean excess over the start is less than this part of the largest are alike: they differ by rounding.
const SPREAD: f64 = 1e-9;

/// Candidates for the start of a tail.
const STARTS: usize = 60;

/// Points at which the distance between sample and law is looked at.
const PROBES: usize = 250;

/// Values that can be fitted: with these their inverses are numbers.
const VALUES: std::ops::RangeInclusive<f64> = 1e-300..=1e300;

/// The law of a tail above its start f₀.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TailLaw {
    /// Density β exp(−β (f − f₀)): the common tail of contact forces. The exponent is β.
    #[default]
    Exponential,
    /// Density (α − 1)/f₀ (f/f₀)^(−α). The exponent is α.
    Power,
}

/// How [`fit_tail`] fits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TailOptions {
    /// The law.
    pub law: TailLaw,
    /// Where the tail starts, above 0. `None`, the default, finds it: the start from which on the law is
    /// nearest to the sample (least Kolmogorov-Smirnov distance, Clauset, Shalizi and Newman 2009), among
    /// 60 quantiles of the upper nine tenths.
    pub start: Option<f64>,
    /// Bootstrap draws for the interval, 20 to 1e6. Default 1000.
    pub resamples: u32,
    /// Confidence of the interval, above 0 and below 1. Default 0.95.
    pub confidence: f64,
    /// Seed of the random stream. Default 1.
    pub seed: u64,
}

impl Default for TailOptions {
    fn default() -> Self {
        Self {
            law: TailLaw::default(),
            start: None,
            resamples: 1000,
            confidence: 0.95,
            seed: 1,
        }
    }
}

/// A fitted tail.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TailFit {
    /// The law.
    pub law: TailLaw,
    /// The exponent: β, in the inverse of the unit of the values, or α.
    pub exponent: f64,
    /// Bootstrap interval of the exponent. Where the start was found and not given, each draw finds its own.
    pub interval: [f64; 2],
    /// Confidence of the interval.
    pub confidence: f64,
    /// Where the tail starts.
    pub start: f64,
    /// Whether the start was given.
    pub start_given: bool,
    /// Number of values in the tail.
    pub count: usize,
    /// Kolmogorov-Smirnov distance of the values in the tail from the law; above some 1.1/√count the law
    /// does not describe the tail (5 % level with a fitted exponent, Lilliefors 1969).
    pub distance: f64,
}

/// Fits the tail of positive `values` by maximum likelihood, with a bootstrap interval.
///
/// The exponent is that of Hill's estimator: for the exponential β = n/Σ(f − f₀), for the power
/// α = 1 + n/Σ ln(f/f₀), both times (n − 1)/n, which takes away their bias. The interval is
/// that of the bootstrap of ln(exponent) with its spread studentised (Efron and Tibshirani 1993, chapter
/// 12): in the log the estimate has nearly the same spread 1/√n whatever the exponent. It measures
/// the chance of sampling independent values; forces of neighbours are weakly dependent. Of 1,000 samples of
/// 400 values each, 950 intervals of 95 % held the true exponent with the start given; with the start
/// found, 182 to 189 of 200, by the sample. Both laws are continuous: the intervals of values that
/// were rounded coarsely hold the truth less often.
///
/// `None` if fewer than 20 values lie above the start, or all of them are equal to nine digits.
///
/// ```
/// use femdem_analysis::{TailOptions, fit_tail};
///
/// // Quantiles of an exponential law with exponent 2.
/// let values: Vec<f64> = (0..2000).map(|i| -0.5 * ((f64::from(i) + 0.5) / 2000.0).ln()).collect();
/// let fit = fit_tail(&values, &TailOptions { start: Some(0.5), ..TailOptions::default() })?.unwrap();
/// assert!((fit.exponent - 2.0).abs() < 0.02);
/// assert!(fit.interval[0] < 2.0 && 2.0 < fit.interval[1]);
/// # Ok::<(), femdem_analysis::AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Option`] for an option out of its range, or a value that is not within 1e-300 to 1e300.
pub fn fit_tail(values: &[f64], options: &TailOptions) -> Result<Option<TailFit>, AnalysisError> {
    options.validate()?;
    if let Some(bad) = values.iter().find(|v| !VALUES.contains(*v)) {
        return Err(AnalysisError::Option {
            name: "values",
            value: *bad,
            allowed: "1e-300 to 1e300",
        });
    }
    let unit = options.law.unit(values);
    // In the log a power law is an exponential one.
    let mut sorted: Vec<f64> = values
        .iter()
        .map(|v| options.law.scaled(*v / unit))
        .collect();
    sorted.sort_by(f64::total_cmp);
    let starts = options.starts(&sorted, unit);
    let once = vec![1; sorted.len()];
    let Some(best) = Suffixes::new(&sorted, &once).best(&sorted, &starts) else {
        return Ok(None);
    };
    let roots = ordered_map(
        options.resamples as usize,
        || vec![0_u32; sorted.len()],
        |counts, draw| studentised(&sorted, counts, &starts, &best, options.seed, draw),
    );
    let mut roots: Vec<f64> = roots.into_iter().flatten().collect();
    if roots.len() < 20 {
        return Ok(None);
    }
    roots.sort_by(f64::total_cmp);
    let spread = best.log_spread;
    let bound = |level: f64| {
        options
            .law
            .exponent(best.rate / unit * (-spread * quantile(&roots, level)).exp())
    };
    let outside = 0.5 * (1.0 - options.confidence);
    Ok(Some(TailFit {
        law: options.law,
        exponent: options.law.exponent(best.rate / unit),
        interval: [bound(1.0 - outside), bound(outside)],
        confidence: options.confidence,
        start: options
            .start
            .unwrap_or_else(|| options.law.unscaled(best.start) * unit),
        start_given: options.start.is_some(),
        count: best.count as usize,
        distance: best.distance,
    }))
}

/// Distance of a draw's ln(rate) from the sample's, over the draw's own spread.
fn studentised(
    sorted: &[f64],
    counts: &mut [u32],
    starts: &[f64],
    sample: &Tail,
    seed: u64,
    draw: usize,
) -> Option<f64> {
    draw_counts(seed, draw, counts);
    let tail = Suffixes::new(sorted, counts).best(sorted, starts)?;
    Some((tail.rate / sample.rate).ln() / tail.log_spread)
}

/// An exponential tail, on the scale of the law.
#[derive(Clone, Copy, Debug)]
struct Tail {
    start: f64,
    rate: f64,
    count: u64,
    distance: f64,
    /// Standard error of ln(rate): the coefficient of variation of the excesses over √count.
    log_spread: f64,
}

/// For each of the sorted values, number, sum and sum of squares of it and all above it, less the smallest: tails
/// far from zero keep their digits.
struct Suffixes {
    origin: f64,
    count: Vec<u64>,
    sum: Vec<f64>,
    square: Vec<f64>,
}

impl Suffixes {
    fn new(sorted: &[f64], counts: &[u32]) -> Self {
        let n = sorted.len();
        let origin = sorted.first().copied().unwrap_or(0.0);
        let mut count = vec![0; n + 1];
        let mut sum = vec![0.0; n + 1];
        let mut square = vec![0.0; n + 1];
        for i in (0..n).rev() {
            let times = f64::from(counts[i]);
            count[i] = count[i + 1] + u64::from(counts[i]);
            let value = sorted[i] - origin;
            sum[i] = sum[i + 1] + times * value;
            square[i] = square[i + 1] + times * value * value;
        }
        Self {
            origin,
            count,
            sum,
            square,
        }
    }

    /// The tail nearest to its law; the only one if there is one start.
    fn best(&self, sorted: &[f64], starts: &[f64]) -> Option<Tail> {
        let tails = starts.iter().filter_map(|start| self.tail(sorted, *start));
        tails.reduce(|best, tail| {
            if tail.distance < best.distance {
                tail
            } else {
                best
            }
        })
    }

    fn tail(&self, sorted: &[f64], start: f64) -> Option<Tail> {
        let first = sorted.partition_point(|v| *v <= start);
        let count = self.count[first];
        if count < LEAST as u64 {
            return None;
        }
        let n = count as f64;
        let mean = self.sum[first] / n - (start - self.origin);
        let variance = self.square[first] / n - (self.sum[first] / n).powi(2);
        // Written so that NaN fails it too.
        let spread = mean > SPREAD && variance > 0.0;
        if !spread {
            return None;
        }
        let rate = (n - 1.0) / (n * mean);
        Some(Tail {
            start,
            rate,
            count,
            distance: self.distance(sorted, first, start, rate),
            log_spread: variance.sqrt() / (mean * n.sqrt()),
        })
    }

    /// Kolmogorov-Smirnov distance, at up to [`PROBES`] of the values.
    fn distance(&self, sorted: &[f64], first: usize, start: f64, rate: f64) -> f64 {
        let n = self.count[first] as f64;
        let step = (sorted.len() - first).div_ceil(PROBES).max(1);
        let mut farthest = 0.0_f64;
        for i in (first..sorted.len()).step_by(step) {
            let above = (-rate * (sorted[i] - start)).exp();
            let here = self.count[i] as f64 / n;
            let after = self.count[i + 1] as f64 / n;
            farthest = farthest
                .max((above - here).abs())
                .max((above - after).abs());
        }
        farthest
    }
}

impl TailLaw {
    /// What values are measured in: a power of two near the largest where their squares are needed, so that these
    /// are numbers and no digit is lost. Logarithms need none.
    fn unit(self, values: &[f64]) -> f64 {
        let largest = values.iter().copied().fold(0.0, f64::max);
        match self {
            Self::Exponential if largest > 0.0 => largest.log2().floor().exp2(),
            Self::Exponential | Self::Power => 1.0,
        }
    }

    fn scaled(self, value: f64) -> f64 {
        match self {
            Self::Exponential => value,
            Self::Power => value.ln(),
        }
    }

    fn unscaled(self, value: f64) -> f64 {
        match self {
            Self::Exponential => value,
            Self::Power => value.exp(),
        }
    }

    fn exponent(self, rate: f64) -> f64 {
        match self {
            Self::Exponential => rate,
            Self::Power => 1.0 + rate,
        }
    }
}

impl TailOptions {
    fn validate(&self) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        if let Some(start) = self.start
            && (!start.is_finite() || start <= 0.0)
        {
            return refuse("start", start, "above zero and finite");
        }
        check_draws("resamples", self.resamples, 20..=MOST_DRAWS, "20 to 1e6")?;
        check_confidence(self.confidence)
    }

    /// The starts to choose from, on the scale of the law.
    fn starts(&self, sorted: &[f64], unit: f64) -> Vec<f64> {
        if let Some(start) = self.start {
            return vec![self.law.scaled(start / unit)];
        }
        if sorted.len() < LEAST {
            return Vec::new();
        }
        let level = |k: usize| 0.1 + 0.88 * k as f64 / (STARTS - 1) as f64;
        let mut starts: Vec<f64> = (0..STARTS).map(|k| quantile(sorted, level(k))).collect();
        starts.dedup();
        starts
    }
}
