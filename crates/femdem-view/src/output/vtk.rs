//! The XML frame shared by VTU, VTP and VTI: arrays in one appended block, base64.
//!
//! VTK XML, version 1.0: an appended array is a 64-bit count of bytes followed by the bytes, little endian;
//! each is encoded separately, and `offset` counts characters from the underscore. All offsets follow from the
//! lengths, so that the values are requested only when they are written: a document takes no memory for them.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::base64::encode;

/// Bytes that are encoded together: a multiple of 3, so that only the last block is padded.
const BLOCK: usize = 3 << 10;

/// Writes the values of an array.
type Array<'a> = Box<dyn FnOnce(&mut Base64) -> io::Result<()> + 'a>;

/// A document under construction: the XML before the data, and the sources of the data.
///
/// The elements around the arrays are given line by line; names and lines are written as they are, without
/// escapes.
///
/// ```
/// use femdem_view::output::vtk::Document;
///
/// let mut document = Document::new("PolyData");
/// document.line("<Piece NumberOfPoints=\"1\">\n<Points>");
/// document.floats("points", 3, [0.0, 0.0, 1.0]);
/// document.line("</Points>\n</Piece>");
/// document.finish(std::io::sink())?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub struct Document<'a> {
    kind: &'static str,
    attributes: String,
    xml: String,
    arrays: Vec<Array<'a>>,
    /// Number of characters of the arrays.
    length: usize,
}

impl<'a> Document<'a> {
    /// A document of VTK type "UnstructuredGrid", "PolyData" or "ImageData".
    #[must_use]
    pub fn new(kind: &'static str) -> Self {
        Self {
            kind,
            attributes: String::new(),
            xml: String::new(),
            arrays: Vec::new(),
            length: 0,
        }
    }

    /// Attributes of the element named after the type, each preceded by a space.
    #[must_use]
    pub fn with_attributes(mut self, attributes: String) -> Self {
        self.attributes = attributes;
        self
    }

    /// A line of XML.
    pub fn line(&mut self, text: &str) {
        self.xml.push_str(text);
        self.xml.push('\n');
    }

    /// An array of doubles, so many `components` to an entry.
    pub fn floats(
        &mut self,
        name: &str,
        components: usize,
        values: impl IntoIterator<Item = f64, IntoIter: Clone + 'a>,
    ) {
        let bytes = values.into_iter().map(f64::to_le_bytes);
        self.array("Float64", name, components, bytes);
    }

    /// An array of 64-bit integers.
    pub fn integers(
        &mut self,
        name: &str,
        values: impl IntoIterator<Item = i64, IntoIter: Clone + 'a>,
    ) {
        self.array("Int64", name, 1, values.into_iter().map(i64::to_le_bytes));
    }

    /// An array of numbers in single precision.
    pub fn singles(
        &mut self,
        name: &str,
        values: impl IntoIterator<Item = f32, IntoIter: Clone + 'a>,
    ) {
        let bytes = values.into_iter().map(f32::to_le_bytes);
        self.array("Float32", name, 1, bytes);
    }

    /// An array of unsigned 32-bit integers.
    pub fn counts(
        &mut self,
        name: &str,
        values: impl IntoIterator<Item = u32, IntoIter: Clone + 'a>,
    ) {
        self.array("UInt32", name, 1, values.into_iter().map(u32::to_le_bytes));
    }

    /// An array of bytes.
    pub fn bytes(
        &mut self,
        name: &str,
        values: impl IntoIterator<Item = u8, IntoIter: Clone + 'a>,
    ) {
        self.array("UInt8", name, 1, values.into_iter().map(|byte| [byte]));
    }

    /// As [`floats`](Self::floats), of `count` numbers that `give` passes on one by one when the document is written: it may fetch
    /// them in parts.
    pub fn given_floats(
        &mut self,
        name: &str,
        components: usize,
        count: usize,
        give: impl FnOnce(&mut dyn FnMut(f64) -> io::Result<()>) -> io::Result<()> + 'a,
    ) {
        self.given("Float64", name, components, count, |take| {
            give(&mut |value| take(value.to_le_bytes()))
        });
    }

    /// The same of 64-bit integers.
    pub fn given_integers(
        &mut self,
        name: &str,
        count: usize,
        give: impl FnOnce(&mut dyn FnMut(i64) -> io::Result<()>) -> io::Result<()> + 'a,
    ) {
        self.given("Int64", name, 1, count, |take| {
            give(&mut |value| take(value.to_le_bytes()))
        });
    }

    /// The same of bytes.
    pub fn given_bytes(
        &mut self,
        name: &str,
        count: usize,
        give: impl FnOnce(&mut dyn FnMut(u8) -> io::Result<()>) -> io::Result<()> + 'a,
    ) {
        self.given("UInt8", name, 1, count, |take| {
            give(&mut |value| take([value]))
        });
    }

    fn array<const N: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; N]> + Clone + 'a,
    ) {
        let count = match values.size_hint() {
            (least, Some(most)) if least == most => most,
            _ => values.clone().count(),
        };
        self.given(kind, name, components, count, |take| {
            let mut values = values;
            values.try_for_each(take)
        });
    }

    fn given<const N: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        count: usize,
        give: impl FnOnce(&mut dyn FnMut([u8; N]) -> io::Result<()>) -> io::Result<()> + 'a,
    ) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{}\"/>",
            self.length
        );
        let size = N * count;
        self.length += (size_of::<u64>() + size).div_ceil(3) * 4;
        let name = name.to_owned();
        self.arrays.push(Box::new(move |out| {
            out.push(&(size as u64).to_le_bytes())?;
            let mut given = 0;
            give(&mut |value| {
                given += 1;
                out.push(&value)
            })?;
            if given != count {
                let message = format!("{given} values of {count} were given for \"{name}\"");
                return Err(io::Error::new(io::ErrorKind::InvalidData, message));
            }
            out.finish()
        }));
    }

    /// Writes the document.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn finish(self, mut writer: impl Write) -> io::Result<()> {
        let (kind, attributes) = (self.kind, &self.attributes);
        write!(
            writer,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<{kind}{attributes}>\n{}</{kind}>\n\
             <AppendedData encoding=\"base64\">\n_",
            self.xml
        )?;
        let mut data = Base64::new(&mut writer);
        for array in self.arrays {
            array(&mut data)?;
        }
        writer.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    }
}

/// Writes bytes as base64 in a stream.
struct Base64<'w> {
    writer: &'w mut dyn Write,
    block: Vec<u8>,
    text: String,
}

impl<'w> Base64<'w> {
    fn new(writer: &'w mut dyn Write) -> Self {
        Self {
            writer,
            block: Vec::with_capacity(BLOCK),
            text: String::new(),
        }
    }

    fn push(&mut self, bytes: &[u8]) -> io::Result<()> {
        for &byte in bytes {
            self.block.push(byte);
            if self.block.len() == BLOCK {
                self.finish()?;
            }
        }
        Ok(())
    }

    /// Writes the rest of an array, with padding if needed.
    fn finish(&mut self) -> io::Result<()> {
        self.text.clear();
        encode(&self.block, &mut self.text);
        self.block.clear();
        self.writer.write_all(self.text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Over several blocks, with one, two and no bytes left over, and lengths that iterators do not report.
    #[test]
    fn arrays_of_any_length_are_encoded_as_a_whole() {
        for count in [0, 1, 2, BLOCK - 8, BLOCK, 3 * BLOCK + 5] {
            let values = (0..count).map(|k| (k % 251) as u8);
            let mut whole = (count as u64).to_le_bytes().to_vec();
            whole.extend(values.clone());
            let mut expected = String::new();
            encode(&whole, &mut expected);
            let mut document = Document::new("PolyData");
            document.bytes("all", values.clone().filter(|_| true));
            document.bytes("next", values);
            let mut bytes = Vec::new();
            document.finish(&mut bytes).unwrap();
            let text = String::from_utf8(bytes).unwrap();
            assert!(text.contains(&format!("\n_{expected}{expected}\n</AppendedData>")));
            assert!(text.contains(&format!("offset=\"{}\"/>", expected.len())));
        }
    }

    /// Values that are given make the same file; too few of them are an error.
    #[test]
    fn given_values_are_those_of_a_list() {
        let mut listed = Document::new("PolyData");
        listed.floats("x", 3, [1.0, 2.0, 3.0]);
        listed.integers("n", [7, 8]);
        listed.bytes("b", [9]);
        let mut expected = Vec::new();
        listed.finish(&mut expected).unwrap();
        let write = |most: i64| {
            let mut given = Document::new("PolyData");
            given.given_floats("x", 3, 3, |take| {
                [1.0, 2.0, 3.0].into_iter().try_for_each(take)
            });
            given.given_integers("n", 2, move |take| (7..most).try_for_each(take));
            given.given_bytes("b", 1, |take| take(9));
            let mut bytes = Vec::new();
            given.finish(&mut bytes).map(|()| bytes)
        };
        assert!(write(9).unwrap() == expected);
        let refused = write(8).unwrap_err().to_string();
        assert!(
            refused.contains("1 values of 2") && refused.contains("\"n\""),
            "{refused}"
        );
    }

    #[test]
    fn offsets_point_to_the_arrays() {
        let mut document = Document::new("PolyData");
        document.bytes("first", [1, 2, 3]);
        document.integers("second", [7]);
        let mut bytes = Vec::new();
        document.finish(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        // 8 + 3 bytes take 16 characters with padding.
        assert!(text.contains(
            "Name=\"second\" NumberOfComponents=\"1\" format=\"appended\" offset=\"16\""
        ));
        let data = text.split("\n_").nth(1).unwrap();
        assert!(data.starts_with("AwAAAAAAAAABAgM=CAAAAAAAAAAHAAAAAAAAAA=="));
    }
}
