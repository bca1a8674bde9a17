//! The voxel image of a region of a pack.

use serde::{Deserialize, Serialize};

use super::grid::VoxelGrid;
use super::solids::Solids;
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::region::{NOT_UPRIGHT, Region};
use crate::rows::{RowScratch, cells_in_region, spans_of_body};

/// Label of a void voxel.
pub const VOID: u32 = 0;

/// Label of a voxel outside a round region.
pub const OUTSIDE: u32 = u32::MAX;

/// Largest number of voxels.
const MOST_VOXELS: f64 = 1e9;

/// A voxel image: what lies at the centre of every voxel.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelImage {
    /// The region; the voxels fill the smallest box around it.
    pub region: Region,
    /// The voxels.
    pub grid: VoxelGrid,
    /// Axes along which the image repeats itself: [`Pack::repeats_over`](crate::Pack::repeats_over) of the region.
    pub repeats: [bool; 3],
    /// For each voxel [`VOID`], the number of the body plus one (the first where bodies overlap), or [`OUTSIDE`]. An image of a
    /// body has the number of the body.
    pub labels: Vec<u32>,
}

/// Numbers of voxels of a [`VoxelImage`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct VoxelCounts {
    /// Void voxels.
    pub void: u64,
    /// Voxels in bodies.
    pub solid: u64,
    /// Voxels outside the region.
    pub outside: u64,
}

impl VoxelCounts {
    /// Share of the void voxels among those in the region; 1 without any.
    pub fn porosity(&self) -> f64 {
        let inside = self.void + self.solid;
        if inside == 0 {
            return 1.0;
        }
        self.void as f64 / inside as f64
    }
}

impl VoxelImage {
    /// Voxels of each kind.
    pub fn counts(&self) -> VoxelCounts {
        let mut counts = VoxelCounts {
            void: 0,
            solid: 0,
            outside: 0,
        };
        for label in &self.labels {
            match *label {
                VOID => counts.void += 1,
                OUTSIDE => counts.outside += 1,
                _ => counts.solid += 1,
            }
        }
        counts
    }
}

/// The voxel image of a box or an upright cylinder, with voxels of sides near `voxel` (m): each side is changed so
/// that a whole number fills the region along that axis. A voxel is what its centre lies in, decided by the shape
/// of the body itself.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, Region};
/// use femdem_analysis::pores::{Solids, voxel_image};
/// use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
///
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?]; // side 1 m
/// let body = [PosedBody { shape: 0, pose: Pose::translation(0.5, 0.5, 0.5) }];
/// let pack = Pack::new(&cube, &body)?;
/// let region = Region::Box { min: Point3::origin(), max: Point3::new(2.0, 1.0, 1.0) };
/// let image = voxel_image(&Solids::new(&pack), &region, 0.1)?;
/// assert_eq!(image.counts().porosity(), 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a ball,
/// [`AnalysisError::Option`] for a voxel that is not above zero and finite, or of which there would be more than
/// 1e9, [`AnalysisError::TooManyBodies`], [`AnalysisError::TiltedCell`].
pub fn voxel_image(
    solids: &Solids,
    region: &Region,
    voxel: f64,
) -> Result<VoxelImage, AnalysisError> {
    region.validate()?;
    if matches!(region, Region::Sphere { .. }) {
        return Err(NOT_UPRIGHT);
    }
    let pack = solids.pack();
    if pack.is_empty() {
        return Err(AnalysisError::EmptyPack);
    }
    // Two labels are no bodies.
    if pack.len() >= OUTSIDE as usize {
        return Err(AnalysisError::TooManyBodies { bodies: pack.len() });
    }
    let repeats = pack.repeats_over(region)?;
    let (min, max) = region.corners();
    let cells: f64 = (max - min).iter().map(|x| (x / voxel).max(1.0)).product();
    // The condition is false for NaN.
    if !(voxel > 0.0 && voxel.is_finite() && cells <= MOST_VOXELS) {
        return Err(AnalysisError::Option {
            name: "voxel",
            value: voxel,
            allowed: "above zero, finite, and wide enough for at most 1000000000 voxels (m)",
        });
    }
    let axes = Axis::grid(&Bounds { min, max }, voxel)?;
    let [x_axis, y_axis, z_axis] = &axes;
    let mut bodies = vec![Vec::new(); z_axis.count];
    let mut order: Vec<usize> = (0..pack.len()).collect();
    order.sort_by_key(|&body| pack.source(body));
    for body in order {
        let bounds = solids.bounds(body);
        for list in &mut bodies[z_axis.within(bounds.min.z, bounds.max.z)] {
            list.push(body);
        }
    }
    let layers = ordered_map(z_axis.count, RowScratch::default, |scratch, k| {
        let z = z_axis.centre(k);
        let mut layer = vec![VOID; x_axis.count * y_axis.count];
        for &body in &bodies[k] {
            let label = pack.source(body) as u32 + 1;
            let mut fill = |row: usize, low: f64, high: f64| {
                let cells = x_axis.within(low, high);
                let start = row * x_axis.count;
                for cell in &mut layer[start + cells.start..start + cells.end] {
                    if *cell == VOID {
                        *cell = label;
                    }
                }
            };
            if let Some(radius) = solids.ball(body) {
                let centre = solids.centroid(body);
                let bounds = solids.bounds(body);
                for row in y_axis.within(bounds.min.y, bounds.max.y) {
                    let off = (y_axis.centre(row) - centre.y).powi(2) + (z - centre.z).powi(2);
                    let square = radius * radius - off;
                    if square >= 0.0 {
                        fill(row, centre.x - square.sqrt(), centre.x + square.sqrt());
                    }
                }
            } else {
                spans_of_body(scratch, pack, body, y_axis, z, fill);
            }
        }
        for (j, row) in layer.chunks_exact_mut(x_axis.count).enumerate() {
            let inside = cells_in_region(region, x_axis, y_axis.centre(j), z);
            row[..inside.start].fill(OUTSIDE);
            row[inside.end..].fill(OUTSIDE);
        }
        layer
    });
    Ok(VoxelImage {
        region: *region,
        repeats,
        grid: VoxelGrid {
            origin: min,
            spacing: axes.map(|a| a.step),
            counts: axes.map(|a| a.count),
        },
        labels: layers.concat(),
    })
}
