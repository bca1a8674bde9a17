//! Magnitude of the strain of blocks.

use super::super::lanes::{LANES, Lanes, Row, cross, dot};
use super::energy::edges;
use super::{Block, Reference, Task};
use femdem_mesh::Vector3;

/// Collects |F^T F - I|^2 of all elements; NaN where one of a block is inverted.
pub(super) struct Strains<'a> {
    pub blocks: &'a [Block],
    pub references: &'a [Reference],
    pub x: &'a [Vector3],
}

impl Task for Strains<'_> {
    type Output = Vec<Row>;

    #[inline(always)]
    fn run<S: Lanes>(self, l: S) -> Vec<Row> {
        let mut rows = Vec::with_capacity(self.blocks.len());
        for (block, reference) in self.blocks.iter().zip(self.references) {
            let edges = edges(block, self.x);
            let [a, b, c] = [
                reference.column(l, &edges, 0),
                reference.column(l, &edges, 1),
                reference.column(l, &edges, 2),
            ];
            let one = l.all(1.0);
            let along = [
                l.sub(dot(l, &a, &a), one),
                l.sub(dot(l, &b, &b), one),
                l.sub(dot(l, &c, &c), one),
            ];
            let across = [dot(l, &b, &c), dot(l, &a, &c), dot(l, &a, &b)];
            let twice = l.mul(l.all(2.0), dot(l, &across, &across));
            let sound = l.all_within(dot(l, &a, &cross(l, &b, &c)), 0.0, f64::INFINITY);
            rows.push(if sound {
                l.store(l.add(dot(l, &along, &along), twice))
            } else {
                Row([f64::NAN; LANES])
            });
        }
        rows
    }
}
