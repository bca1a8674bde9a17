//! Packing density by counting cells of a regular grid: the founding paper's method.

use std::f64::consts::PI;

use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::lines::{convex_span, crossing};
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::region::{Region, Relation};

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
    planes: Vec<(Vector3, f64)>,
    /// Where rows cross a surface of triangles: row and x.
    crossings: Vec<(usize, f64)>,
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
        for &body in bodies {
            if self.pack.by_planes(body) {
                self.fill_by_planes(layer, body, z);
            } else {
                self.fill_by_crossings(layer, body, z);
            }
        }
        let (mut cells, mut solid) = (0, 0);
        for (j, row) in layer.solid.chunks_exact(x_axis.count).enumerate() {
            let inside = &row[self.row_in_region(y_axis.centre(j), z)];
            cells += inside.len() as u64;
            solid += inside.iter().filter(|s| **s).count() as u64;
        }
        (cells, solid)
    }

    /// Cells of a row that lie in the region.
    fn row_in_region(&self, y: f64, z: f64) -> std::ops::Range<usize> {
        match *self.region {
            Region::Box { .. } => 0..self.axes[0].count,
            Region::Cylinder { centre, radius, .. } => {
                let half = (radius * radius - (y - centre[1]).powi(2)).max(0.0).sqrt();
                self.axes[0].within(centre[0] - half, centre[0] + half)
            }
            Region::Sphere { centre, radius } => {
                let off_axis = (y - centre.y).powi(2) + (z - centre.z).powi(2);
                let square = radius * radius - off_axis;
                if square < 0.0 {
                    return 0..0;
                }
                self.axes[0].within(centre.x - square.sqrt(), centre.x + square.sqrt())
            }
        }
    }

    fn fill_row(&self, solid: &mut [bool], row: usize, low: f64, high: f64) {
        let cells = self.axes[0].within(low, high);
        let start = row * self.axes[0].count;
        solid[start + cells.start..start + cells.end].fill(true);
    }

    fn fill_by_planes(&self, layer: &mut Layer, body: usize, z: f64) {
        let bounds = self.pack.bounds(body);
        layer.planes.clear();
        layer.planes.extend(self.pack.world_planes(body));
        for row in self.axes[1].within(bounds.min.y, bounds.max.y) {
            let at = Point3::new(0.0, self.axes[1].centre(row), z);
            if let Some((low, high)) = convex_span(&layer.planes, 0, &at) {
                self.fill_row(&mut layer.solid, row, low, high);
            }
        }
    }

    fn fill_by_crossings(&self, layer: &mut Layer, body: usize, z: f64) {
        layer.crossings.clear();
        let slab = Bounds::slab(2, z, z);
        self.pack.triangles_in(body, &slab, |triangle| {
            let bounds = Bounds::around(triangle);
            // A missing triangle would leave its row with an odd number of crossings.
            for row in self.axes[1].near(bounds.min.y, bounds.max.y) {
                let at = Point3::new(0.0, self.axes[1].centre(row), z);
                let x = crossing(&triangle, 0, &at);
                layer.crossings.extend(x.map(|x| (row, x)));
            }
        });
        layer
            .crossings
            .sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for row in layer.crossings.chunk_by(|a, b| a.0 == b.0) {
            for pair in row.chunks_exact(2) {
                self.fill_row(&mut layer.solid, pair[0].0, pair[0].1, pair[1].1);
            }
        }
    }
}
