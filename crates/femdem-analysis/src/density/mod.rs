//! Packing density: exactly, by the paper's grid, and with its standard error.

mod exact;
mod grid;

use serde::{Deserialize, Serialize};

pub use exact::{ExactDensity, exact_density, volume_inside};
pub use grid::{GridDensity, grid_density};

pub(crate) use exact::{solid_of_bodies, volumes_of_bodies};

use crate::bootstrap::BlockBootstrap;
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::Region;

/// How [`packing_density`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DensityOptions {
    /// Grid spacing over the mean diameter; above 0. Default 1/20.
    pub grid_spacing_over_d: f64,
    /// Smallest side of a bootstrap block over the mean diameter; above 0. Default 1.5, a length beyond which
    /// the density of a random pack is only weakly correlated.
    pub block_over_d: f64,
    /// Number of bootstrap draws, 2 to 1e6. Default 1000.
    pub resamples: u32,
    /// Seed of the bootstrap's random stream. Default 1.
    pub seed: u64,
}

impl Default for DensityOptions {
    fn default() -> Self {
        Self {
            grid_spacing_over_d: 0.05,
            block_over_d: 1.5,
            resamples: 1000,
            seed: 1,
        }
    }
}

impl DensityOptions {
    fn validate(&self) -> Result<(), AnalysisError> {
        let spacing = self.grid_spacing_over_d;
        if !spacing.is_finite() || spacing <= 0.0 {
            return Err(AnalysisError::Option {
                name: "grid_spacing_over_d",
                value: spacing,
                allowed: "above zero and finite",
            });
        }
        self.bootstrap().validate()
    }

    fn bootstrap(&self) -> BlockBootstrap {
        BlockBootstrap {
            block_over_d: self.block_over_d,
            resamples: self.resamples,
            seed: self.seed,
        }
    }
}

/// Packing density (solid volume over region volume, 0 to 1) of a region, measured in two ways.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackingDensity {
    /// By exact clipping, overlaps subtracted.
    pub exact: f64,
    /// By counting cells of a regular grid. `None` if there would be too many of them
    /// ([`AnalysisError::GridTooFine`]); the next two fields are `None` then, too.
    pub grid: Option<f64>,
    /// Distance of the grid's cell centres along x, y and z (m).
    pub grid_spacing: Option<[f64; 3]>,
    /// Standard deviation of `grid` from counting (see [`GridDensity::error`]).
    pub grid_error: Option<f64>,
    /// Standard error of `exact` as the density of a larger pack of the same kind, by block bootstrap. `None`
    /// if the region is too small for four blocks.
    pub standard_error: Option<f64>,
    /// Number of blocks the bootstrap drew from.
    pub blocks: usize,
    /// The region measured.
    pub core: Region,
    /// The parts of the exact density.
    pub parts: ExactDensity,
}

/// Packing density of `region`, exactly and by the grid, with a standard error.
///
/// The region is best taken from [`choose_core`](crate::choose_core).
///
/// **Standard error.** The region is cut into equal blocks of side `block_over_d` diameters or more (at most 8
/// along each axis of a box; slices along z of a cylinder). The exact density of each is computed; blocks are
/// drawn with replacement, as many as there are, `resamples` times, and the standard deviation of the means,
/// times sqrt(n/(n - 1)) for n blocks, is reported. It measures scatter within this pack and does not include
/// differences between pours. With fewer than about 8 blocks it is rough, with fewer than 4 there is none.
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::Option`].
pub fn packing_density(
    pack: &Pack,
    region: &Region,
    options: &DensityOptions,
) -> Result<PackingDensity, AnalysisError> {
    options.validate()?;
    region.validate()?;
    let diameter = pack.mean_diameter()?;
    let grid = match grid_density(pack, region, options.grid_spacing_over_d * diameter) {
        Ok(grid) => Some(grid),
        Err(AnalysisError::GridTooFine { .. }) => None,
        Err(other) => return Err(other),
    };
    let measured = exact::Measured::new(pack, region);
    let parts = measured.density(region);
    let blocks = region.blocks(options.block_over_d * diameter);
    let densities: Vec<f64> = if blocks.len() < 2 {
        Vec::new()
    } else {
        blocks
            .iter()
            .map(|block| measured.within(pack, block).density(block).density)
            .collect()
    };
    Ok(PackingDensity {
        exact: parts.density,
        grid: grid.map(|grid| grid.density),
        grid_spacing: grid.map(|grid| grid.spacing),
        grid_error: grid.map(|grid| grid.error),
        standard_error: options.bootstrap().mean_error(&densities),
        blocks: blocks.len(),
        core: *region,
        parts,
    })
}
