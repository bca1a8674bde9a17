//! What a report says of a run.

use std::fmt;

use femdem_view::output::{counted, short_number};
use femdem_view::report::{FactTable, RunFacts};

use super::{FlowSummary, RunSummary};

impl RunSummary {
    /// The course of the run for a [`Report`](crate::report::Report).
    #[must_use]
    pub fn facts(&self) -> RunFacts {
        let title = if self.title.is_empty() {
            "run"
        } else {
            &self.title
        };
        let mut rows = vec![
            (
                "simulated time / s".to_owned(),
                short_number(self.simulated_time),
            ),
            ("steps".to_owned(), self.steps.to_string()),
            ("state".to_owned(), self.rest.to_string()),
            (
                "penalty".to_owned(),
                format!("{:.2e} Pa: {}", self.penalty.value, self.penalty.reason),
            ),
        ];
        if let Some(deep) = &self.penetration {
            rows.push((
                "largest penetration / m".to_owned(),
                format!("{:.3e}", deep.peak),
            ));
        }
        let walls = self.walls.iter().filter(|wall| wall.peak_force > 0.0);
        rows.extend(walls.map(|wall| {
            let name = format!("peak force on {} / N", wall.name);
            (
                name,
                format!(
                    "{} at {} s",
                    short_number(wall.peak_force),
                    short_number(wall.peak_time)
                ),
            )
        }));
        let table = |title: &str, rows: Vec<(String, String)>| FactTable {
            title: title.to_owned(),
            rows,
        };
        let mut tables = vec![
            table("Run", rows),
            table("Energies / J", self.energy_rows()),
        ];
        if !self.flow.is_empty() {
            let flow = self.flow.iter();
            let rows =
                flow.map(|(name, found)| (format!("{} {name}", found.kind), found.to_string()));
            tables.push(table("Flow", rows.collect()));
        }
        RunFacts {
            lead: Some(format!(
                "{title}, at {} s",
                short_number(self.simulated_time)
            )),
            tables,
            versions: vec![("state hash".to_owned(), self.state_hash.clone())],
            ..RunFacts::default()
        }
    }
}

impl RunSummary {
    /// The energies that are not zero, and the error of the ledger.
    fn energy_rows(&self) -> Vec<(String, String)> {
        // Numbers by their keys: this cannot fail.
        let all = serde_json::to_value(self.energy).unwrap_or_default();
        let all = all.as_object().into_iter().flatten();
        let known = all.filter_map(|(key, value)| Some((key, value.as_f64()?)));
        let shown = known.filter(|(_, value)| *value != 0.0);
        shown
            .map(|(key, value)| (key.replace('_', " "), short_number(value)))
            .collect()
    }
}

impl fmt::Display for FlowSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            bodies,
            mass,
            mean_rate,
            ..
        } = self;
        let sign = if *bodies < 0 { "-" } else { "" };
        let bodies = counted(bodies.unsigned_abs() as usize, "body", "bodies");
        write!(f, "{sign}{bodies}, {} kg", short_number(*mass))?;
        match mean_rate {
            Some(rate) => write!(f, ", on average {} kg/s", short_number(*rate)),
            None => Ok(()),
        }
    }
}
