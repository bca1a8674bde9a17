//! Periodic space as a batch sees it.

use crate::error::{ContactError, check};
use crate::motion::Motion;
use femdem_mesh::{PeriodicCell, Vector3};
use serde::{Deserialize, Serialize};

/// The periodic cell of a batch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Space {
    pub cell: PeriodicCell,
    /// Length of the path of each edge so far, m.
    pub paths: [f64; 3],
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

    /// Refuses a cell in which a body of `diameter` (m) could meet another one on two sides. `what` is the ratio in words.
    pub fn check_fits(&self, what: &'static str, diameter: f64) -> Result<(), ContactError> {
        let edges = self.cell.edges();
        let axes = (0..3).filter(|&axis| self.cell.repeats(axis) && diameter > 0.0);
        for axis in axes {
            let side = edges[(axis, axis)];
            check(
                what,
                side / diameter,
                side >= PeriodicCell::LEAST_DIAMETERS * diameter,
                "at least 2.25, so that no body meets another one on two sides",
            )?;
        }
        Ok(())
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

/// Forces of the contacts that reach over an edge of the periodic cell on what lies beyond, once for each edge between, N.
/// The edges are driven: as they move, these forces do their work.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct EdgeLoad {
    /// All of it.
    pub total: Vector3,
    /// The part due to normal damping.
    pub damping: Vector3,
    /// The part due to friction.
    pub friction: Vector3,
}

impl EdgeLoad {
    /// Adds what acts on an image of a body to the edges between.
    pub(crate) fn add_over(edges: &mut [Self; 3], image: [i32; 3], on_a: &Self) {
        for (edge, number) in edges.iter_mut().zip(image) {
            let number = f64::from(number);
            edge.total += on_a.total * number;
            edge.damping += on_a.damping * number;
            edge.friction += on_a.friction * number;
        }
    }
}
