//! Shortest paths through the void along z.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use super::image::{VOID, VoxelImage};

/// Copies of an image that repeats itself along z, one upon another, that paths are looked for in.
const PERIODS: usize = 3;

/// Geometric tortuosity along z: lengths of shortest paths through the void over the height of the image.
///
/// Where the image repeats itself along z, a path is that through the second period, from top to top, of those that begin at the lower
/// end of the first. Where paths still change from period to period, it depends on where the cell begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tortuosity {
    /// Height of the image: the straight length (m).
    pub straight: f64,
    /// Shortest path between the two ends over the straight length. `None` if none goes through, like the next
    /// three.
    pub shortest: Option<f64>,
    /// Mean over the void voxels at the upper end, each with its shortest path from the lower end.
    pub mean: Option<f64>,
    /// Standard deviation of the same.
    pub deviation: Option<f64>,
    /// The largest of the same.
    pub longest: Option<f64>,
    /// Share of the void voxels that can be reached from the lower end.
    pub connected: f64,
}

/// Shortest paths from the lower end of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Paths {
    /// Length of the shortest path from the lower end to the centre of each voxel (m); infinite where none leads.
    pub lengths: Vec<f64>,
    /// What they amount to.
    pub tortuosity: Tortuosity,
}

/// Shortest paths through void voxels from the lower end plane (all of its void voxels) upwards, by fast marching
/// (Sethian 1996, first order, six neighbours). Paths do not pass between solid voxels that share an edge. They go on through
/// the sides along axes on which the image repeats itself.
///
/// Straight and plane fronts are exact; around obstacles lengths are too long, by one to one and a half
/// voxels per corner.
pub fn paths(image: &VoxelImage) -> Paths {
    let grid = &image.grid;
    let periods = if image.repeats[2] { PERIODS } else { 1 };
    let mut lengths = March { image, periods }.lengths();
    let half = 0.5 * grid.spacing[2];
    let straight = grid.spacing[2] * grid.counts[2] as f64;
    let top = grid.len() - grid.layer().min(grid.len());
    // The middle period, if there are several: both ends are equally far.
    let middle = periods / 2 * grid.len();
    let through: Vec<f64> = (top..grid.len())
        .filter(|&at| lengths[middle + at].is_finite())
        .map(|at| match middle {
            0 => lengths[at] + half,
            _ => lengths[middle + at] - lengths[at],
        })
        .map(|length| length / straight)
        .collect();
    let void = image.labels.iter().filter(|label| **label == VOID).count();
    let of_middle = &lengths[middle..middle + grid.len()];
    let reached = of_middle.iter().filter(|length| length.is_finite()).count();
    lengths.truncate(grid.len());
    let count = through.len() as f64;
    let some = |value: f64| (!through.is_empty()).then_some(value);
    let mean = through.iter().sum::<f64>() / count;
    let squares: f64 = through.iter().map(|t| (t - mean).powi(2)).sum();
    let tortuosity = Tortuosity {
        straight,
        shortest: some(through.iter().copied().fold(f64::INFINITY, f64::min)),
        mean: some(mean),
        deviation: some((squares / count).sqrt()),
        longest: some(through.iter().copied().fold(0.0, f64::max)),
        connected: reached as f64 / void.max(1) as f64,
    };
    Paths {
        lengths,
        tortuosity,
    }
}

/// Fast marching through copies of an image, one upon another.
struct March<'a> {
    image: &'a VoxelImage,
    periods: usize,
}

impl March<'_> {
    fn is_void(&self, index: usize) -> bool {
        self.image.labels[index % self.image.labels.len()] == VOID
    }

    fn lengths(&self) -> Vec<f64> {
        let grid = &self.image.grid;
        let mut lengths = vec![f64::INFINITY; self.periods * grid.len()];
        let mut settled = vec![false; lengths.len()];
        // Lengths are not negative, so that their bits are ordered as they are.
        let mut front = BinaryHeap::new();
        let start = 0.5 * grid.spacing[2];
        for index in (0..grid.layer().min(grid.len())).filter(|&index| self.is_void(index)) {
            lengths[index] = start;
            front.push(Reverse((start.to_bits(), index)));
        }
        while let Some(Reverse((_, index))) = front.pop() {
            if std::mem::replace(&mut settled[index], true) {
                continue;
            }
            for next in self.neighbours(index).into_iter().flatten() {
                if settled[next] || !self.is_void(next) {
                    continue;
                }
                let length = self.length_at(next, &lengths, &settled);
                if length < lengths[next] {
                    lengths[next] = length;
                    front.push(Reverse((length.to_bits(), next)));
                }
            }
        }
        lengths
    }

    /// The neighbours along −x, x, −y, y, −z, z.
    fn neighbours(&self, index: usize) -> [Option<usize>; 6] {
        let [nx, ny, nz] = self.image.grid.counts;
        let counts = [nx, ny, nz * self.periods];
        let at = [index % nx, index / nx % ny, index / (nx * ny)];
        let strides = [1, nx, nx * ny];
        // Copies along z have ends.
        let repeats = [self.image.repeats[0], self.image.repeats[1], false];
        [0, 1, 2, 3, 4, 5].map(|side| {
            let k = side / 2;
            let around = (counts[k] - 1) * strides[k];
            if side % 2 == 0 {
                match at[k] {
                    0 => repeats[k].then_some(index + around),
                    _ => Some(index - strides[k]),
                }
            } else if at[k] + 1 < counts[k] {
                Some(index + strides[k])
            } else {
                repeats[k].then_some(index - around)
            }
        })
    }

    /// The solution of |∇t| = 1 at a voxel from the settled ones around it.
    fn length_at(&self, index: usize, lengths: &[f64], settled: &[bool]) -> f64 {
        let around = self.neighbours(index);
        let mut from = [0, 1, 2].map(|k| {
            let sides = [around[2 * k], around[2 * k + 1]];
            let nearer = sides
                .into_iter()
                .flatten()
                .filter(|side| settled[*side])
                .map(|side| lengths[side])
                .fold(f64::INFINITY, f64::min);
            (nearer, self.image.grid.spacing[k])
        });
        from.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        // Sum over the axes of ((t - a) / h)² = 1, with as many axes as lie behind the front.
        let (mut sum, mut linear, mut square) = (0.0, 0.0, -1.0);
        let mut length = f64::INFINITY;
        let base = from[0].0;
        for (a, h) in from {
            if a >= length || a == f64::INFINITY {
                break;
            }
            let weight = 1.0 / (h * h);
            let a = a - base;
            sum += weight;
            linear += weight * a;
            square += weight * a * a;
            let root = (linear * linear - sum * square).max(0.0).sqrt();
            length = base + (linear + root) / sum;
        }
        length
    }
}
