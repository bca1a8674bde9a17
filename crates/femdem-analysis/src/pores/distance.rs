//! The signed distance of every voxel from the solids.

use super::image::{OUTSIDE, VOID, VoxelImage};
use super::solids::{Sides, Solids, side_distance};
use crate::ordered::ordered_map;
use femdem_mesh::{Point3, Vector3};

/// Side of a block of voxels that share a list of near bodies.
const BLOCK: usize = 4;

/// Signed distance (m) of the centre of every voxel from the nearest solid, negative inside: see
/// [`Solids::signed_distance`]. Bodies beyond the region count, too. Walls at the sides of the region count as
/// solids, its ends do not. Voxels outside a round region have minus their distance from its side.
///
/// Exact to round-off: distances are measured from the surfaces of the bodies, not from voxels.
pub fn signed_distance(solids: &Solids, image: &VoxelImage, sides: Sides) -> Vec<f64> {
    let grid = &image.grid;
    let slabs = grid.counts[2].div_ceil(BLOCK);
    let filled = ordered_map(slabs, Vec::new, |near, slab| {
        let bottom = slab * BLOCK;
        let top = (bottom + BLOCK).min(grid.counts[2]);
        let mut distances = vec![0.0; (top - bottom) * grid.layer()];
        for j in (0..grid.counts[1]).step_by(BLOCK) {
            for i in (0..grid.counts[0]).step_by(BLOCK) {
                let low = [i, j, bottom];
                let high = [
                    (i + BLOCK).min(grid.counts[0]),
                    (j + BLOCK).min(grid.counts[1]),
                    top,
                ];
                block(solids, image, sides, near, [low, high], &mut distances);
            }
        }
        distances
    });
    filled.concat()
}

/// Fills one block of a slab that begins with the block's lowest layer.
fn block(
    solids: &Solids,
    image: &VoxelImage,
    sides: Sides,
    near: &mut Vec<(f64, usize)>,
    [low, high]: [[usize; 3]; 2],
    slab: &mut [f64],
) {
    let grid = &image.grid;
    let first = grid.centre(low);
    let last = grid.centre(high.map(|n| n - 1));
    let half: Vector3 = (last - first) * 0.5;
    let mut listed = false;
    let offset = low[2] * grid.layer();
    for k in low[2]..high[2] {
        for j in low[1]..high[1] {
            for i in low[0]..high[0] {
                let index = grid.index([i, j, k]);
                let point = grid.centre([i, j, k]);
                let distance = if image.labels[index] == OUTSIDE {
                    side_distance(&image.region, &point)
                } else {
                    if !listed {
                        solids.near(&(first + half), half.norm(), near);
                        listed = true;
                    }
                    let of_bodies = solids.least(&point, near);
                    match sides {
                        Sides::Wall => of_bodies.min(side_distance(&image.region, &point)),
                        Sides::Open => of_bodies,
                    }
                };
                slab[index - offset] = distance;
            }
        }
    }
}

/// The centre of the void voxel that is farthest from solids, from the sides and from the ends of the region, the
/// first of equal ones: a point to start a mesh of the void from. `None` without a void voxel.
///
/// `distances` are those of [`signed_distance`]; without one per voxel there is no such point, either.
pub fn deepest_void(image: &VoxelImage, distances: &[f64]) -> Option<Point3> {
    let (low, high) = image.region.corners();
    let mut deepest: Option<(f64, Point3)> = None;
    for ((index, label), distance) in image.labels.iter().enumerate().zip(distances) {
        let point = image.grid.centre(image.grid.position(index));
        let ends = (point.z - low.z).min(high.z - point.z);
        let depth = distance.min(side_distance(&image.region, &point)).min(ends);
        if *label == VOID && deepest.is_none_or(|(most, _)| depth > most) {
            deepest = Some((depth, point));
        }
    }
    deepest.map(|(_, point)| point)
}
