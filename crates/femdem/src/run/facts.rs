//! What a report says of a run.

use femdem_view::report::{FactTable, RunFacts};

use super::RunSummary;

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
                self.simulated_time.to_string(),
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
                format!("{:.4e} at {:.6} s", wall.peak_force, wall.peak_time),
            )
        }));
        RunFacts {
            lead: Some(format!("{title}, at {:.6} s", self.simulated_time)),
            tables: vec![FactTable {
                title: "Run".to_owned(),
                rows,
            }],
            versions: vec![("state hash".to_owned(), self.state_hash.clone())],
            ..RunFacts::default()
        }
    }
}
