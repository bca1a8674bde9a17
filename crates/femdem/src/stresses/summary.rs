//! The stresses of a pack in numbers.

use std::fmt;

use serde::Serialize;

use super::{BodyStress, StressOptions, Stresses};
use crate::means::{difference, median_and_largest};

/// Smallest number that at most a share of the bodies exceed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// Of a tenth of the bodies: nine tenths exceed it.
    pub tenth: f64,
    /// Of half of them.
    pub median: f64,
    /// Of nine tenths.
    pub nine_tenths: f64,
    /// Of all.
    pub largest: f64,
}

impl Quantiles {
    fn of(numbers: impl Iterator<Item = f64>) -> Self {
        let mut all: Vec<f64> = numbers.collect();
        all.sort_by(f64::total_cmp);
        let last = all.len().saturating_sub(1);
        let at = |share: f64| {
            let place = (share * last as f64).round() as usize;
            all.get(place).copied().unwrap_or(0.0)
        };
        Self {
            tenth: at(0.1),
            median: at(0.5),
            nine_tenths: at(0.9),
            largest: at(1.0),
        }
    }
}

/// The contents of `stresses.json`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct StressSummary {
    /// Version of these keys.
    pub schema: u32,
    /// The options.
    pub options: StressOptions,
    /// Bodies, and their tetrahedra together.
    pub bodies: usize,
    /// See `bodies`.
    pub tetrahedra: usize,
    /// Largest tension of the bodies \[Pa\]: [`BodyStress::tension`].
    pub tension: Quantiles,
    /// Largest von Mises stress away from contacts \[Pa\], of the bodies that have one.
    pub von_mises: Quantiles,
    /// Bound of the tension by the largest force \[Pa\].
    pub bound: Quantiles,
    /// Bodies whose tension is above the strength, if there is one.
    pub above_strength: Option<usize>,
    /// Bodies whose bound is above the strength, if there is one.
    pub bound_above_strength: Option<usize>,
    /// Difference of the mean stress of the elements from Love-Weber with the contacts, median and largest.
    pub contacts_difference: [f64; 2],
    /// Net force over the sum of the contact forces, median and largest of the bodies where it is known.
    pub net_force: [f64; 2],
    /// Time of the solves \[s\].
    pub seconds: f64,
}

impl Stresses {
    /// The summary; `seconds` is what the solves took.
    #[must_use]
    pub fn summary(&self, options: &StressOptions, seconds: f64) -> StressSummary {
        let bodies = || self.bodies.iter();
        let above = |of: fn(&BodyStress) -> f64| {
            let strength = options.strength?;
            Some(bodies().filter(|body| of(body) > strength).count())
        };
        StressSummary {
            schema: 1,
            options: *options,
            bodies: self.bodies.len(),
            tetrahedra: self.tetrahedra,
            tension: Quantiles::of(bodies().map(BodyStress::tension)),
            von_mises: Quantiles::of(bodies().filter_map(|body| body.peaks.von_mises)),
            bound: Quantiles::of(bodies().map(|body| body.bound)),
            above_strength: above(BodyStress::tension),
            bound_above_strength: above(|body| body.bound),
            contacts_difference: median_and_largest(
                bodies().map(|body| difference(&body.elements, &body.contacts_mean)),
            ),
            net_force: median_and_largest(bodies().filter_map(|body| body.net_force)),
            seconds,
        }
    }
}

impl fmt::Display for StressSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, text: String| writeln!(f, "  {name:<20} {text}");
        let spread = |q: &Quantiles| {
            format!(
                "median {:.3e} Pa, 90 % below {:.3e} Pa, largest {:.3e} Pa",
                q.median, q.nine_tenths, q.largest
            )
        };
        line(
            "bodies",
            format!(
                "{}, {} tetrahedra, {:.2} s",
                self.bodies, self.tetrahedra, self.seconds
            ),
        )?;
        line("largest tension", spread(&self.tension))?;
        line("von Mises stress", spread(&self.von_mises))?;
        if let (Some(above), Some(strength)) = (self.above_strength, self.options.strength) {
            line(
                "would crack",
                format!("{above} of {} bodies, at {strength:.3e} Pa", self.bodies),
            )?;
        }
        let [median, largest] = self.net_force.map(|share| 100.0 * share);
        line(
            "net force",
            format!("median {median:.3} %, largest {largest:.3} % of the contact forces"),
        )
    }
}
