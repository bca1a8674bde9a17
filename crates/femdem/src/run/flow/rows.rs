//! Rows of `flow.csv`.

use femdem_view::output::csv::quoted;

use super::state::{Count, Flow};
use crate::run::history::number;

/// Columns of `flow.csv`.
pub const FLOW_COLUMNS: [&str; 5] = ["time", "name", "bodies", "mass", "rate"];

impl Flow {
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
