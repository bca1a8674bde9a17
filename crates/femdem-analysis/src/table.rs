//! Results as plain tables: one convention for CSV.

use std::borrow::Cow;
use std::io::{self, Write};

/// One field of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number; written so that reading it gives the same bits.
    Number(f64),
    /// A count, an index.
    Count(u64),
    /// A word. Quoted in CSV where it has to be.
    Text(Cow<'static, str>),
    /// Unknown; an empty field in CSV.
    Empty,
}

/// A result that can be laid out in rows and columns.
///
/// Every table of this crate is written the same way: one header line, comma-separated, `\n` at line ends,
/// fields quoted after RFC 4180 where needed, numbers with a point and enough digits to give the same bits
/// back, unknown values as empty fields. Column names end in their SI unit if they have one (`z_m`,
/// `volume_m3`, `force_n`, `stress_pa`), with `_over_d` for lengths in mean diameters. JSON is written through
/// serde.
///
/// ```
/// use femdem_analysis::{Cell, Table};
///
/// struct Heights(Vec<f64>);
///
/// impl Table for Heights {
///     fn columns(&self) -> &'static [&'static str] {
///         &["body", "height_m"]
///     }
///     fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
///         let heights = self.0.iter().zip(0_u32..);
///         Box::new(heights.map(|(height, body)| vec![body.into(), (*height).into()]))
///     }
/// }
///
/// assert_eq!(Heights(vec![0.5, 1e-9]).to_csv(), "body,height_m\n0,0.5\n1,1e-9\n");
/// ```
pub trait Table {
    /// Names of the columns, with their units.
    fn columns(&self) -> &'static [&'static str];

    /// The rows, each with one cell per column.
    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_>;

    /// Writes the table as CSV, header first. Many small writes: give it a buffered writer.
    ///
    /// # Errors
    /// Those of `out`.
    fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        writeln!(out, "{}", self.columns().join(","))?;
        for row in self.rows() {
            for (k, cell) in row.iter().enumerate() {
                if k > 0 {
                    write!(out, ",")?;
                }
                cell.write(out)?;
            }
            writeln!(out)?;
        }
        Ok(())
    }

    /// The table as CSV text.
    fn to_csv(&self) -> String {
        let mut bytes = Vec::new();
        // Writing to memory does not fail.
        let _ = self.write_csv(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

impl Cell {
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            // The shortest digits that give the same bits, with an exponent where that is shorter.
            Self::Number(x) => write!(out, "{x:?}"),
            Self::Count(n) => write!(out, "{n}"),
            Self::Text(text) if text.contains([',', '"', '\n', '\r']) => {
                write!(out, "\"{}\"", text.replace('"', "\"\""))
            }
            Self::Text(text) => write!(out, "{text}"),
            Self::Empty => Ok(()),
        }
    }
}

impl From<f64> for Cell {
    fn from(x: f64) -> Self {
        Self::Number(x)
    }
}

impl From<u32> for Cell {
    fn from(n: u32) -> Self {
        Self::Count(n.into())
    }
}

impl From<u64> for Cell {
    fn from(n: u64) -> Self {
        Self::Count(n)
    }
}

impl From<usize> for Cell {
    fn from(n: usize) -> Self {
        Self::Count(n as u64)
    }
}

impl From<&'static str> for Cell {
    fn from(text: &'static str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text.into())
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Mixed;

    impl Table for Mixed {
        fn columns(&self) -> &'static [&'static str] {
            &["name", "value_m", "count"]
        }
        fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
            let rows = vec![
                vec!["plain".into(), (1.0 / 3.0).into(), 7_u32.into()],
                vec!["a, \"b\"".into(), None::<f64>.into(), Some(8_usize).into()],
                vec![
                    String::from("x").into(),
                    f64::INFINITY.into(),
                    u64::MAX.into(),
                ],
            ];
            Box::new(rows.into_iter())
        }
    }

    #[test]
    fn fields_are_quoted_empty_and_exact() {
        assert_eq!(
            Mixed.to_csv(),
            "name,value_m,count\nplain,0.3333333333333333,7\n\"a, \"\"b\"\"\",,8\nx,inf,18446744073709551615\n"
        );
    }

    #[test]
    fn errors_of_the_writer_come_back() {
        let mut full: &mut [u8] = &mut [0; 4];
        assert!(Mixed.write_csv(&mut full).is_err());
    }

    #[test]
    fn numbers_come_back_with_the_same_bits() {
        for x in [0.1 + 0.2, 5e-324, f64::MAX, -0.0, 1e16] {
            let mut bytes = Vec::new();
            Cell::from(x).write(&mut bytes).unwrap();
            let text = String::from_utf8(bytes).unwrap();
            assert_eq!(
                text.parse::<f64>().unwrap().to_bits(),
                x.to_bits(),
                "{text}"
            );
        }
    }
}
