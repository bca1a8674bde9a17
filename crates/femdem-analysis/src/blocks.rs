//! Errors of means over bodies or contacts: sub-boxes of the pack, drawn with replacement.

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

use crate::bootstrap::BlockBootstrap;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::region::Region;

/// Largest number of blocks along one axis.
const MOST: usize = 8;

/// A mean and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean; 0 if there are no values.
    pub mean: f64,
    /// Its standard error by block bootstrap over sub-boxes of the pack: scatter within this pack. `None` with
    /// fewer than four blocks that contain values.
    pub standard_error: Option<f64>,
    /// Number of values.
    pub count: usize,
}

/// The box around the centres of a pack, cut into equal blocks: at least one and at most 8 along each axis,
/// with at least the side that the bootstrap requires.
#[derive(Clone, Debug)]
pub(crate) struct Blocks {
    low: Point3,
    size: [f64; 3],
    counts: [usize; 3],
    bootstrap: BlockBootstrap,
}

impl Blocks {
    /// Over the box around the centres of all bodies.
    pub(crate) fn of(
        network: &ForceNetwork,
        bootstrap: BlockBootstrap,
    ) -> Result<Self, AnalysisError> {
        bootstrap.validate()?;
        let bounds = Bounds::around(network.bodies().iter().map(|b| b.centre));
        Ok(Self::cut(&bounds, network.mean_diameter(), bootstrap))
    }

    /// Over a region: sub-boxes of a box, slices of a cylinder, the whole of a sphere.
    pub(crate) fn over(
        region: &Region,
        diameter: f64,
        bootstrap: BlockBootstrap,
    ) -> Result<Self, AnalysisError> {
        bootstrap.validate()?;
        let (min, max) = region.corners();
        let mut blocks = Self::cut(&Bounds { min, max }, diameter, bootstrap);
        // A region that cannot be cut into equal blocks is one block.
        match region {
            Region::Box { .. } => {}
            Region::Cylinder { .. } => (blocks.counts[0], blocks.counts[1]) = (1, 1),
            Region::Sphere { .. } => blocks.counts = [1; 3],
        }
        Ok(blocks)
    }

    /// Over a box.
    pub(crate) fn cut(bounds: &Bounds, diameter: f64, bootstrap: BlockBootstrap) -> Self {
        let side = bootstrap.block_over_d * diameter;
        let extent = bounds.max - bounds.min;
        // Conversion to usize saturates, and makes 0 of NaN.
        let counts = [0, 1, 2].map(|k| ((extent[k] / side) as usize).clamp(1, MOST));
        Self {
            low: bounds.min,
            size: [0, 1, 2].map(|k| extent[k] / counts[k] as f64),
            counts,
            bootstrap,
        }
    }

    fn index(&self, at: &Point3) -> usize {
        let cell = |k: usize| {
            let steps = (at[k] - self.low[k]) / self.size[k];
            (steps as usize).min(self.counts[k] - 1)
        };
        cell(0) + self.counts[0] * (cell(1) + self.counts[1] * cell(2))
    }

    /// Mean of equally weighted values, each with a position in the pack.
    pub(crate) fn mean(&self, values: impl IntoIterator<Item = (Point3, f64)>) -> Estimate {
        let mut count = 0;
        let weighed = values.into_iter().map(|(at, value)| {
            count += 1;
            (at, value, 1.0)
        });
        let (mean, standard_error) = self.ratio(weighed);
        Estimate {
            mean,
            standard_error,
            count,
        }
    }

    /// Sum of values over sum of weights, each with a position in the pack, and its standard error; 0 if the
    /// weights are zero.
    pub(crate) fn ratio(
        &self,
        items: impl IntoIterator<Item = (Point3, f64, f64)>,
    ) -> (f64, Option<f64>) {
        let mut blocks = vec![[0.0; 2]; self.counts.iter().product()];
        for (at, value, weight) in items {
            let block = &mut blocks[self.index(&at)];
            block[0] += value;
            block[1] += weight;
        }
        let [value, weight] = blocks
            .iter()
            .fold([0.0; 2], |sum, b| [sum[0] + b[0], sum[1] + b[1]]);
        let mean = if weight > 0.0 { value / weight } else { 0.0 };
        (mean, self.bootstrap.ratio_error(&blocks))
    }

    /// Standard error of the sum of values over the volume of all blocks; `None` with fewer than four blocks.
    pub(crate) fn density_error(
        &self,
        items: impl IntoIterator<Item = (Point3, f64)>,
        volume: f64,
    ) -> Option<f64> {
        let share = volume / self.counts.iter().product::<usize>() as f64;
        let mut blocks = vec![0.0; self.counts.iter().product()];
        for (at, value) in items {
            blocks[self.index(&at)] += value / share;
        }
        self.bootstrap.mean_error(&blocks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::ForceBody;

    /// 8 x 8 x 8 values without correlation: the error is sd / sqrt(n), and the mean is plain.
    #[test]
    fn error_of_independent_values() {
        let centre =
            |i: u32| Point3::new(f64::from(i % 8), f64::from(i / 8 % 8), f64::from(i / 64));
        let bodies: Vec<ForceBody> = (0..512)
            .map(|i| ForceBody {
                centre: centre(i),
                volume: 1.0,
                diameter: 1.0,
                weight: 0.0,
            })
            .collect();
        let network = ForceNetwork::new(&bodies, &[], 0.0).unwrap();
        let blocks = Blocks::of(&network, BlockBootstrap::default()).unwrap();
        assert_eq!(blocks.counts, [4; 3]);
        let mut stream = crate::bootstrap::SplitMix64 { state: 3 };
        let values: Vec<f64> = (0..512).map(|_| stream.below(1000) as f64).collect();
        let placed = (0..).map(centre).zip(values.iter().copied());
        let found = blocks.mean(placed);
        assert_eq!(found.count, 512);
        assert!((found.mean - values.iter().sum::<f64>() / 512.0).abs() < 1e-9);
        let expected = 1000.0 / (12.0 * 512.0_f64).sqrt();
        let error = found.standard_error.unwrap();
        assert!((error / expected - 1.0).abs() < 0.3, "{error} {expected}");
    }

    #[test]
    fn one_body_has_no_error() {
        let body = ForceBody {
            centre: Point3::origin(),
            volume: 1.0,
            diameter: 1.0,
            weight: 0.0,
        };
        let bodies = [body; 2];
        let network = ForceNetwork::new(&bodies, &[], 0.0).unwrap();
        let blocks = Blocks::of(&network, BlockBootstrap::default()).unwrap();
        let found = blocks.mean([(Point3::origin(), 3.0), (Point3::origin(), 4.0)]);
        assert_eq!((found.mean, found.standard_error), (3.5, None));
        assert_eq!(blocks.mean([]).count, 0);
    }
}
