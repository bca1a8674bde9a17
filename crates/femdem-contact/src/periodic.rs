//! Periodic space as a batch sees it.

use crate::motion::Motion;
use femdem_mesh::{PeriodicCell, Vector3};
use serde::{Deserialize, Serialize};

/// The periodic cell of a batch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Space {
    pub cell: PeriodicCell,
    /// Length of the path of each edge so far, m.
    paths: [f64; 3],
    /// How much space was strained so far, to and fro.
    pub strain: f64,
}

impl Space {
    pub fn new(cell: PeriodicCell) -> Self {
        Self {
            cell,
            paths: [0.0; 3],
            strain: 0.0,
        }
    }

    /// The cell has changed.
    pub fn change(&mut self, cell: PeriodicCell) {
        let moved = cell.edges() - self.cell.edges();
        for (k, path) in self.paths.iter_mut().enumerate() {
            *path += moved.column(k).norm();
        }
        let change = moved * self.cell.inverse_edges();
        self.strain += change.norm();
        self.cell = cell;
    }

    /// How far the edges that lead to an image have carried it at most, m.
    pub fn path(&self, image: [i32; 3]) -> f64 {
        let paths = image
            .iter()
            .zip(self.paths)
            .map(|(&n, path)| f64::from(n).abs() * path);
        paths.sum()
    }

    /// Calls `f` with the way to each image of a point of the cell, its own place included, whose surroundings of the
    /// half-width `span` (m) meet the cell.
    pub fn beside(&self, point: &Vector3, span: f64, f: impl FnMut(&Vector3)) {
        self.cell.images(point, span).iter().for_each(f);
    }

    /// The image of A that B meets, as it moves.
    pub fn image(&self, a: &Motion, b: &Motion) -> (Motion, [i32; 3]) {
        let image = self
            .cell
            .minimum_image(&(b.frame.position - a.frame.position));
        let mut seen = *a;
        if image != [0; 3] {
            seen.frame.position += self.cell.offset(image);
            seen.velocity += self.cell.velocity_of(image);
            seen.travelled += self.path(image);
        }
        (seen, image)
    }
}
