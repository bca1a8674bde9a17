//! Packing density by counting cells of a regular grid: the founding paper's method.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::region::{Region, Relation};
use crate::rows::{RowScratch, cells_in_region, spans_of_body};

/// Standard deviation of the counted volume of a body, over `spacing² √area`: 0.26 for round bodies
/// (Kendall), up to 0.30 for polyhedra in random poses.
const VOLUME_ERROR: f64 = 0.30;

/// Standard deviation of the counted area of a plane figure, over `spacing^1.5 √perimeter` (Kendall).
const AREA_ERROR: f64 = 0.27;

/// Packing density by the grid, with its counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridDensity {
    /// Share of the cell centres that lie in a body.
    pub density: f64,
    /// Standard deviation of `density` from counting: `0.30 Δ² √A / V`, with `Δ` the largest spacing, `A` the
    /// surface area of all bodies that reach into the region and `V` the region's volume. It assumes that the
    /// bodies lie at random relative to the grid: errors of bodies that repeat in step with the grid add up,
    /// and faces along the grid have larger errors. Where the pack ends gradually at the region's boundary, an
    /// error of second order in `Δ` is added.
    ///
    /// For a cylinder, the error of its round side is added in squares: columns of height `H` and area `0.27
    /// Δ^1.5 √(2πR)` in all are misplaced, each off the mean density by `√(φ(1-φ) d/H)`. For a sphere, cells of
    /// `0.30 Δ² √(4πR²)` in all are, each off the mean density by `√(φ(1-φ))`.
    pub error: f64,
    /// Distance between cell centres along x, y and z (m): the given spacing, changed so that a whole number of
    /// cells fits.
    pub spacing: [f64; 3],
    /// Cells with their centre in the region.
    pub cells: u64,
    /// Cells with their centre in the region and in a body.
    pub solid_cells: u64,
}

/// Packing density of `region` by a regular grid of spacing near `spacing` (m): a cell counts as solid
/// when its centre lies in a body (Xiang, Latham and Farsi 2016, who test against tetrahedra). Where
/// bodies overlap a cell counts once.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, Region, grid_density};
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?]; // side 1 m
/// let body = [PosedBody { shape: 0, pose: Pose::translation(0.5, 0.5, 0.5) }];
/// let region = Region::Box { min: Point3::origin(), max: Point3::new(2.0, 1.0, 1.0) };
/// let result = grid_density(&Pack::new(&cube, &body)?, &region, 0.1)?;
/// assert_eq!((result.cells, result.solid_cells), (2000, 1000));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::Option`] for a spacing
/// that is not above zero and finite, [`AnalysisError::GridTooFine`].
pub fn grid_density(
    pack: &Pack,
    region: &Region,
    spacing: f64,
) -> Result<GridDensity, AnalysisError> {
    region.validate()?;
    if pack.is_empty() {
        return Err(AnalysisError::EmptyPack);
    }
    if !spacing.is_finite() || spacing <= 0.0 {
        return Err(AnalysisError::Option {
            name: "spacing",
            value: spacing,
            allowed: "above zero and finite (m)",
        });
    }
    let (min, max) = region.corners();
    let axes = Axis::grid(&Bounds { min, max }, spacing)?;
    let bodies = axes[2].sort_bodies(2, pack);
    let counter = LayerCounter { pack, region, axes };
    let counts = ordered_map(axes[2].count, Layer::default, |layer, k| {
        counter.count(layer, k, &bodies[k])
    });
    let (cells, solid_cells) = counts
        .iter()
        .fold((0, 0), |sum, c| (sum.0 + c.0, sum.1 + c.1));
    // A region narrower than a cell has one centre, on its axis, so that there is always a cell.
    let density = solid_cells as f64 / cells as f64;
    let spacing = axes.map(|a| a.step);
    let largest = spacing.into_iter().fold(0.0, f64::max);
    let error = counting_error(pack, region, largest, density)?;
    Ok(GridDensity {
        density,
        error,
        spacing,
        cells,
        solid_cells,
    })
}

fn counting_error(
    pack: &Pack,
    region: &Region,
    step: f64,
    density: f64,
) -> Result<f64, AnalysisError> {
    let reaching =
        (0..pack.len()).filter(|&i| region.relation(pack.bounds(i)) != Relation::Outside);
    // Not `sum`, which is -0 without bodies.
    let area = reaching.fold(0.0, |sum, i| sum + pack.shape(i).area());
    let mut variance = VOLUME_ERROR.powi(2) * step.powi(4) * area;
    match *region {
        Region::Box { .. } => {}
        Region::Cylinder {
            radius,
            z_min,
            z_max,
            ..
        } => {
            let misplaced = AREA_ERROR.powi(2) * step.powi(3) * 2.0 * PI * radius;
            let scatter = density * (1.0 - density) * pack.mean_diameter()?;
            variance += misplaced * scatter * (z_max - z_min);
        }
        Region::Sphere { radius, .. } => {
            let misplaced = VOLUME_ERROR.powi(2) * step.powi(4) * 4.0 * PI * radius * radius;
            variance += misplaced * density * (1.0 - density);
        }
    }
    Ok(variance.sqrt() / region.volume())
}

/// One layer of cells and memory to fill it.
#[derive(Default)]
struct Layer {
    /// Row by row along x: whether the centre lies in a body.
    solid: Vec<bool>,
    scratch: RowScratch,
}

struct LayerCounter<'a> {
    pack: &'a Pack<'a>,
    region: &'a Region,
    axes: [Axis; 3],
}

impl LayerCounter<'_> {
    /// Cells and solid cells of layer `k`, with the bodies whose boxes reach it.
    fn count(&self, layer: &mut Layer, k: usize, bodies: &[usize]) -> (u64, u64) {
        let [x_axis, y_axis, z_axis] = &self.axes;
        let z = z_axis.centre(k);
        layer.solid.clear();
        layer.solid.resize(x_axis.count * y_axis.count, false);
        let Layer { solid, scratch } = layer;
        for &body in bodies {
            spans_of_body(scratch, self.pack, body, y_axis, z, |row, low, high| {
                let cells = x_axis.within(low, high);
                let start = row * x_axis.count;
                solid[start + cells.start..start + cells.end].fill(true);
            });
        }
        let (mut cells, mut solid_cells) = (0, 0);
        for (j, row) in solid.chunks_exact(x_axis.count).enumerate() {
            let inside = &row[cells_in_region(self.region, x_axis, y_axis.centre(j), z)];
            cells += inside.len() as u64;
            solid_cells += inside.iter().filter(|s| **s).count() as u64;
        }
        (cells, solid_cells)
    }
}
