//! Nested parts of a region: a bin of a profile is the difference of two successive parts.

use femdem_mesh::Point3;

use crate::region::Region;

/// Which way the parts shrink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Direction {
    /// The floor rises.
    Up,
    /// The side walls draw in.
    Inwards,
}

/// The parts `0..=count` of a region, each inside the one before; the last is empty.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nest {
    region: Region,
    direction: Direction,
    start: f64,
    step: f64,
    pub(super) count: usize,
}

impl Nest {
    /// Parts whose number is whole and whose distance is as near to `width` as possible.
    pub(super) fn new(region: &Region, direction: Direction, width: f64) -> Self {
        let (min, max) = region.corners();
        let (start, extent) = match direction {
            Direction::Up => (min.z, max.z - min.z),
            Direction::Inwards => (0.0, 0.5 * (max.x - min.x).min(max.y - min.y)),
        };
        let count = (extent / width).round().max(1.0);
        Self {
            region: *region,
            direction,
            start,
            step: extent / count,
            count: count as usize,
        }
    }

    /// Where part `k` begins: its height, or its distance from the walls.
    pub(super) fn edge(&self, k: usize) -> f64 {
        self.start + self.step * k as f64
    }

    /// Part `k`; `None` for the last, in which nothing is left.
    pub(super) fn part(&self, k: usize) -> Option<Region> {
        if k >= self.count {
            return None;
        }
        let edge = self.edge(k);
        let mut part = self.region;
        match (&mut part, self.direction) {
            (Region::Box { min, .. }, Direction::Up) => min.z = edge,
            (Region::Cylinder { z_min, .. }, Direction::Up) => *z_min = edge,
            (Region::Box { min, max }, Direction::Inwards) => {
                *min = Point3::new(min.x + edge, min.y + edge, min.z);
                *max = Point3::new(max.x - edge, max.y - edge, max.z);
            }
            (Region::Cylinder { radius, .. }, Direction::Inwards) => *radius -= edge,
            (Region::Sphere { radius, .. }, _) => *radius -= edge,
        }
        Some(part)
    }

    /// Volume of part `k` (m³).
    fn volume(&self, k: usize) -> f64 {
        self.part(k).map_or(0.0, |part| part.volume())
    }

    /// Volume of bin `k` (m³).
    pub(super) fn bin_volume(&self, k: usize) -> f64 {
        self.volume(k) - self.volume(k + 1)
    }

    /// The bin that contains a point, if any.
    pub(super) fn bin_of(&self, point: &Point3) -> Option<usize> {
        let holds = |k: usize| self.part(k).is_some_and(|part| part.contains(point));
        let parts = first(0..self.count, |k| !holds(k));
        parts.checked_sub(1)
    }
}

/// The first of a range for which `is` is true, provided that it is true for all that follow; the range's end
/// if none.
pub(super) fn first(range: std::ops::Range<usize>, is: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (range.start, range.end);
    while low < high {
        let middle = low + (high - low) / 2;
        if is(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}
