//! Any table with a header line, as text.

use std::path::Path;

use super::csv::Text;
use crate::ViewError;

/// A table: names of the columns, without capitals, and the fields of the rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PlainTable {
    /// Names of the columns, in small letters.
    pub columns: Vec<String>,
    /// Fields of each row, as many as there are columns.
    pub rows: Vec<Vec<String>>,
}

/// Reads a table, such as those over time of a run.
///
/// # Errors
///
/// [`ViewError::Read`], and [`ViewError::Table`] with file and line.
pub fn read_plain(path: impl AsRef<Path>) -> Result<PlainTable, ViewError> {
    let (columns, rows) = Text::read(path.as_ref())?.into_parts();
    Ok(PlainTable { columns, rows })
}

impl PlainTable {
    /// Number of a column; `None` if there is none of the name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }

    /// The number in a column of a row; NaN where there is none.
    #[must_use]
    pub fn number(row: &[String], column: usize) -> f64 {
        let field = row.get(column).and_then(|field| field.trim().parse().ok());
        field.unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_names_are_one_field_and_what_is_no_number_is_nan() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "time,wall,fx\n0.5,\"lid, upper\",2e3\n1,floor,\n").unwrap();
        let table = read_plain(&path).unwrap();
        assert_eq!(table.rows[0][1], "lid, upper");
        let fx = table.column("fx").unwrap();
        let numbers = table.rows.iter().map(|row| PlainTable::number(row, fx));
        let numbers: Vec<f64> = numbers.collect();
        assert!(numbers[0] == 2000.0 && numbers[1].is_nan());
        assert_eq!(table.column("fy"), None);
    }
}
