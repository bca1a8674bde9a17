//! Pore sizes: the largest ball in the void that covers each voxel.

use serde::{Deserialize, Serialize};

use super::grid::VoxelGrid;
use super::image::{VOID, VoxelImage};
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::table::{Cell, Table};

/// Side of a block of voxels that is passed over as a whole once it is covered.
const BLOCK: usize = 8;

/// Pore diameter (m) of every void voxel: that of the largest ball that fits into the void, has its centre at that
/// of a void voxel, and covers the voxel's centre (local thickness, Hildebrand and Rüegsegger 1997). 0 for others. Balls go on
/// through faces along axes on which the image repeats itself.
///
/// `distances` are those of [`signed_distance`](super::signed_distance) for the same image. Since balls have their
/// centres on the voxels, diameters are too small, by at most the diagonal of a voxel.
///
/// # Errors
/// [`AnalysisError::ListLength`] if there is not one distance per voxel.
pub fn local_thickness(image: &VoxelImage, distances: &[f64]) -> Result<Vec<f64>, AnalysisError> {
    let grid = &image.grid;
    check_length("distances", distances.len(), grid.len())?;
    let mut balls: Vec<(f64, usize)> = image
        .labels
        .iter()
        .zip(distances)
        .enumerate()
        .filter(|(_, (label, distance))| **label == VOID && **distance > 0.0)
        .map(|(index, (_, distance))| (*distance, index))
        .collect();
    // The largest first: the first ball that covers a voxel is its largest.
    balls.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let slabs = grid.counts[2].div_ceil(BLOCK);
    let filled = ordered_map(
        slabs,
        || (),
        |(), slab| {
            let mut slab = Slab::new(image, slab * BLOCK);
            for (radius, index) in &balls {
                if slab.left == 0 {
                    break;
                }
                slab.cover_images(grid.position(*index), *radius);
            }
            slab.diameters
        },
    );
    Ok(filled.concat())
}

/// A few layers of voxels that are being covered.
struct Slab<'a> {
    grid: &'a VoxelGrid,
    repeats: [bool; 3],
    labels: &'a [u32],
    bottom: usize,
    top: usize,
    /// 0 where not covered yet.
    diameters: Vec<f64>,
    /// Void voxels of each block that are not covered yet.
    uncovered: Vec<u32>,
    /// Void voxels of the slab that are not covered yet.
    left: usize,
}

impl<'a> Slab<'a> {
    fn new(image: &'a VoxelImage, bottom: usize) -> Self {
        let grid = &image.grid;
        let top = (bottom + BLOCK).min(grid.counts[2]);
        let labels = &image.labels[bottom * grid.layer()..top * grid.layer()];
        let blocks = [0, 1].map(|k| grid.counts[k].div_ceil(BLOCK));
        let mut uncovered = vec![0; blocks[0] * blocks[1]];
        for (index, label) in labels.iter().enumerate() {
            if *label == VOID {
                let [i, j, _] = grid.position(index);
                uncovered[j / BLOCK * blocks[0] + i / BLOCK] += 1;
            }
        }
        Self {
            grid,
            repeats: image.repeats,
            labels,
            bottom,
            top,
            diameters: vec![0.0; labels.len()],
            left: uncovered.iter().map(|n| *n as usize).sum(),
            uncovered,
        }
    }

    /// Voxels within a distance along axis `k`.
    fn steps(&self, k: usize, distance: f64) -> i64 {
        // To round-off; every voxel is tested by itself.
        (distance / self.grid.spacing[k] + 1e-9).floor() as i64
    }

    /// Voxels along axis `k`, of all, within a distance of a place; the first is not above the last if there is any.
    fn reach(&self, k: usize, centre: i64, distance: f64) -> [usize; 2] {
        let steps = self.steps(k, distance);
        let end = centre
            .saturating_add(steps)
            .min(self.grid.counts[k] as i64 - 1);
        [centre.saturating_sub(steps).max(0), end].map(|at| at as usize)
    }

    /// Covers by a ball about the centre of a voxel and by the images of it.
    fn cover_images(&mut self, centre: [usize; 3], radius: f64) {
        let places = [0, 1, 2].map(|k| {
            let (at, count) = (centre[k] as i64, self.grid.counts[k] as i64);
            if !self.repeats[k] {
                return (at..at + 1).step_by(1);
            }
            let steps = self.steps(k, radius);
            let (below, above) = ((at + steps) / count, (count - 1 - at + steps) / count);
            (at - below * count..at + above * count + 1).step_by(count as usize)
        });
        for z in places[2].clone() {
            for y in places[1].clone() {
                for x in places[0].clone() {
                    self.cover([x, y, z], radius);
                }
            }
        }
    }

    fn cover(&mut self, centre: [i64; 3], radius: f64) {
        let [low, high] = self.reach(2, centre[2], radius);
        let (low, high) = (low.max(self.bottom), (high + 1).min(self.top));
        if low >= high {
            return;
        }
        let along = self.grid.counts[0].div_ceil(BLOCK);
        let [left, right] = self.reach(0, centre[0], radius);
        let [front, back] = self.reach(1, centre[1], radius);
        for v in front / BLOCK..=back / BLOCK {
            for u in left / BLOCK..=right / BLOCK {
                if self.uncovered[v * along + u] > 0 {
                    let x = left.max(u * BLOCK)..(right + 1).min((u + 1) * BLOCK);
                    let y = front.max(v * BLOCK)..(back + 1).min((v + 1) * BLOCK);
                    let covered = self.cover_block(centre, radius, [x, y, low..high]);
                    self.uncovered[v * along + u] -= covered;
                    self.left -= covered as usize;
                }
            }
        }
    }

    /// Covers void voxels of a block; returns how many were not covered before.
    fn cover_block(
        &mut self,
        centre: [i64; 3],
        radius: f64,
        [x, y, z]: [std::ops::Range<usize>; 3],
    ) -> u32 {
        let square =
            |k: usize, at: usize| ((at as i64 - centre[k]) as f64 * self.grid.spacing[k]).powi(2);
        let limit = radius * radius;
        let mut covered = 0;
        for k in z {
            let off = square(2, k);
            for j in y.clone() {
                let off = off + square(1, j);
                if off > limit {
                    continue;
                }
                let row = self.grid.index([0, j, k - self.bottom]);
                for i in x.clone() {
                    let at = row + i;
                    let free = self.diameters[at] == 0.0 && self.labels[at] == VOID;
                    if free && off + square(0, i) <= limit {
                        self.diameters[at] = 2.0 * radius;
                        covered += 1;
                    }
                }
            }
        }
        covered
    }
}

/// A bin of pore diameters.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoreBin {
    /// Smallest diameter (m).
    pub low: f64,
    /// Largest diameter (m); it belongs to the next bin.
    pub high: f64,
    /// Void volume with such diameters (m³).
    pub volume: f64,
    /// The same over all void volume.
    pub share: f64,
    /// Share of the void volume with diameters below `high`.
    pub cumulative: f64,
}

/// Distribution of pore diameters by void volume. As a [`Table`] one row per bin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoreSizes {
    /// Mean diameter (m).
    pub mean: f64,
    /// Diameter (m) that half of the void volume lies below.
    pub median: f64,
    /// Standard deviation of the diameters (m).
    pub deviation: f64,
    /// Largest diameter (m).
    pub largest: f64,
    /// Bins, one smallest side of a voxel wide.
    pub bins: Vec<PoreBin>,
}

impl PoreSizes {
    /// The distribution of the diameters of [`local_thickness`].
    ///
    /// # Errors
    /// [`AnalysisError::ListLength`] if there is not one diameter per voxel, [`AnalysisError::NoVoid`] if there is
    /// no void voxel.
    pub fn new(image: &VoxelImage, diameters: &[f64]) -> Result<Self, AnalysisError> {
        let grid = &image.grid;
        check_length("diameters", diameters.len(), grid.len())?;
        let labelled = image.labels.iter().zip(diameters);
        let mut sizes: Vec<f64> = labelled
            .filter(|(label, _)| **label == VOID)
            .map(|(_, diameter)| *diameter)
            .collect();
        let (Some(_), count) = (sizes.first(), sizes.len() as f64) else {
            return Err(AnalysisError::NoVoid);
        };
        // In this order sums are the same for equal voids in any place.
        sizes.sort_unstable_by(f64::total_cmp);
        let mean = sizes.iter().sum::<f64>() / count;
        let squares: f64 = sizes.iter().map(|d| (d - mean).powi(2)).sum();
        let largest = sizes[sizes.len() - 1];
        let width = grid.spacing.into_iter().fold(f64::INFINITY, f64::min);
        let bins = (largest / width).floor() as usize + 1;
        let mut counted = 0;
        let bin = |b: usize| {
            let high = (b + 1) as f64 * width;
            let below = if b + 1 == bins {
                sizes.len()
            } else {
                sizes.partition_point(|d| *d < high)
            };
            let inside = below - counted;
            counted = below;
            PoreBin {
                low: b as f64 * width,
                high,
                volume: inside as f64 * grid.voxel_volume(),
                share: inside as f64 / count,
                cumulative: below as f64 / count,
            }
        };
        Ok(Self {
            mean,
            median: sizes[sizes.len() / 2],
            deviation: (squares / count).sqrt(),
            largest,
            bins: (0..bins).map(bin).collect(),
        })
    }
}

impl Table for PoreSizes {
    fn columns(&self) -> &'static [&'static str] {
        &["low_m", "high_m", "volume_m3", "share", "cumulative"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.bins.iter().map(|b| {
            let numbers = [b.low, b.high, b.volume, b.share, b.cumulative];
            numbers.map(Cell::from).to_vec()
        }))
    }
}

/// Refuses a list that does not have one value per voxel.
pub(super) fn check_length(
    name: &'static str,
    given: usize,
    voxels: usize,
) -> Result<(), AnalysisError> {
    if given == voxels {
        return Ok(());
    }
    Err(AnalysisError::ListLength {
        name,
        given,
        voxels,
    })
}
