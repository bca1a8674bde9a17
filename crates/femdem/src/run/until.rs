//! The end of a run where a number of its tables passes a limit.

use femdem_view::output::csv::quoted;
use serde::{Deserialize, Serialize};

use super::history::history_header;
use super::{
    CELL_COLUMNS, FLOW_COLUMNS, MEMBER_COLUMNS, Scenario, Simulation, WALL_HISTORY_COLUMNS,
};
use crate::Error;
use crate::error::wrong;

/// A limit of a number in the tables over time. The run ends with the first row after that of time 0 in which a number is
/// beyond its limit, and has been so in all rows for the time wanted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct UntilEntry {
    /// Column of `history.csv` or, with `of`, of `wall_history.csv`, `cells.csv`, `flow.csv` or `members.csv`.
    pub column: String,
    /// Whose row it is, in the tables with several: the name of a wall, a cell, a gauge, a sink, a source or a body.
    pub of: Option<String>,
    /// The number must be above this.
    pub above: Option<f64>,
    /// The number must be below this.
    pub below: Option<f64>,
    /// Time before which nothing is looked at \[s\].
    #[serde(default)]
    pub after: f64,
    /// How long the number must be beyond the limit \[s\].
    #[serde(default)]
    pub lasting: f64,
}

/// The limit that ended a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// Column, and whose row.
    pub column: String,
    /// Name of a wall, a cell, a gauge, a sink, a source or a body; `null` for `history.csv`.
    pub of: Option<String>,
    /// Its number in the last row.
    pub value: f64,
}

/// A row of each of the things that a table tells of.
pub(super) type Lines = Vec<Vec<String>>;

/// What the tables of a run say of one time.
pub(super) struct Rows {
    pub history: Vec<String>,
    pub walls: Lines,
    pub cells: Lines,
    pub flow: Lines,
    pub members: Lines,
}

/// Since when the limits of a scene have been passed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Until {
    /// By entry \[s\].
    since: Vec<Option<f64>>,
    /// The limit that has ended the run.
    pub reached: Option<Reached>,
}

impl UntilEntry {
    fn holds(&self, value: f64) -> bool {
        self.above.is_some_and(|limit| value > limit)
            || self.below.is_some_and(|limit| value < limit)
    }

    /// The number in the rows; `None` where a field is empty, or a body or wall has left.
    fn value(&self, rows: &Rows, header: &[String]) -> Option<f64> {
        let Some(of) = &self.of else {
            let column = quoted(&self.column);
            let place = header.iter().position(|one| *one == column)?;
            return rows.history.get(place)?.parse().ok();
        };
        let name = quoted(of);
        let tables = [
            (&WALL_HISTORY_COLUMNS[..], &rows.walls),
            (&CELL_COLUMNS, &rows.cells),
            (&FLOW_COLUMNS, &rows.flow),
            (&MEMBER_COLUMNS, &rows.members),
        ];
        tables.into_iter().find_map(|(columns, lines)| {
            let place = columns.iter().position(|column| *column == self.column)?;
            let line = lines.iter().find(|line| line.get(1) == Some(&name))?;
            line.get(place)?.parse().ok()
        })
    }
}

impl Until {
    /// Looks at the rows of a time \[s\] after 0; returns whether a limit is reached.
    pub fn look(
        &mut self,
        entries: &[UntilEntry],
        rows: &Rows,
        header: &[String],
        time: f64,
    ) -> bool {
        self.since.resize(entries.len(), None);
        for (entry, since) in entries.iter().zip(&mut self.since) {
            let value = entry.value(rows, header);
            let Some(value) = value.filter(|&value| time >= entry.after && entry.holds(value))
            else {
                *since = None;
                continue;
            };
            let began = *since.get_or_insert(time);
            if time - began >= entry.lasting && self.reached.is_none() {
                self.reached = Some(Reached {
                    column: entry.column.clone(),
                    of: entry.of.clone(),
                    value,
                });
            }
        }
        self.reached.is_some()
    }
}

impl Scenario {
    /// Refuses limits of what the tables of a simulation do not have.
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`] with the names that are known; [`Error::Option`].
    pub(super) fn check_until(&self, simulation: &Simulation) -> Result<(), Error> {
        self.until
            .iter()
            .try_for_each(|entry| self.check_limit(entry, simulation))
    }

    fn check_limit(&self, entry: &UntilEntry, simulation: &Simulation) -> Result<(), Error> {
        for (name, value) in [("until.above", entry.above), ("until.below", entry.below)] {
            if let Some(value) = value.filter(|value| !value.is_finite()) {
                return Err(wrong(name, &value.to_string(), "a finite number"));
            }
        }
        for (name, time) in [
            ("until.after", entry.after),
            ("until.lasting", entry.lasting),
        ] {
            if !(0.0..=self.duration).contains(&time) {
                let allowed = "from 0 to the duration, in s";
                return Err(wrong(name, &time.to_string(), allowed));
            }
        }
        if entry.above.is_some() == entry.below.is_some() {
            return Err(wrong(
                "until",
                &format!("a limit of \"{}\"", entry.column),
                "give either `above` or `below`",
            ));
        }
        let Some(of) = &entry.of else {
            let header = history_header(simulation);
            return known("until.column", &quoted(&entry.column), header);
        };
        let mut columns = Vec::new();
        for (all, names) in self.named_rows(simulation) {
            if names.contains(of) {
                columns.push(&all[2..]);
            }
        }
        if columns.is_empty() {
            let rows = self.named_rows(simulation).into_iter();
            return known("until.of", of, rows.flat_map(|(_, names)| names).collect());
        }
        let with = |all: &&&[&str]| all.contains(&&*entry.column);
        if columns.iter().filter(with).count() > 1 {
            let allowed = "two things of this name have this column: give one another name";
            return Err(wrong("until.of", &format!("\"{of}\""), allowed));
        }
        let columns = columns.concat().into_iter().map(str::to_owned);
        known("until.column", &entry.column, columns.collect())
    }

    /// Columns of the tables with several rows at a time, and the names of these.
    fn named_rows(&self, simulation: &Simulation) -> [(&'static [&'static str], Vec<String>); 4] {
        let walls = simulation.walls.iter().map(|wall| wall.name.clone());
        let cells = simulation.controls.cell_names().map(str::to_owned);
        let members = simulation.members.iter().map(|member| member.name.clone());
        [
            (&WALL_HISTORY_COLUMNS, walls.collect()),
            (&CELL_COLUMNS, cells.collect()),
            (&FLOW_COLUMNS, self.flow_names()),
            (&MEMBER_COLUMNS, members.collect()),
        ]
    }

    /// Whether rows of members are written or looked at.
    pub(super) fn sees_members(&self) -> bool {
        self.track || self.looks_at(&MEMBER_COLUMNS)
    }

    /// Whether a limit is one of rows of this table.
    pub(super) fn looks_at(&self, columns: &[&str]) -> bool {
        let named = self.until.iter().filter(|entry| entry.of.is_some());
        named
            .map(|entry| &*entry.column)
            .any(|column| columns.contains(&column))
    }
}

/// The most names that a message lists.
const LISTED: usize = 40;

fn known(name: &'static str, value: &str, mut all: Vec<String>) -> Result<(), Error> {
    if all.iter().any(|one| one == value) {
        return Ok(());
    }
    let more = all.len().saturating_sub(LISTED);
    all.truncate(LISTED);
    let mut known = all.join(", ");
    if more > 0 {
        known += &format!(" and {more} more");
    }
    Err(Error::Unknown {
        name,
        value: value.to_owned(),
        known,
    })
}

#[cfg(test)]
mod tests {
    use crate::run::{Ending, Run, RunSummary, Scenario};
    use crate::{Error, Usage};

    /// A die that falls freely for 0.2 s, and then lies on a floor.
    fn run(until: &str) -> Result<RunSummary, Error> {
        let text = format!(
            "duration = 1
            every = 0.1
            history-every = 0.01
            {until}
            [material.m]
            density = 1000
            [[wall]]
            name = \"floor\"
            plane = {{ normal = [0, 0, 1] }}
            [[body]]
            name = \"die\"
            shape = \"box:width=1,height=1\"
            size = 0.02
            material = \"m\"
            position = [0, 0, 0.2062]"
        );
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(&text).unwrap())?;
        run.advance(folder.path(), 10)?;
        // A checkpoint in between changes nothing.
        run.flush(folder.path())?;
        run.save(folder.path(), &Usage::default())?;
        let (mut run, _) = Run::read(folder.path())?;
        run.advance(folder.path(), u64::MAX)?;
        let rows = std::fs::read_to_string(folder.path().join("history.csv")).unwrap();
        let last = rows.lines().last().unwrap();
        let summary = run.finish(folder.path(), &Usage::default())?;
        let time: f64 = last.split(',').next().unwrap().parse().unwrap();
        assert_eq!(time, summary.simulated_time, "the end has a row");
        assert!(!folder.path().join("members.csv").exists());
        Ok(summary)
    }

    /// z = 0.2062 - g t^2/2 passes 0.1 at 0.14717 s; the next row is that of 0.15 s.
    #[test]
    fn a_run_ends_with_the_first_row_beyond_a_limit() {
        let summary = run("until = [{ of = \"die\", column = \"z\", below = 0.1 }]").unwrap();
        assert_eq!(summary.ending, Some(Ending::Until));
        let (time, step) = (summary.simulated_time, summary.time_step);
        assert!((0.15..0.15 + step).contains(&time), "{time}");
        let reached = summary.reached.unwrap();
        assert_eq!(reached.of.as_deref(), Some("die"));
        assert!((reached.value - (0.2062 - 4.905 * time * time)).abs() < 1e-9);
    }

    /// The energy of the fall is m g 0.1962 m = 15.4 mJ; the weight is 0.0785 N.
    #[test]
    fn a_limit_may_be_one_of_the_history_and_must_last() {
        let first = run("until = [{ column = \"kinetic\", above = 0.01 }]").unwrap();
        assert!(first.simulated_time < 0.2);
        let on_floor = "of = \"floor\", column = \"pressing\", above = 0.05";
        let touched = run(&format!("until = [{{ {on_floor} }}]")).unwrap();
        let lasting = run(&format!("until = [{{ {on_floor}, lasting = 0.1 }}]")).unwrap();
        assert!((0.2..0.5).contains(&touched.simulated_time));
        assert!(lasting.simulated_time >= touched.simulated_time + 0.1);
        assert_eq!(lasting.ending, Some(Ending::Until));
        let late = run(&format!("until = [{{ {on_floor}, after = 0.9 }}]")).unwrap();
        assert!(late.simulated_time >= 0.9);
        let never = run("until = [{ column = \"px\", above = 1 }]").unwrap();
        assert_eq!((never.ending, never.reached), (Some(Ending::Time), None));
    }

    #[test]
    fn limits_of_what_is_not_there_are_refused() {
        for (entry, words) in [
            ("column = \"heat\", above = 1", ["until.column", "kinetic"]),
            (
                "of = \"lid\", column = \"z\", above = 1",
                ["until.of = \"lid\"", "floor, die"],
            ),
            (
                "of = \"die\", column = \"pressing\", above = 1",
                ["until.column", "qw"],
            ),
            ("column = \"px\"", ["until", "above"]),
            ("column = \"px\", above = 1, below = 0", ["until", "either"]),
            ("column = \"px\", above = nan", ["until.above", "finite"]),
            (
                "column = \"px\", above = 1, lasting = -1",
                ["until.lasting", "duration"],
            ),
        ] {
            let message = run(&format!("until = [{{ {entry} }}]"))
                .unwrap_err()
                .to_string();
            for word in words {
                assert!(message.contains(word), "{entry}: {message}");
            }
        }
    }
}
