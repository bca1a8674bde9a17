//! Joining vertices at the same place.

use super::clean::Surface;
use crate::Point3;
use std::collections::BTreeMap;

/// Side of the cells into which points are sorted, in welding distances: few points lie so near the border of
/// their cell that a neighbouring cell must be searched.
const CELL: f64 = 4.0;

impl Surface {
    /// Joins each vertex to the first one within `distance` \[m\], or of equal coordinates if that is 0;
    /// removes corners that then repeat the one before in a loop. Returns the number of vertices joined.
    pub(super) fn weld(&mut self, distance: f64) -> usize {
        let mut to = equal(&self.points);
        if distance > 0.0 {
            let mut cells = Cells::new(&self.points, distance);
            for i in 0..to.len() {
                // Copies are mapped as the first of their kind, which comes before them.
                to[i] = match to[i] as usize {
                    first if first == i => cells.first_near(i as u32),
                    first => to[first],
                };
            }
        }
        for corners in &mut self.loops {
            for v in corners.iter_mut() {
                *v = to[*v as usize];
            }
            corners.dedup();
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
        }
        self.compact()
    }
}

/// For each point the first of equal coordinates.
fn equal(points: &[Point3]) -> Vec<u32> {
    // Adding zero turns -0.0 into 0.0.
    let key = |i: u32| {
        points[i as usize]
            .coords
            .map(|x| (x + 0.0).to_bits())
            .into()
    };
    let mut sorted: Vec<([u64; 3], u32)> = (0..points.len() as u32).map(|i| (key(i), i)).collect();
    sorted.sort_unstable();
    let mut to = vec![0; points.len()];
    for same in sorted.chunk_by(|a, b| a.0 == b.0) {
        for &(_, i) in same {
            to[i as usize] = same[0].1;
        }
    }
    to
}

/// Kept points, by cell. They are farther than the distance from each other, so that a cell holds a few dozen
/// at most.
struct Cells<'a> {
    points: &'a [Point3],
    low: Point3,
    distance: f64,
    kept: BTreeMap<[i64; 3], Vec<u32>>,
}

impl<'a> Cells<'a> {
    fn new(points: &'a [Point3], distance: f64) -> Self {
        let first = points.first().copied().unwrap_or_default();
        Self {
            points,
            low: points.iter().fold(first, |low, p| low.inf(p)),
            distance,
            kept: BTreeMap::new(),
        }
    }

    /// The first kept point within the distance of point `i`; if there is none, the point itself, which is then
    /// kept.
    fn first_near(&mut self, i: u32) -> u32 {
        let p = self.points[i as usize];
        let place = (p - self.low) / (CELL * self.distance);
        let margin = 1.0 / CELL;
        let range = |k: usize| {
            let (from, to) = (place[k] - margin, place[k] + margin);
            (from.floor() as i64)..=(to.floor() as i64)
        };
        let mut nearest: Option<u32> = None;
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    let there = self.kept.get(&[x, y, z]).map_or(&[][..], |v| v);
                    let near = there
                        .iter()
                        .copied()
                        .filter(|&j| (self.points[j as usize] - p).norm() <= self.distance);
                    nearest = near.chain(nearest).min();
                }
            }
        }
        nearest.unwrap_or_else(|| {
            let cell = [0, 1, 2].map(|k| place[k].floor() as i64);
            self.kept.entry(cell).or_default().push(i);
            i
        })
    }
}
