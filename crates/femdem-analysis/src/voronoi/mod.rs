//! Set-Voronoi cells: the space nearer to a body than to any other.

mod convex;
mod field;
mod octree;
mod plane_cut;

use femdem_mesh::Point3;
use femdem_mesh::bvh::{Aabb, Bvh};
use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::blocks::{Blocks, Estimate};
use crate::bootstrap::BlockBootstrap;
use crate::bounds::Bounds;
use crate::density::solid_of_bodies;
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::region::Region;
use crate::table::{Cell, Table};
use field::Fields;
use octree::{Memory, Octree, Share};

/// How often a root of the octree is halved.
const LEVELS: u32 = 3;

/// Largest number of roots of the octree.
const MOST_ROOTS: f64 = 1e7;

/// How [`set_voronoi`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SetVoronoiOptions {
    /// Side of the smallest cubes over the mean diameter; above 0. Default 1/8. The error of a cell is
    /// proportional to its square.
    pub leaf_over_d: f64,
    /// Bodies count in the means if their centroid lies here. `None`: all bodies whose cell does not touch the
    /// region's boundary.
    pub core: Option<Region>,
    /// How the errors of the means are computed: from blocks of bodies, by their centroids.
    pub bootstrap: BlockBootstrap,
}

impl Default for SetVoronoiOptions {
    fn default() -> Self {
        Self {
            leaf_over_d: 0.125,
            core: None,
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// The Set-Voronoi cell of one body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct VoronoiCell {
    /// Index of the body.
    pub body: u32,
    /// Volume of the part of the cell in the region (m³).
    pub volume: f64,
    /// Solid volume of the body in the region (m³), minus half of what it shares with others.
    pub solid: f64,
    /// Local packing density: `solid / volume`; 0 for a body without a cell.
    pub density: f64,
    /// Whether the cell reaches the region's boundary: it may end there at a wall, or be cut off.
    pub at_boundary: bool,
    /// Whether the body counts in the means.
    pub counted: bool,
}

/// Set-Voronoi cells of a pack, and means over bodies. As a [`Table`] one row per body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SetVoronoi {
    /// The region that is divided into cells.
    pub region: Region,
    /// Sides of the smallest cubes (m).
    pub leaf: [f64; 3],
    /// The cells of all bodies that reach into the region or have a part of it in their cell, by body.
    pub cells: Vec<VoronoiCell>,
    /// Mean over the counted bodies of the local density, and their number.
    pub mean: Estimate,
    /// Standard deviation of the local densities over those bodies.
    pub deviation: f64,
    /// Packing density of those bodies: their solid volume over the volume of their cells, that is the mean of
    /// the local densities weighted by the volume of the cells.
    pub density: Estimate,
}

/// Set-Voronoi cells (Schaller et al., Phil. Mag. 93, 3993, 2013): every point of `region` belongs to the body
/// whose surface is nearest, points inside two bodies to the one in which they lie deeper.
///
/// **Method.** No points on surfaces are used: the distance to each body is exact. Cubes are halved while more
/// than one body can own a part of them, down to a side near `leaf_over_d` diameters. (A distance changes by no
/// more than the displacement of the point, so that most cubes are settled early.) In a leaf the distances are
/// linearised with their exact gradients, so that borders between two bodies are planes, and the parts are
/// measured exactly. The cells sum to the region to round-off.
///
/// **Error** of a single cell's volume, one standard deviation: 0.1 % with leaves of `d/8` for truncated
/// dodecahedra at a density near 0.55, and a quarter of it or less if the leaf is halved. Where sharp bodies
/// fill space almost completely, a single cell can have an error of 0.8 % (octahedra at 18/19). Errors of
/// neighbouring cells cancel, so that means have smaller errors.
///
/// Cells end at the boundary of the region, for example at walls if the region is the container. End the region
/// at the mean top of the pack, and keep `core` away from it; otherwise the cells of the top bodies are too
/// large.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// // Two cubes of side 1 m, 0.5 m apart: the border is halfway.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let at = |x| PosedBody { shape: 0, pose: Pose::translation(x, 0.5, 0.5) };
/// let bodies = [at(0.5), at(2.0)];
/// let region = Region::Box { min: Point3::origin(), max: Point3::new(3.0, 1.0, 1.0) };
/// let found = set_voronoi(&Pack::new(&cube, &bodies)?, &region, &SetVoronoiOptions::default())?;
/// assert!((found.cells[0].volume - 1.25).abs() < 1e-5);
/// assert!((found.cells[1].density - 1.0 / 1.75).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`] for the region or the core, [`AnalysisError::Option`].
pub fn set_voronoi(
    pack: &Pack,
    region: &Region,
    options: &SetVoronoiOptions,
) -> Result<SetVoronoi, AnalysisError> {
    region.validate()?;
    if let Some(core) = &options.core {
        core.validate()?;
    }
    let diameter = pack.mean_diameter()?;
    let root = options.leaf_over_d * diameter * f64::from(1_u32 << LEVELS);
    let (min, max) = region.corners();
    let roots: f64 = (max - min)
        .iter()
        .map(|extent| (extent / root).max(1.0))
        .product();
    // The condition is false for NaN.
    if !(root > 0.0 && root.is_finite() && roots <= MOST_ROOTS) {
        return Err(AnalysisError::Option {
            name: "leaf_over_d",
            value: options.leaf_over_d,
            allowed: "above zero, finite, and wide enough for at most 5e9 leaves",
        });
    }
    let axes = Axis::grid(&Bounds { min, max }, root)?;
    let mut volumes = vec![0.0; pack.len()];
    let mut at_boundary = vec![false; pack.len()];
    for share in shares(pack, region, &axes).into_iter().flatten() {
        volumes[share.body] += share.volume;
        at_boundary[share.body] |= share.at_boundary;
    }
    let solids = solid_of_bodies(pack, region);
    let counts = |body: usize| match &options.core {
        Some(core) => core.contains(&pack.centroid(body)),
        None => !at_boundary[body],
    };
    let cell = |body: usize| VoronoiCell {
        body: body as u32,
        volume: volumes[body],
        solid: solids[body],
        density: if volumes[body] > 0.0 {
            solids[body] / volumes[body]
        } else {
            0.0
        },
        at_boundary: at_boundary[body],
        counted: volumes[body] > 0.0 && counts(body),
    };
    let cells: Vec<VoronoiCell> = (0..pack.len())
        .filter(|&body| volumes[body] > 0.0 || solids[body] > 0.0)
        .map(cell)
        .collect();
    let counted = || cells.iter().filter(|c| c.counted);
    let place = |c: &VoronoiCell| pack.centroid(c.body as usize);
    let over = options.core.as_ref().unwrap_or(region);
    let blocks = Blocks::over(over, diameter, options.bootstrap)?;
    let mean = blocks.mean(counted().map(|c| (place(c), c.density)));
    let (density, standard_error) = blocks.ratio(counted().map(|c| (place(c), c.solid, c.volume)));
    // Not `sum`, which is -0 where no body counts.
    let squares = counted().fold(0.0, |sum, c| sum + (c.density - mean.mean).powi(2));
    Ok(SetVoronoi {
        region: *region,
        leaf: axes.map(|a| a.step / f64::from(1_u32 << LEVELS)),
        deviation: (squares / (mean.count as f64).max(1.0)).sqrt(),
        density: Estimate {
            mean: density,
            standard_error,
            count: mean.count,
        },
        mean,
        cells,
    })
}

/// The shares of the bodies in each root of the octree.
fn shares(pack: &Pack, region: &Region, axes: &[Axis; 3]) -> Vec<Vec<Share>> {
    let fields = Fields::new(pack);
    let boxes: Vec<Aabb> = (0..pack.len())
        .map(|i| Aabb {
            low: pack.bounds(i).min,
            high: pack.bounds(i).max,
        })
        .collect();
    let tree = Bvh::new(&boxes);
    let octree = Octree {
        fields: &fields,
        region,
        levels: LEVELS,
    };
    let [x, y, _] = axes;
    let count = axes.iter().map(|a| a.count).product();
    ordered_map(
        count,
        <(Memory, Vec<f64>)>::default,
        |(memory, heights), i| {
            let at = [i % x.count, i / x.count % y.count, i / (x.count * y.count)];
            let corner = |step| Point3::from([0, 1, 2].map(|k| axes[k].edge(at[k] + step)));
            let root = Bounds {
                min: corner(0),
                max: corner(1),
            };
            let (centre, half) = root.middle_and_half();
            // Only bodies no farther from the centre than the nearest one plus two radii can own a part.
            let square = |body: u32| {
                let found = fields.distance(heights, body as usize, &centre, f64::INFINITY);
                found.map_or(f64::INFINITY, |(distance, _)| distance.max(0.0).powi(2))
            };
            let nearest = tree.nearest(&centre, square);
            let reach = nearest.map_or(0.0, |(_, square)| square.sqrt()) + 2.0 * half.norm();
            let mut bodies = Vec::new();
            tree.visit(
                |aabb| aabb.distance_squared(&centre) <= reach * reach,
                |body| bodies.push(body as usize),
            );
            octree.share_out(memory, &root, bodies.into_iter())
        },
    )
}

impl Table for SetVoronoi {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "body",
            "volume_m3",
            "solid_m3",
            "density",
            "at_boundary",
            "counted",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.cells.iter().map(|cell| {
            vec![
                cell.body.into(),
                cell.volume.into(),
                cell.solid.into(),
                cell.density.into(),
                u32::from(cell.at_boundary).into(),
                u32::from(cell.counted).into(),
            ]
        }))
    }
}
