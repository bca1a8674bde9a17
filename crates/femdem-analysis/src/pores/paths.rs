//! Shortest paths through the void along z.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use super::grid::VoxelGrid;
use super::image::{VOID, VoxelImage};

/// Geometric tortuosity along z: lengths of shortest paths through the void over the height of the image.
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
/// (Sethian 1996, first order, six neighbours). Paths do not pass between solid voxels that share an edge.
///
/// Straight and plane fronts are exact; around obstacles lengths are too long, by one to one and a half
/// voxels per corner.
pub fn paths(image: &VoxelImage) -> Paths {
    let grid = &image.grid;
    let lengths = march(image);
    let half = 0.5 * grid.spacing[2];
    let straight = grid.spacing[2] * grid.counts[2] as f64;
    let top = grid.len() - grid.layer().min(grid.len());
    let through: Vec<f64> = lengths[top..]
        .iter()
        .filter(|length| length.is_finite())
        .map(|length| (length + half) / straight)
        .collect();
    let void = image.labels.iter().filter(|label| **label == VOID).count();
    let reached = lengths.iter().filter(|length| length.is_finite()).count();
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

fn march(image: &VoxelImage) -> Vec<f64> {
    let grid = &image.grid;
    let mut lengths = vec![f64::INFINITY; grid.len()];
    let mut settled = vec![false; grid.len()];
    // Lengths are not negative, so that their bits are ordered as they are.
    let mut front = BinaryHeap::new();
    let start = 0.5 * grid.spacing[2];
    let lowest = image.labels.iter().enumerate().take(grid.layer());
    for (index, _) in lowest.filter(|(_, label)| **label == VOID) {
        lengths[index] = start;
        front.push(Reverse((start.to_bits(), index)));
    }
    while let Some(Reverse((_, index))) = front.pop() {
        if std::mem::replace(&mut settled[index], true) {
            continue;
        }
        for next in neighbours(grid, index).into_iter().flatten() {
            if settled[next] || image.labels[next] != VOID {
                continue;
            }
            let length = length_at(grid, next, &lengths, &settled);
            if length < lengths[next] {
                lengths[next] = length;
                front.push(Reverse((length.to_bits(), next)));
            }
        }
    }
    lengths
}

/// The neighbours along −x, x, −y, y, −z, z.
fn neighbours(grid: &VoxelGrid, index: usize) -> [Option<usize>; 6] {
    let at = grid.position(index);
    let strides = [1, grid.counts[0], grid.layer()];
    [0, 1, 2, 3, 4, 5].map(|side| {
        let k = side / 2;
        if side % 2 == 0 {
            (at[k] > 0).then(|| index - strides[k])
        } else {
            (at[k] + 1 < grid.counts[k]).then(|| index + strides[k])
        }
    })
}

/// The solution of |∇t| = 1 at a voxel from the settled ones around it.
fn length_at(grid: &VoxelGrid, index: usize, lengths: &[f64], settled: &[bool]) -> f64 {
    let around = neighbours(grid, index);
    let mut from = [0, 1, 2].map(|k| {
        let sides = [around[2 * k], around[2 * k + 1]];
        let nearer = sides
            .into_iter()
            .flatten()
            .filter(|side| settled[*side])
            .map(|side| lengths[side])
            .fold(f64::INFINITY, f64::min);
        (nearer, grid.spacing[k])
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
