//! The header, which describes the data.

use super::values::{Encoding, Scalar, Values};
use crate::MeshError;
use crate::io::text::{Lines, count, problem, shortened, words};

/// The contents of the header, and the data after it.
pub(super) struct Header<'a> {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    pub(super) values: Values<'a>,
}

pub(super) struct Element {
    pub(super) name: Vec<u8>,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Property {
    pub(super) name: Vec<u8>,
    pub(super) kind: Kind,
}

#[derive(Clone, Copy)]
pub(super) enum Kind {
    Scalar(Scalar),
    /// Types of the length and of the items.
    List(Scalar, Scalar),
}

impl Element {
    /// The error for data that end within this element.
    pub(super) fn cut_off(&self, found: u64) -> MeshError {
        MeshError::CutOff {
            what: match self.name.as_slice() {
                b"vertex" => "vertices",
                b"face" => "faces",
                _ => "items of another element",
            },
            promised: self.count,
            found,
        }
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Header<'_>, MeshError> {
    let mut lines = Lines::new(bytes, None);
    let magic = lines.next().map(|(_, line)| line.trim_ascii());
    if magic != Some(b"ply") {
        return Err(MeshError::Empty {
            what: "PLY: its first line is not \"ply\"",
        });
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some((line, content)) = lines.next() {
        let mut all = words(content);
        match all.next().unwrap_or_default() {
            b"format" => encoding = Some(Encoding::named(all.next().unwrap_or_default(), line)?),
            b"element" => elements.push(Element {
                name: all.next().unwrap_or_default().to_vec(),
                count: count(all.next(), "items", line)?,
                properties: Vec::new(),
            }),
            b"property" => {
                let property = property(&mut all, line)?;
                match elements.last_mut() {
                    Some(element) => element.properties.push(property),
                    None => return Err(problem(line, "a property stands before any element")),
                }
            }
            b"comment" | b"obj_info" | b"" => {}
            b"end_header" => {
                let encoding = encoding.ok_or_else(|| {
                    problem(line, "the header has no line that starts with format")
                })?;
                let values = Values::new(lines.clone(), encoding);
                return Ok(Header {
                    encoding,
                    elements,
                    values,
                });
            }
            word => {
                let what = format!("\"{}\" is not part of a PLY header", shortened(word));
                return Err(problem(line, what));
            }
        }
    }
    Err(problem(
        lines.number,
        "the header has no line \"end_header\"",
    ))
}

fn property<'a>(
    words: &mut impl Iterator<Item = &'a [u8]>,
    line: usize,
) -> Result<Property, MeshError> {
    let mut next = || words.next().unwrap_or_default();
    let kind = match next() {
        b"list" => Kind::List(Scalar::named(next(), line)?, Scalar::named(next(), line)?),
        scalar => Kind::Scalar(Scalar::named(scalar, line)?),
    };
    Ok(Property {
        name: next().to_vec(),
        kind,
    })
}
