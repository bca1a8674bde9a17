//! The stresses of a pack in numbers.

use std::fmt;

use serde::Serialize;

use super::{BodyStress, StressOptions, Stresses};
use crate::means::{difference, median_and_largest};

/// Net forces above this part of the contact forces are told: the bodies are not at rest, or other forces hold them.
const AT_REST: f64 = 0.05;

/// Smallest number that at most a share of the bodies exceed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
    /// `None` of no numbers.
    fn of(numbers: impl Iterator<Item = f64>) -> Option<Self> {
        let mut all: Vec<f64> = numbers.collect();
        all.sort_by(f64::total_cmp);
        let last = all.len().checked_sub(1)?;
        let at = |share: f64| all[(share * last as f64).round() as usize];
        Some(Self {
            tenth: at(0.1),
            median: at(0.5),
            nine_tenths: at(0.9),
            largest: at(1.0),
        })
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
    /// Largest tension away from contacts \[Pa\], of the bodies where it is known.
    pub tension: Option<Quantiles>,
    /// Largest von Mises stress there \[Pa\].
    pub von_mises: Option<Quantiles>,
    /// Bodies without a node away from contacts, whose largest stresses there are not known.
    pub tension_unknown: usize,
    /// Estimate of the tension by the largest force \[Pa\].
    pub splitting_estimate: Option<Quantiles>,
    /// Bodies whose tension is above the strength, if there is one.
    pub above_strength: Option<usize>,
    /// Bodies whose estimate is above the strength, if there is one.
    pub estimate_above_strength: Option<usize>,
    /// Difference of the mean stress of the elements from Love-Weber with the contacts, median and largest of the bodies with
    /// contacts.
    pub contacts_difference: Option<[f64; 2]>,
    /// Net force over the sum of the contact forces, median and largest of the bodies where it is known.
    pub net_force: Option<[f64; 2]>,
    /// Bodies where it is above 0.05.
    pub net_force_above: usize,
    /// Bodies where it is not known.
    pub net_force_unknown: usize,
    /// Time of the solves \[s\].
    pub seconds: f64,
}

/// Median and largest; `None` of no numbers.
fn spread(numbers: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut numbers = numbers.peekable();
    numbers.peek()?;
    Some(median_and_largest(numbers))
}

impl Stresses {
    /// Numbers of the bodies whose net force is above 5 % of the sum of their contact forces: inertia balances it, as in flight, be it
    /// that they move or that something else holds them.
    pub fn not_at_rest(&self) -> impl Iterator<Item = usize> {
        let all = self.bodies.iter().enumerate();
        let above = all.filter(|(_, body)| body.net_force.is_some_and(|net| net > AT_REST));
        above.map(|(i, _)| i)
    }

    /// The summary; `seconds` is what the solves took.
    #[must_use]
    pub fn summary(&self, options: &StressOptions, seconds: f64) -> StressSummary {
        let bodies = || self.bodies.iter();
        let above = |of: fn(&BodyStress) -> Option<f64>| {
            let strength = options.strength?;
            let known = bodies().filter_map(of);
            Some(known.filter(|stress| *stress > strength).count())
        };
        let tension = |body: &BodyStress| body.peaks.tension;
        let touching = || bodies().filter(|body| body.contacts > 0);
        let count = |is: fn(&BodyStress) -> bool| bodies().filter(|body| is(body)).count();
        StressSummary {
            schema: 1,
            options: *options,
            bodies: self.bodies.len(),
            tetrahedra: self.tetrahedra,
            tension: Quantiles::of(bodies().filter_map(tension)),
            von_mises: Quantiles::of(bodies().filter_map(|body| body.peaks.von_mises)),
            tension_unknown: count(|body| body.peaks.tension.is_none()),
            splitting_estimate: Quantiles::of(bodies().map(|body| body.splitting)),
            above_strength: above(|body| body.peaks.tension),
            estimate_above_strength: above(|body| Some(body.splitting)),
            contacts_difference: spread(
                touching().map(|body| difference(&body.elements, &body.contacts_mean)),
            ),
            net_force: spread(bodies().filter_map(|body| body.net_force)),
            net_force_above: self.not_at_rest().count(),
            net_force_unknown: count(|body| body.net_force.is_none()),
            seconds,
        }
    }
}

impl fmt::Display for StressSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, text: String| writeln!(f, "  {name:<20} {text}");
        let unknown = |count: usize| match count {
            0 => String::new(),
            _ => format!(", not known of {count} bodies"),
        };
        let spread = |q: Option<&Quantiles>| {
            let q = q.map(|q| {
                format!(
                    "median {:.3e} Pa, 90 % below {:.3e} Pa, largest {:.3e} Pa{}",
                    q.median,
                    q.nine_tenths,
                    q.largest,
                    unknown(self.tension_unknown)
                )
            });
            q.unwrap_or_else(|| "not known: no node is away from contacts".to_owned())
        };
        line(
            "bodies",
            format!(
                "{}, {} tetrahedra, {:.2} s",
                self.bodies, self.tetrahedra, self.seconds
            ),
        )?;
        line("largest tension", spread(self.tension.as_ref()))?;
        line("von Mises stress", spread(self.von_mises.as_ref()))?;
        if let (Some(above), Some(strength)) = (self.above_strength, self.options.strength) {
            line(
                "would crack",
                format!(
                    "{above} of {} bodies, at {strength:.3e} Pa{}",
                    self.bodies,
                    unknown(self.tension_unknown)
                ),
            )?;
        }
        let net = self.net_force.map(|shares| {
            let [median, largest] = shares.map(|share| 100.0 * share);
            let rest = unknown(self.net_force_unknown);
            format!("median {median:.3} %, largest {largest:.3} % of the contact forces{rest}")
        });
        line("net force", net.unwrap_or_else(|| "unknown".to_owned()))
    }
}
