//! A page (Markdown) and a table (CSV) of one case.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::machine::Place;

/// A target, and the measured value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Check {
    pub(crate) figure: String,
    pub(crate) wanted: String,
    pub(crate) measured: String,
    pub(crate) met: bool,
}

impl Check {
    /// A number that must not exceed a limit.
    pub(crate) fn at_most(figure: &str, measured: f64, limit: f64, unit: &str) -> Self {
        let text = |value: f64| format!("{} {unit}", short(value)).trim_end().to_owned();
        Self {
            figure: figure.to_owned(),
            wanted: format!("at most {}", text(limit)),
            measured: text(measured),
            // NaN does not meet a limit.
            met: measured <= limit,
        }
    }

    /// A statement that must hold.
    pub(crate) fn holds(figure: &str, wanted: &str, measured: impl ToString, met: bool) -> Self {
        Self {
            figure: figure.to_owned(),
            wanted: wanted.to_owned(),
            measured: measured.to_string(),
            met,
        }
    }
}

/// Longer lists of runs and of rows are in files of their own, beside the page.
const LONGEST_LIST: usize = 30;

/// The result of a case.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Report {
    /// File name without its extension, and name of the case.
    pub(crate) name: &'static str,
    pub(crate) title: String,
    /// What was done and how it is assessed.
    pub(crate) text: String,
    /// The commands that were run, as a user would give them.
    pub(crate) commands: Vec<String>,
    pub(crate) checks: Vec<Check>,
    pub(crate) columns: Vec<&'static str>,
    pub(crate) rows: Vec<Vec<String>>,
    /// Files to be copied next to the page, such as pictures that its text shows.
    pub(crate) attachments: Vec<PathBuf>,
}

impl Report {
    pub(crate) fn all_met(&self) -> bool {
        self.checks.iter().all(|check| check.met)
    }

    /// The checks for the terminal, a line each.
    pub(crate) fn checks_as_text(&self) -> String {
        let line = |check: &Check| {
            let verdict = if check.met { "met" } else { "NOT MET" };
            let Check {
                figure,
                wanted,
                measured,
                ..
            } = check;
            format!("{}: {figure}: {measured} ({wanted}): {verdict}", self.name)
        };
        self.checks.iter().map(line).collect::<Vec<_>>().join("\n")
    }

    /// Writes the page and the table into a folder; returns the path of the page. `made_by` is the command that
    /// started the case.
    ///
    /// # Errors
    /// When the folder or a file cannot be written.
    pub(crate) fn write(&self, folder: &Path, place: &Place, made_by: &str) -> Result<PathBuf> {
        let shown = folder.display();
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {shown}"))?;
        let page = folder.join(format!("{}.md", self.name));
        let table = folder.join(format!("{}.csv", self.name));
        let mut files = vec![
            (&page, self.to_markdown(place, made_by)),
            (&table, self.to_csv()),
        ];
        let commands = folder.join(self.command_file());
        if self.commands.len() > LONGEST_LIST {
            files.push((&commands, self.commands.join("\n") + "\n"));
        }
        for (path, text) in files {
            fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))?;
        }
        for file in &self.attachments {
            let to = folder.join(file.file_name().unwrap_or_default());
            fs::copy(file, &to).with_context(|| format!("cannot write {}", to.display()))?;
        }
        Ok(page)
    }

    fn to_markdown(&self, place: &Place, made_by: &str) -> String {
        let checks = self.checks.iter().map(|c| {
            let verdict = if c.met { "yes" } else { "**no**" };
            vec![
                c.figure.clone(),
                c.wanted.clone(),
                c.measured.clone(),
                verdict.to_owned(),
            ]
        });
        format!(
            "# {}\n\n{}\n\n{}- made by: `{made_by}`\n\n{}\n{}\n{}",
            self.title,
            self.text,
            place.to_markdown(),
            self.told_runs(),
            markdown_table(
                &["figure", "wanted", "measured", "met"],
                &checks.collect::<Vec<_>>()
            ),
            self.told_rows(),
        )
    }

    fn command_file(&self) -> String {
        format!("{}-runs.txt", self.name)
    }

    /// The commands of the runs, or where they are.
    fn told_runs(&self) -> String {
        let (count, file) = (self.commands.len(), self.command_file());
        if count > LONGEST_LIST {
            return format!("The commands of the {count} runs: [{file}]({file}).\n");
        }
        format!("The runs:\n\n```text\n{}\n```\n", self.commands.join("\n"))
    }

    /// The table, or where it is.
    fn told_rows(&self) -> String {
        let (count, name) = (self.rows.len(), self.name);
        if count > LONGEST_LIST {
            return format!("The {count} rows of the table: [{name}.csv]({name}.csv).\n");
        }
        let table = markdown_table(&self.columns, &self.rows);
        format!("{table}\nThe same as a file: [{name}.csv]({name}.csv).\n")
    }

    fn to_csv(&self) -> String {
        let head = self.columns.join(",");
        let rows = self.rows.iter().map(|row| {
            let cells = row.iter().map(|cell| csv_cell(cell));
            cells.collect::<Vec<_>>().join(",")
        });
        std::iter::once(head)
            .chain(rows)
            .map(|line| line + "\n")
            .collect()
    }
}

/// A table of a page.
pub(crate) fn markdown_table(columns: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = columns.iter().map(|c| (*c).to_owned()).collect();
    let rule = vec!["---".to_owned(); columns.len()];
    let body: String = rows.iter().map(|row| line(row)).collect();
    line(&head) + &line(&rule) + &body
}

fn csv_cell(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A number to four digits, with an exponent where that is shorter; a dash for an unknown value.
pub(crate) fn short(value: f64) -> String {
    if value.is_nan() {
        return "-".to_owned();
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        Report {
            name: "trial",
            title: "A trial".to_owned(),
            text: "Two runs.".to_owned(),
            commands: vec!["femdem pack".to_owned()],
            checks: vec![
                Check::at_most("time", 59.96, 60.0, "s"),
                Check::holds("settled", "yes", false, false),
            ],
            columns: vec!["bodies", "note"],
            rows: vec![
                vec!["500".to_owned(), "plain".to_owned()],
                vec!["1000".to_owned(), "a, \"b\"".to_owned()],
            ],
            attachments: Vec::new(),
        }
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (12.345_67, "12.35"),
            (4.3e-5, "4.3e-5"),
            (5.141_89e6, "5.142e6"),
            (0.004_228_7, "0.004229"),
            (f64::NAN, "-"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn what_is_not_a_number_is_not_met() {
        assert!(Check::at_most("x", 1.0, 1.0, "").met);
        assert!(!Check::at_most("x", 1.01, 1.0, "").met);
        assert!(!Check::at_most("x", f64::NAN, 1.0, "").met);
    }

    #[test]
    fn one_figure_missed_is_a_report_missed() {
        let mut report = report();
        assert!(!report.all_met());
        assert!(
            report
                .checks_as_text()
                .contains("settled: false (yes): NOT MET")
        );
        report.checks.pop();
        assert!(report.all_met());
    }

    #[test]
    fn cells_with_commas_are_quoted() {
        let csv = report().to_csv();
        assert_eq!(csv, "bodies,note\n500,plain\n1000,\"a, \"\"b\"\"\"\n");
    }

    #[test]
    fn page_and_table_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let place = Place {
            processor: "P".to_owned(),
            cores: 2,
            load: None,
            program: "femdem 1".to_owned(),
        };
        let picture = folder.path().join("trial.png");
        fs::write(&picture, "P").unwrap();
        let report = Report {
            attachments: vec![picture],
            ..report()
        };
        let page = report
            .write(
                &folder.path().join("new"),
                &place,
                "cargo studies validate trial",
            )
            .unwrap();
        let text = fs::read_to_string(&page).unwrap();
        for part in [
            "# A trial\n\nTwo runs.\n\n- machine: P, 2 cores\n",
            "| time | at most 60 s | 59.96 s | yes |",
            "| settled | yes | false | **no** |",
            "| 1000 | a, \"b\" |",
            "`cargo studies validate trial`",
        ] {
            assert!(text.contains(part), "{part:?} is not in\n{text}");
        }
        assert!(page.with_extension("csv").is_file());
        assert!(page.with_extension("png").is_file());
    }
}
