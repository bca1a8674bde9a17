//! Rows of `flow.csv`, and what has passed in all.

use std::collections::BTreeMap;

use femdem_view::output::csv::quoted;

use serde::{Deserialize, Serialize};

use super::state::{Count, Flow};
use crate::run::history::number;

/// Columns of `flow.csv`.
pub const FLOW_COLUMNS: [&str; 5] = ["time", "name", "bodies", "mass", "rate"];

/// What has passed a gauge, left at a sink or come from a source so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlowSummary {
    /// "gauge", "sink" or "source".
    pub kind: String,
    /// Number of bodies.
    pub bodies: i64,
    /// Their mass \[kg\].
    pub mass: f64,
    /// Mass after the first passage, over the time from this to the latest \[kg/s\]; `null` while there are no two.
    pub mean_rate: Option<f64>,
}

impl FlowSummary {
    fn of(kind: &str, count: &Count) -> Self {
        Self {
            kind: kind.to_owned(),
            bodies: count.bodies,
            mass: count.mass + 0.0,
            mean_rate: count.mean_rate(),
        }
    }
}

impl Flow {
    /// What has passed so far, by name.
    pub(in crate::run) fn summary(&self) -> BTreeMap<String, FlowSummary> {
        let gates = self.gates.iter().map(|gate| {
            let kind = if gate.takes { "sink" } else { "gauge" };
            (gate.name.clone(), FlowSummary::of(kind, &gate.passed))
        });
        let supplies = self.supplies.iter();
        let supplies = supplies.map(|s| (s.name.clone(), FlowSummary::of("source", &s.come)));
        gates.chain(supplies).collect()
    }

    /// Rows of `flow.csv`: gates, then sources.
    pub(in crate::run) fn rows(&mut self, time: f64) -> Vec<Vec<String>> {
        let gates = self.gates.iter_mut();
        let gates = gates.map(|gate| row(&mut gate.passed, &gate.name, time));
        let supplies = self.supplies.iter_mut();
        let supplies = supplies.map(|supply| row(&mut supply.come, &supply.name, time));
        gates.chain(supplies).collect()
    }
}

/// A row; the rate is that since the last one.
fn row(count: &mut Count, name: &str, time: f64) -> Vec<String> {
    let [mass, before] = count.last;
    let rate = match time > before {
        true => (count.mass - mass) / (time - before),
        false => 0.0,
    };
    count.last = [count.mass, time];
    let mut row = vec![number(time), quoted(name), count.bodies.to_string()];
    row.extend([count.mass, rate].map(number));
    row
}
