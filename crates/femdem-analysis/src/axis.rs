//! Regular cells along an axis.

use std::ops::Range;

use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::pack::Pack;

/// Largest number of cells along one axis, in one layer and in all.
const MOST: [f64; 3] = [65_536.0, 134_217_728.0, 4_294_967_296.0];

/// Cells of equal width along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    pub(crate) step: f64,
    pub(crate) count: usize,
}

impl Axis {
    /// Cuts `low..high` into a whole number of cells, of width as near to `spacing` as possible.
    fn new(low: f64, high: f64, spacing: f64) -> Self {
        let count = cells_along(low, high, spacing);
        Self {
            low,
            step: (high - low) / count,
            count: count as usize,
        }
    }

    /// Cells over a box; an error if they would be too many.
    pub(crate) fn grid(bounds: &Bounds, spacing: f64) -> Result<[Self; 3], AnalysisError> {
        let counts = [0, 1, 2].map(|k| cells_along(bounds.min[k], bounds.max[k], spacing));
        let layer = counts[0] * counts[1];
        let cells = layer * counts[2];
        // The condition is false for NaN.
        let fits = counts.iter().all(|n| *n <= MOST[0]) && layer <= MOST[1] && cells <= MOST[2];
        if !fits {
            return Err(AnalysisError::GridTooFine { cells, layer });
        }
        Ok([0, 1, 2].map(|k| Self::new(bounds.min[k], bounds.max[k], spacing)))
    }

    /// Centre of cell `i`.
    pub(crate) fn centre(&self, i: usize) -> f64 {
        self.low + (i as f64 + 0.5) * self.step
    }

    /// Where cell `i` begins, and the one before it ends.
    pub(crate) fn edge(&self, i: usize) -> f64 {
        self.low + i as f64 * self.step
    }

    /// The cells that overlap `low..=high`, to round-off.
    pub(crate) fn meeting(&self, low: f64, high: f64) -> Range<usize> {
        // Conversion to usize saturates: what lies before the first cell becomes 0.
        let first = ((low - self.low) / self.step).floor() as usize;
        let end = ((high - self.low) / self.step).ceil() as usize;
        let end = end.min(self.count);
        first.min(end)..end
    }

    /// The cells whose centre lies in `low..=high`.
    pub(crate) fn within(&self, low: f64, high: f64) -> Range<usize> {
        // Conversion to usize saturates: what lies before the first cell becomes 0.
        let first = ((low - self.low) / self.step - 0.5).ceil() as usize;
        let end = ((high - self.low) / self.step + 0.5).floor() as usize;
        let end = end.min(self.count);
        first.min(end)..end
    }

    /// The cells whose centre lies in `low..=high`, and possibly one more on either side: none is missed by
    /// round-off.
    pub(crate) fn near(&self, low: f64, high: f64) -> Range<usize> {
        self.within(low - 0.5 * self.step, high + 0.5 * self.step)
    }

    /// For each cell of axis `k` the bodies whose box contains its centre, ascending.
    pub(crate) fn sort_bodies(&self, k: usize, pack: &Pack) -> Vec<Vec<usize>> {
        let mut sorted = vec![Vec::new(); self.count];
        for body in 0..pack.len() {
            let bounds = pack.bounds(body);
            for list in &mut sorted[self.within(bounds.min[k], bounds.max[k])] {
                list.push(body);
            }
        }
        sorted
    }
}

fn cells_along(low: f64, high: f64, spacing: f64) -> f64 {
    ((high - low) / spacing).round().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_between_two_values_are_those_whose_centre_is() {
        let axis = Axis::new(1.0, 3.0, 0.27);
        assert_eq!(axis.count, 7);
        let values: Vec<f64> = (0..60).map(|i| 0.5 + 0.05 * f64::from(i)).collect();
        for &low in &values {
            for &high in &values {
                let listed: Vec<usize> = axis.within(low, high).collect();
                let brute: Vec<usize> = (0..7)
                    .filter(|&i| low <= axis.centre(i) && axis.centre(i) <= high)
                    .collect();
                assert_eq!(listed, brute, "{low}..{high}");
            }
        }
    }
}
