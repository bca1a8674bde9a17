//! Output of the examples: lines of columns separated by tabs, each with the name of its table first.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use super::program::Workshop;

/// Lines of an example, each split at its tabs.
#[derive(Debug, Default, Clone, PartialEq)]
pub(crate) struct Output(Vec<Vec<String>>);

impl Output {
    /// Runs an example with `arguments` for `cargo run --release --locked`; returns the command, too.
    ///
    /// # Errors
    /// When it cannot be built or fails.
    pub(crate) fn of(workshop: &Workshop, arguments: &str) -> Result<(Self, String)> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let arguments = format!("run --release --locked {arguments}");
        let output = Command::new(cargo)
            .args(arguments.split_whitespace())
            .current_dir(workshop.root())
            .stdin(Stdio::null())
            .stderr(Stdio::inherit())
            .output()
            .context("cannot start cargo")?;
        ensure!(
            output.status.success(),
            "the example failed: cargo {arguments}"
        );
        let parsed = Self::parse(&String::from_utf8_lossy(&output.stdout));
        Ok((parsed, format!("cargo {arguments}")))
    }

    /// The lines that an example printed earlier with `arguments`; returns the command, too.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub(crate) fn read(file: &Path, arguments: &str) -> Result<(Self, String)> {
        let text =
            fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))?;
        let command = format!("cargo run --release --locked {arguments}");
        Ok((Self::parse(&text), command))
    }

    /// The lines of an `example`, the package with its arguments, run for each of the tables, or of the files of an earlier run
    /// in a folder; returns the commands, too.
    ///
    /// # Errors
    /// When it cannot be built or fails, or a file cannot be read.
    pub(crate) fn of_tables(
        workshop: &Workshop,
        earlier: Option<&Path>,
        example: &str,
        tables: &[&str],
    ) -> Result<(Self, Vec<String>)> {
        let mut output = Self::default();
        let mut commands = Vec::new();
        for table in tables {
            let arguments = format!("{example} {table}");
            let (lines, command) = match earlier {
                Some(folder) => Self::read(&folder.join(format!("{table}.tsv")), &arguments)?,
                None => Self::of(workshop, &arguments)?,
            };
            output = output.and(lines);
            commands.push(command);
        }
        Ok((output, commands))
    }

    pub(crate) fn parse(text: &str) -> Self {
        let cells = |line: &str| line.split('\t').map(str::to_owned).collect();
        Self(text.lines().map(cells).collect())
    }

    /// The lines as they were printed.
    pub(crate) fn to_text(&self) -> String {
        self.0.iter().map(|row| row.join("\t") + "\n").collect()
    }

    /// These lines, then those.
    pub(crate) fn and(mut self, other: Self) -> Self {
        self.0.extend(other.0);
        self
    }

    /// Rows whose first cell is `table`, without it.
    pub(crate) fn rows(&self, table: &str) -> impl Iterator<Item = &[String]> {
        self.0.iter().filter_map(move |row| match row.as_slice() {
            [first, rest @ ..] if first == table => Some(rest),
            _ => None,
        })
    }

    /// A number of the first row of `table` that starts with `key`; NaN if there is none.
    pub(crate) fn number(&self, table: &str, key: &[&str], column: usize) -> f64 {
        let mut rows = self.rows(table);
        let row =
            rows.find(|row| row.len() > key.len() && key.iter().zip(*row).all(|(k, c)| k == c));
        row.map_or(f64::NAN, |row| cell(row, column))
    }
}

/// A number of a row; NaN if the cell is not a number.
pub(crate) fn cell(row: &[String], column: usize) -> f64 {
    let number = row.get(column).and_then(|text| text.parse().ok());
    number.unwrap_or(f64::NAN)
}
