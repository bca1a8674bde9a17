//! The signed distance of every voxel from the solids.

use super::image::{OUTSIDE, VOID, VoxelImage, voxel_image};
use super::solids::{Sides, Solids, side_distance};
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::region::Region;
use femdem_mesh::{Point3, Vector3};

/// Side of a block of voxels that share a list of near bodies.
const BLOCK: usize = 4;

/// Parts of a voxel along x, y, z by which a point is moved off the planes that voxels and their halves share.
const OFF_PLANES: [f64; 3] = [0.123, 0.217, 0.319];

/// Largest part of the distance from all surfaces that a point is moved by.
const MOST_MOVED: f64 = 0.5;

/// Signed distance (m) of the centre of every voxel from the nearest solid, negative inside: see
/// [`Solids::signed_distance`]. Bodies beyond the region count, too. Walls at the sides of the region count as
/// solids, its ends do not, nor do sides along axes on which the image repeats itself. Voxels outside a round region have minus their distance from its side.
///
/// Exact to round-off: distances are measured from the surfaces of the bodies, not from voxels. In [periodic
/// space](crate::WithImages) this needs all images within the largest of the distances.
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
                    side_distance(&image.region, image.repeats, &point)
                } else {
                    if !listed {
                        solids.near(&(first + half), half.norm(), near);
                        listed = true;
                    }
                    let of_bodies = solids.least(&point, near);
                    match sides {
                        Sides::Wall => {
                            let of_sides = side_distance(&image.region, image.repeats, &point);
                            of_bodies.min(of_sides)
                        }
                        Sides::Open => of_bodies,
                    }
                };
                slab[index - offset] = distance;
            }
        }
    }
}

/// How far from the box around a region the images of bodies count (m), found from those near it with voxels of sides near `voxel`
/// (m): no point of the box is farther from the nearest body, and what is nearer than `gap` (m) to a body that reaches into the region
/// is not farther.
///
/// # Errors
/// As [`voxel_image`].
pub fn images_reach(
    solids: &Solids,
    region: &Region,
    voxel: f64,
    gap: f64,
) -> Result<f64, AnalysisError> {
    let (min, max) = region.corners();
    let image = voxel_image(solids, &Region::Box { min, max }, voxel)?;
    // A distance changes by no more than its point moves.
    let half = 0.5 * Vector3::from(image.grid.spacing).norm();
    let distances = signed_distance(solids, &image, Sides::Open);
    let farthest = half + distances.into_iter().fold(0.0, f64::max);
    let radii = solids.pack().shapes().iter().map(|s| s.bounding_radius());
    Ok(farthest.max(2.0 * radii.fold(0.0, f64::max) + gap))
}

/// A point in the void to start a mesh from. `None` without a void voxel.
///
/// It lies near the centre of the void voxel that is farthest from solids, from the sides and from the ends of the
/// region, the first of equal ones: less than half a voxel off it along each axis, so that it is not in the faces of
/// cells that are as wide as voxels, and at most half of that distance away.
///
/// `distances` are those of [`signed_distance`]; without one per voxel there is no such point, either.
pub fn deepest_void(image: &VoxelImage, distances: &[f64]) -> Option<Point3> {
    let (low, high) = image.region.corners();
    let mut deepest: Option<(f64, Point3)> = None;
    for ((index, label), distance) in image.labels.iter().enumerate().zip(distances) {
        let point = image.grid.centre(image.grid.position(index));
        let ends = (point.z - low.z).min(high.z - point.z);
        let of_sides = side_distance(&image.region, [false; 3], &point);
        let depth = distance.min(of_sides).min(ends);
        if *label == VOID && deepest.is_none_or(|(most, _)| depth > most) {
            deepest = Some((depth, point));
        }
    }
    let (depth, centre) = deepest?;
    let off = Vector3::from([0, 1, 2].map(|k| OFF_PLANES[k] * image.grid.spacing[k]));
    let part = (MOST_MOVED * depth.max(0.0) / off.norm()).min(1.0);
    Some(centre + off * part)
}

#[cfg(test)]
mod tests {
    use femdem_mesh::Pose;
    use femdem_mesh::catalogue::CatalogueShape;

    use super::*;
    use crate::pack::{Pack, PosedBody};

    /// Over a cube of 1 m, in a wide void and in one of less than two voxels.
    #[test]
    fn a_mesh_starts_in_the_void_and_off_the_planes() {
        let cube: CatalogueShape = "P5".parse().unwrap();
        let shapes = [cube.polyhedron(3_f64.sqrt()).unwrap()];
        let body = [PosedBody {
            shape: 0,
            pose: Pose::translation(0.5, 0.5, 0.5),
        }];
        let pack = Pack::new(&shapes, &body).unwrap();
        let solids = Solids::new(&pack);
        for height in [1.2, 1.02] {
            let region = Region::Box {
                min: Point3::origin(),
                max: Point3::new(0.12, 0.12, height),
            };
            let image = voxel_image(&solids, &region, 0.012).unwrap();
            let distances = signed_distance(&solids, &image, Sides::Open);
            let point = deepest_void(&image, &distances).unwrap();
            assert!(solids.signed_distance(&point) > 0.005 && region.contains(&point));
            for k in 0..3 {
                let halves = 2.0 * (point[k] - image.grid.origin[k]) / image.grid.spacing[k];
                assert!((halves - halves.round()).abs() > 0.1, "{point}");
            }
        }
    }
}
