//! Tables with a header line, as spreadsheets and scripts write them (RFC 4180).

use std::fs;
use std::path::{Path, PathBuf};

use crate::ViewError;

/// A table as text.
pub(super) struct Text {
    path: PathBuf,
    columns: Vec<String>,
    rows: Vec<Row>,
}

/// A row and the line on which it begins.
struct Row {
    line: usize,
    fields: Vec<String>,
}

/// A row with access by column.
#[derive(Clone, Copy)]
pub(super) struct Record<'a> {
    text: &'a Text,
    row: &'a Row,
}

/// A column of a table.
#[derive(Clone, Copy)]
pub(super) struct Column {
    index: usize,
    name: &'static str,
}

impl Text {
    pub(super) fn read(path: &Path) -> Result<Self, ViewError> {
        let bytes = fs::read(path).map_err(|source| ViewError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        let text = String::from_utf8_lossy(&bytes);
        Self::parse(path, text.trim_start_matches('\u{feff}'))
    }

    fn parse(path: &Path, text: &str) -> Result<Self, ViewError> {
        let refuse = |line, message: String| ViewError::Table {
            path: path.to_path_buf(),
            line,
            message,
        };
        let mut rows = split(text)
            .map_err(|line| refuse(line, "a quote is opened here and never closed".to_owned()))?;
        if rows.is_empty() {
            return Err(refuse(
                1,
                "the file is empty: it needs a header line".to_owned(),
            ));
        }
        let header = rows.remove(0);
        let columns: Vec<String> = header
            .fields
            .iter()
            .map(|name| name.trim().to_ascii_lowercase())
            .collect();
        for row in &rows {
            if row.fields.len() != columns.len() {
                let (found, expected) = (row.fields.len(), columns.len());
                return Err(refuse(
                    row.line,
                    format!("{found} fields, but the header has {expected} columns"),
                ));
            }
        }
        Ok(Self {
            path: path.to_path_buf(),
            columns,
            rows,
        })
    }

    /// The columns and the fields of the rows.
    pub(super) fn into_parts(self) -> (Vec<String>, Vec<Vec<String>>) {
        let rows = self.rows.into_iter().map(|row| row.fields);
        (self.columns, rows.collect())
    }

    pub(super) fn records(&self) -> impl Iterator<Item = Record<'_>> {
        self.rows.iter().map(|row| Record { text: self, row })
    }

    /// An optional column.
    pub(super) fn find(&self, name: &'static str) -> Option<Column> {
        let index = self.columns.iter().position(|column| column == name)?;
        Some(Column { index, name })
    }

    /// A required column.
    pub(super) fn need(&self, name: &'static str) -> Result<Column, ViewError> {
        self.find(name).ok_or_else(|| ViewError::Table {
            path: self.path.clone(),
            line: 1,
            message: format!(
                "there is no column `{name}`; the header has {}",
                self.columns.join(", ")
            ),
        })
    }

    /// Several required columns.
    pub(super) fn need_all<const N: usize>(
        &self,
        names: [&'static str; N],
    ) -> Result<[Column; N], ViewError> {
        let mut found = [Column { index: 0, name: "" }; N];
        for (column, name) in found.iter_mut().zip(names) {
            *column = self.need(name)?;
        }
        Ok(found)
    }

    /// Several columns; they count as missing unless all are present.
    pub(super) fn find_all<const N: usize>(&self, names: [&'static str; N]) -> Option<[Column; N]> {
        let mut found = [Column { index: 0, name: "" }; N];
        for (column, name) in found.iter_mut().zip(names) {
            *column = self.find(name)?;
        }
        Some(found)
    }
}

impl<'a> Record<'a> {
    pub(super) fn text(&self, column: Column) -> &'a str {
        self.row
            .fields
            .get(column.index)
            .map_or("", |field| field.trim())
    }

    pub(super) fn number(&self, column: Column) -> Result<f64, ViewError> {
        let text = self.text(column);
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(self.refuse(format!("{} = `{text}` is no finite number", column.name))),
        }
    }

    pub(super) fn numbers<const N: usize>(
        &self,
        columns: [Column; N],
    ) -> Result<[f64; N], ViewError> {
        let mut numbers = [0.0; N];
        for (number, column) in numbers.iter_mut().zip(columns) {
            *number = self.number(column)?;
        }
        Ok(numbers)
    }

    pub(super) fn whole(&self, column: Column) -> Result<u32, ViewError> {
        let text = self.text(column);
        text.parse().map_err(|_| {
            let range = "0 to 4294967295";
            self.refuse(format!(
                "{} = `{text}` is no whole number of {range}",
                column.name
            ))
        })
    }

    /// An error that names this row.
    pub(super) fn refuse(&self, message: String) -> ViewError {
        ViewError::Table {
            path: self.text.path.clone(),
            line: self.row.line,
            message,
        }
    }
}

/// Rows of fields; empty lines are left out. The error is the line of a quote that is not closed.
fn split(text: &str) -> Result<Vec<Row>, usize> {
    let mut rows = Vec::new();
    let mut fields = Vec::new();
    let mut field = String::new();
    let mut quoted_since = None;
    let (mut line, mut begin) = (1, 1);
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let ends = c == '\n' || (c == '\r' && characters.peek() != Some(&'\n'));
        line += usize::from(ends);
        match (c, quoted_since) {
            ('"', Some(_)) if characters.peek() == Some(&'"') => {
                characters.next();
                field.push('"');
            }
            ('"', Some(_)) => quoted_since = None,
            ('"', None) if field.is_empty() => quoted_since = Some(line),
            (',', None) => fields.push(std::mem::take(&mut field)),
            (_, None) if ends => {
                if field.ends_with('\r') {
                    field.pop();
                }
                if !(fields.is_empty() && field.is_empty()) {
                    fields.push(std::mem::take(&mut field));
                    rows.push(Row {
                        line: begin,
                        fields: std::mem::take(&mut fields),
                    });
                }
                begin = line;
            }
            _ => field.push(c),
        }
    }
    if let Some(line) = quoted_since {
        return Err(line);
    }
    if !(fields.is_empty() && field.is_empty()) {
        fields.push(field);
        rows.push(Row {
            line: begin,
            fields,
        });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Text, String> {
        Text::parse(Path::new("t.csv"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn quotes_line_ends_and_blank_lines() {
        let text = parsed("a, B \r\n\"x, \"\"y\"\"\n\",2\r\n\n3,4").unwrap();
        let [a, b] = text.need_all(["a", "b"]).unwrap();
        let rows: Vec<_> = text.records().collect();
        assert_eq!(rows.len(), 2);
        assert_eq!(
            (rows[0].text(a), rows[0].number(b).unwrap()),
            ("x, \"y\"", 2.0)
        );
        assert_eq!(rows[1].numbers([a, b]).unwrap(), [3.0, 4.0]);
        assert_eq!(rows[1].whole(b).unwrap(), 4);
        assert!(text.find("c").is_none() && text.find_all(["a", "c"]).is_none());
        // The quoted field contains a line end.
        assert!(rows[1].number(a).is_ok() && rows[1].row.line == 5);
    }

    #[test]
    fn lines_may_end_with_cr_alone() {
        let text = parsed("a,b\r1,2\r\r\"x\ry\",4\r").unwrap();
        let b = text.need("b").unwrap();
        let rows: Vec<_> = text.records().collect();
        assert_eq!(
            [rows[0], rows[1]].map(|row| row.number(b).unwrap()),
            [2.0, 4.0]
        );
        assert_eq!((rows.len(), rows[1].row.line), (2, 4));
    }

    #[test]
    fn faults_name_file_line_and_column() {
        let message = |text: &str| parsed(text).err().unwrap();
        assert!(message("").contains("empty"));
        assert!(message("a,b\n1,2\n3\n").contains("t.csv, line 3: 1 fields"));
        assert!(message("a\n\"x\n").contains("line 2"));
        let text = parsed("a,b\n1,nan\n").unwrap();
        let error = |result: Result<f64, ViewError>| result.unwrap_err().to_string();
        let b = text.need("b").unwrap();
        let record = text.records().next().unwrap();
        assert!(error(record.number(b)).contains("line 2: b = `nan`"));
        assert!(
            record
                .whole(b)
                .unwrap_err()
                .to_string()
                .contains("whole number")
        );
        let missing = text.need("mass").err().unwrap().to_string();
        assert!(
            missing.contains("no column `mass`") && missing.contains("a, b"),
            "{missing}"
        );
    }
}
