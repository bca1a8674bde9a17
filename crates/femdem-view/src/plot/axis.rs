//! An axis: a range, its round numbers, and its label.

use crate::output::short_number;
use crate::ticks::{decades, even};

/// Share of the range that is left free at an end that data touch.
const MARGIN: f64 = 0.04;

/// One axis of a chart.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    /// Quantity and unit, such as "height / m".
    pub label: String,
    low: f64,
    high: f64,
    log: bool,
    whole: bool,
    classes: Vec<String>,
}

impl Axis {
    /// From `low` to `high`, evenly.
    pub fn linear(label: &str, low: f64, high: f64) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Self {
            label: label.to_owned(),
            low,
            high,
            log: false,
            whole: false,
            classes: Vec::new(),
        }
    }

    /// From 0 to a little above the largest of `values`.
    pub fn from_zero(label: &str, values: impl Iterator<Item = f64>) -> Self {
        let most = values.filter(|v| v.is_finite()).fold(0.0, f64::max);
        Self::linear(label, 0.0, most * (1.0 + MARGIN))
    }

    /// Whole numbers with half of one free at both ends.
    pub fn whole(label: &str, low: f64, high: f64) -> Self {
        Self {
            whole: true,
            ..Self::linear(label, low - 0.5, high + 0.5)
        }
    }

    /// One place for each name, from 0.
    pub fn classes(label: &str, names: &[&str]) -> Self {
        let classes = names.iter().map(|&name| name.to_owned()).collect();
        Self {
            classes,
            ..Self::whole(label, 0.0, names.len().saturating_sub(1) as f64)
        }
    }

    /// Text at a tick: the number, or the name in its place.
    pub fn text(&self, tick: f64) -> String {
        let number = || short_number(tick).replace('-', "\u{2212}");
        if self.classes.is_empty() {
            return number();
        }
        self.classes
            .get(tick.round().max(0.0) as usize)
            .cloned()
            .unwrap_or_else(number)
    }

    /// By the logarithm, around the positive ones of `values`.
    pub fn log(label: &str, values: impl Iterator<Item = f64>) -> Self {
        let range = values
            .filter(|v| v.is_finite() && *v > 0.0)
            .fold(None, |range, v| {
                let (low, high): (f64, f64) = range.unwrap_or((v, v));
                Some((low.min(v), high.max(v)))
            });
        let (low, high) = range.unwrap_or((0.1, 10.0));
        Self {
            log: true,
            ..Self::linear(label, low / 1.5, high * 1.5)
        }
    }

    /// Position of a value along the axis, 0 to 1 and beyond.
    pub fn place(&self, value: f64) -> f64 {
        if self.log {
            (value.max(self.low * 1e-3) / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Round numbers within the range.
    pub fn ticks(&self) -> Vec<f64> {
        if self.log {
            let ticks = decades(self.low, self.high);
            // Over many powers of ten, only some of them are labelled.
            let every = ticks.len().div_ceil(7).max(1);
            ticks.into_iter().step_by(every).collect()
        } else {
            even(self.low, self.high, f64::from(u8::from(self.whole)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_at_0_and_1_and_ticks_lie_between() {
        let axes = [
            Axis::linear("x", 2.0, 7.0),
            Axis::log("x", [1e-3, 20.0].into_iter()),
            Axis::whole("x", 0.0, 12.0),
            Axis::from_zero("x", [0.3, f64::NAN].into_iter()),
            Axis::log("x", [1e-30, 1e30].into_iter()),
        ];
        for axis in axes {
            assert!(axis.place(axis.low).abs() < 1e-12);
            assert!((axis.place(axis.high) - 1.0).abs() < 1e-12);
            let ticks = axis.ticks();
            assert!((2..=14).contains(&ticks.len()), "{ticks:?}");
            assert!(
                ticks
                    .iter()
                    .all(|t| (-1e-9..=1.0 + 1e-9).contains(&axis.place(*t)))
            );
        }
    }

    #[test]
    fn an_axis_without_data_is_an_axis() {
        assert_eq!(Axis::from_zero("x", std::iter::empty()).ticks().len(), 6);
        assert!(Axis::log("x", [0.0].into_iter()).place(1.0) > 0.0);
    }
}
