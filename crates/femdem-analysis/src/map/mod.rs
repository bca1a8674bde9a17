//! Local packing density on a grid of cells.

mod cells;

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::bootstrap::BlockBootstrap;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::Region;
use crate::table::{Cell, Table};
use cells::Cells;

/// Largest number of cells of a map.
const MOST_CELLS: f64 = 1e7;

/// How [`density_map`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DensityMapOptions {
    /// Side of a cell over the mean diameter; above 0. Default 1. It is changed so that a whole number of
    /// cells fits along each axis. Cells much smaller than a body show the bodies, not a density.
    pub cell_over_d: f64,
    /// How the error of the mean is computed: from blocks of whole cells.
    pub bootstrap: BlockBootstrap,
}

impl Default for DensityMapOptions {
    fn default() -> Self {
        Self {
            cell_over_d: 1.0,
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// Local packing density on a regular grid. The lists have one value per cell, x running fastest, then y, then
/// z, as in VTK's image data. As a [`Table`] one row per cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DensityMap {
    /// The region measured; the grid covers the smallest box around it.
    pub region: Region,
    /// Lower corner of the grid (m).
    pub origin: Point3,
    /// Sides of a cell along x, y, z (m).
    pub spacing: [f64; 3],
    /// Number of cells along x, y, z.
    pub counts: [usize; 3],
    /// Volume of each cell's part in the region (m³); 0 for cells outside a round region.
    pub volumes: Vec<f64>,
    /// Solid volume in that part (m³), pair overlaps subtracted.
    pub solids: Vec<f64>,
    /// Packing density of each cell: solid over volume, 0 where there is no volume.
    pub densities: Vec<f64>,
    /// Packing density of the whole region.
    pub mean: f64,
    /// Standard error of `mean` by block bootstrap; `None` with fewer than four blocks.
    pub standard_error: Option<f64>,
    /// Standard deviation of the cells' densities, each weighted by its volume: the unevenness of the pack at
    /// the length of a cell.
    pub deviation: f64,
    /// Number of blocks that the bootstrap drew from.
    pub blocks: usize,
}

/// Packing density of every cell of a grid over `region`, by exact clipping.
///
/// Bodies are cut by the cells' sides, and by the region where it is round; overlaps are subtracted pair by
/// pair in the cells where they are. (Overlaps of two bodies that are both non-convex or have many faces, at
/// the round side of a region, count as a whole or not at all, depending on their middle.)
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// // A cube of side 1 m about the corner of four cells.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let body = [PosedBody { shape: 0, pose: Pose::translation(1.0, 0.75, 0.5) }];
/// let region = Region::Box { min: Point3::origin(), max: Point3::new(2.0, 2.0, 1.0) };
/// let options = DensityMapOptions { cell_over_d: 1.0 / 3_f64.sqrt(), ..Default::default() };
/// let map = density_map(&Pack::new(&cube, &body)?, &region, &options)?;
/// assert_eq!(map.counts, [2, 2, 1]);
/// for (found, expected) in map.densities.iter().zip([0.375, 0.375, 0.125, 0.125]) {
///     assert!((found - expected).abs() < 1e-12);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::Option`], also for more than ten
/// million cells.
pub fn density_map(
    pack: &Pack,
    region: &Region,
    options: &DensityMapOptions,
) -> Result<DensityMap, AnalysisError> {
    region.validate()?;
    options.bootstrap.validate()?;
    let diameter = pack.mean_diameter()?;
    let side = options.cell_over_d * diameter;
    let (min, max) = region.corners();
    let cells: f64 = (max - min)
        .iter()
        .map(|extent| (extent / side).max(1.0))
        .product();
    // The condition is false for NaN.
    if !(side > 0.0 && side.is_finite() && cells <= MOST_CELLS) {
        return Err(AnalysisError::Option {
            name: "cell_over_d",
            value: options.cell_over_d,
            allowed: "above zero, finite, and wide enough for at most 10000000 cells",
        });
    }
    let cells = Cells {
        region: *region,
        axes: Axis::grid(&Bounds { min, max }, side)?,
    };
    let volumes = cells.volumes();
    let mut solids = vec![0.0; volumes.len()];
    for (cell, solid) in cells.deposits(pack).into_iter().flatten() {
        solids[cell] += solid;
    }
    let ratio = |solid: f64, volume: f64| if volume > 0.0 { solid / volume } else { 0.0 };
    let parts = || solids.iter().copied().zip(volumes.iter().copied());
    let densities: Vec<f64> = parts()
        .map(|(solid, volume)| ratio(solid, volume))
        .collect();
    let total: f64 = volumes.iter().sum();
    let mean = solids.iter().sum::<f64>() / total;
    let squares: f64 = densities
        .iter()
        .zip(&volumes)
        .map(|(density, volume)| volume * (density - mean).powi(2))
        .sum();
    let mut blocks = vec![[0.0; 2]; 512];
    for (i, (solid, volume)) in parts().enumerate() {
        let block = &mut blocks[cells.block_of(i, options.bootstrap.block_over_d * diameter)];
        *block = [block[0] + solid, block[1] + volume];
    }
    Ok(DensityMap {
        region: *region,
        origin: min,
        spacing: cells.axes.map(|a| a.step),
        counts: cells.axes.map(|a| a.count),
        mean,
        standard_error: options.bootstrap.ratio_error(&blocks),
        deviation: (squares / total).sqrt(),
        blocks: blocks.iter().filter(|b| b[1] > 0.0).count(),
        volumes,
        solids,
        densities,
    })
}

impl DensityMap {
    /// Centre of cell `i` of the lists (m).
    pub fn centre(&self, i: usize) -> Point3 {
        let [nx, ny, _] = self.counts.map(|n| n.max(1));
        let at = [i % nx, i / nx % ny, i / (nx * ny)];
        Point3::from([0, 1, 2].map(|k| self.origin[k] + (at[k] as f64 + 0.5) * self.spacing[k]))
    }
}

impl Table for DensityMap {
    fn columns(&self) -> &'static [&'static str] {
        &["x_m", "y_m", "z_m", "volume_m3", "solid_m3", "density"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let values = self.volumes.iter().zip(&self.solids).zip(&self.densities);
        Box::new(values.enumerate().map(|(i, ((volume, solid), density))| {
            let centre = self.centre(i);
            let numbers = [centre.x, centre.y, centre.z, *volume, *solid, *density];
            numbers.map(Cell::from).to_vec()
        }))
    }
}
