//! P(f): the distribution of contact forces about their mean.

use serde::{Deserialize, Serialize};

use super::tail::{TailFit, TailOptions, fit_tail};
use crate::blocks::{Blocks, Estimate};
use crate::bootstrap::BlockBootstrap;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::table::{Cell, Table};

/// How [`force_distribution`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ForceDistributionOptions {
    /// Width of a bin of f, above 0. Default 0.2.
    pub bin: f64,
    /// How the tail is fitted; its start is in f, the force over the mean.
    pub tail: TailOptions,
    /// How the error of the mean force is computed.
    pub bootstrap: BlockBootstrap,
}

impl Default for ForceDistributionOptions {
    fn default() -> Self {
        Self {
            bin: 0.2,
            tail: TailOptions::default(),
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// A bin of P(f).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceBin {
    /// Lower end, in f.
    pub low: f64,
    /// Upper end, in f.
    pub high: f64,
    /// Number of pairs.
    pub count: u64,
    /// Probability density P(f), per unit of f.
    pub density: f64,
    /// Its counting error, the density times √count over count; pairs are assumed to be independent.
    pub error: f64,
}

/// Distribution of f, the normal force of a pair of bodies that press on each other over its mean.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceDistribution {
    /// Mean normal force (N).
    pub mean_force: Estimate,
    /// Largest normal force over the mean.
    pub largest: f64,
    /// Standard deviation of f.
    pub sd: f64,
    /// P(f) in equal bins from 0 to the largest f.
    pub bins: Vec<ForceBin>,
    /// The tail; `None` where there are too few pairs.
    pub tail: Option<TailFit>,
}

/// P(f) of the pairs of bodies that press on each other, walls left out; `None` without any.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let body = |x| ForceBody { centre: Point3::new(x, 0.0, 0.0), volume: 1.0, diameter: 1.0, weight: 1.0 };
/// let bodies = [body(0.0), body(1.0), body(2.0)];
/// let contact = |first, second, normal_force| ForceContact {
///     first, second: Partner::Body(second), point: Point3::origin(), normal: Vector3::x(), normal_force,
///     tangential: Vector3::zeros(), moment: Vector3::zeros(), class: None,
/// };
/// let contacts = [contact(0, 1, 2.0), contact(1, 2, 4.0)];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// let p = force_distribution(&network, &ForceDistributionOptions { bin: 1.0, ..Default::default() })?.unwrap();
/// assert_eq!(p.mean_force.mean, 3.0);
/// assert_eq!(p.bins.iter().map(|bin| bin.density).collect::<Vec<_>>(), [0.5, 0.5]);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Option`].
pub fn force_distribution(
    network: &ForceNetwork,
    options: &ForceDistributionOptions,
) -> Result<Option<ForceDistribution>, AnalysisError> {
    if !options.bin.is_finite() || options.bin < 1e-3 {
        return Err(AnalysisError::Option {
            name: "bin",
            value: options.bin,
            allowed: "0.001 or more and finite",
        });
    }
    let blocks = Blocks::of(network, options.bootstrap)?;
    let mean_force = blocks.mean(network.pressing_pairs().map(|(i, j, pair)| {
        let first = network.centre(i);
        let middle = femdem_mesh::nalgebra::center(&first, &(first + network.branch(i, j)));
        (middle, pair.normal_force)
    }));
    // The condition is false for NaN.
    let positive = mean_force.mean > 0.0;
    if !positive {
        return Ok(None);
    }
    let f: Vec<f64> = network
        .pressing_pairs()
        .map(|(_, _, pair)| pair.normal_force / mean_force.mean)
        .collect();
    let count = f.len() as f64;
    let mean = f.iter().sum::<f64>() / count;
    let variance = f.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / count;
    Ok(Some(ForceDistribution {
        mean_force,
        largest: f.iter().copied().fold(0.0, f64::max),
        sd: variance.sqrt(),
        bins: bins(&f, options.bin),
        tail: fit_tail(&f, &options.tail)?,
    }))
}

/// Largest number of bins; larger forces are in the last one.
const MOST_BINS: usize = 10_000;

fn bins(f: &[f64], width: f64) -> Vec<ForceBin> {
    let bin_of = |f: f64| ((f / width) as usize).min(MOST_BINS - 1);
    let number = f.iter().map(|f| bin_of(*f) + 1).max().unwrap_or(0);
    let mut counts = vec![0_u64; number];
    for f in f {
        counts[bin_of(*f)] += 1;
    }
    let all = f.len() as f64;
    let bin = |(k, count): (usize, u64)| ForceBin {
        low: k as f64 * width,
        high: (k + 1) as f64 * width,
        count,
        density: count as f64 / (all * width),
        error: (count as f64).sqrt() / (all * width),
    };
    counts.into_iter().enumerate().map(bin).collect()
}

impl Table for ForceDistribution {
    fn columns(&self) -> &'static [&'static str] {
        &["f_low", "f_high", "pairs", "density", "density_error"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.bins.iter().map(|bin| {
            vec![
                bin.low.into(),
                bin.high.into(),
                bin.count.into(),
                bin.density.into(),
                bin.error.into(),
            ]
        }))
    }
}
