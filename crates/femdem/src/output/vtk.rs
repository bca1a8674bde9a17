//! The XML frame that VTU, VTP and VTI share: arrays in one appended block, base64.
//!
//! VTK XML, version 1.0: an appended array is a 64-bit count of bytes followed by the bytes, little
//! endian; each is encoded by itself, and `offset` counts characters from the underscore.

use std::fmt::Write as _;
use std::io::{self, Write};

/// The document under construction: the XML before the data, and the data.
pub(crate) struct Document {
    kind: &'static str,
    attributes: String,
    xml: String,
    data: String,
}

impl Document {
    /// A document of VTK type "UnstructuredGrid", "PolyData" or "ImageData".
    pub fn new(kind: &'static str) -> Self {
        Self {
            kind,
            attributes: String::new(),
            xml: String::new(),
            data: String::new(),
        }
    }

    /// Attributes of the element that has the type's name, each with a space before it.
    pub fn with_attributes(mut self, attributes: String) -> Self {
        self.attributes = attributes;
        self
    }

    /// A line of XML.
    pub fn line(&mut self, text: &str) {
        self.xml.push_str(text);
        self.xml.push('\n');
    }

    pub fn floats(&mut self, name: &str, components: usize, values: impl IntoIterator<Item = f64>) {
        let bytes = values.into_iter().flat_map(f64::to_le_bytes).collect();
        self.array("Float64", name, components, bytes);
    }

    pub fn integers(&mut self, name: &str, values: impl IntoIterator<Item = i64>) {
        let bytes = values.into_iter().flat_map(i64::to_le_bytes).collect();
        self.array("Int64", name, 1, bytes);
    }

    pub fn bytes(&mut self, name: &str, values: impl IntoIterator<Item = u8>) {
        self.array("UInt8", name, 1, values.into_iter().collect());
    }

    fn array(&mut self, kind: &str, name: &str, components: usize, content: Vec<u8>) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{}\"/>",
            self.data.len()
        );
        let mut block = (content.len() as u64).to_le_bytes().to_vec();
        block.extend_from_slice(&content);
        encode(&block, &mut self.data);
    }

    pub fn finish(self, mut writer: impl Write) -> io::Result<()> {
        let (kind, attributes) = (self.kind, &self.attributes);
        write!(
            writer,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<{kind}{attributes}>\n{}</{kind}>\n\
             <AppendedData encoding=\"base64\">\n_",
            self.xml
        )?;
        writer.write_all(self.data.as_bytes())?;
        writer.write_all(b"\n</AppendedData>\n</VTKFile>\n")
    }
}

/// Base64 with padding (RFC 4648).
pub(super) fn encode(bytes: &[u8], out: &mut String) {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    out.reserve(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * i) & 63) as usize];
            out.push(if i <= group.len() {
                char::from(digit)
            } else {
                '='
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 4648, section 10.
    #[test]
    fn base64_of_the_published_vectors() {
        for (bytes, expected) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            let mut out = String::new();
            encode(bytes.as_bytes(), &mut out);
            assert_eq!(out, expected);
        }
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
