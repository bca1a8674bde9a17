//! OFF, the Object File Format of Geomview, in ASCII.
//!
//! The headers `OFF`, `COFF`, `NOFF`, `STOFF` and their combinations (or none), the three counts, and one line
//! for each vertex and face are read; colours, normals and texture coordinates are skipped, comments start with
//! `#`. Vertices of equal coordinates are welded.

use super::text::{Lines, count, number, point, problem, shortened, words};
use super::{Facets, Format, MAX_FILE_BYTES, Options, read_limited, write_lists};
use crate::{MeshError, Polyhedron};
use std::io::{Read, Write};

/// Reads a body.
///
/// # Errors
///
/// As [`parse`]; also if reading fails or the file is larger than
/// [`MAX_FILE_BYTES`].
pub fn read(reader: impl Read) -> Result<Polyhedron, MeshError> {
    parse(read_limited(reader, MAX_FILE_BYTES)?)
}

/// Reads a body from text.
///
/// # Errors
///
/// If the file is binary or of another dimension, ends early, contains a line that cannot be read (the message
/// names it), or its faces do not form one closed surface.
pub fn parse(text: impl AsRef<[u8]>) -> Result<Polyhedron, MeshError> {
    super::parse(text.as_ref(), Format::Off, &Options::default()).map(|(body, _)| body)
}

pub(super) fn facets(bytes: &[u8]) -> Result<Facets, MeshError> {
    let mut lines = Lines::new(bytes, Some(b'#'));
    let (vertices, faces) = header(&mut lines)?;
    let mut points = Vec::new();
    while (points.len() as u64) < vertices {
        let (line, content) = lines.filled().ok_or(MeshError::CutOff {
            what: "vertices",
            promised: vertices,
            found: points.len() as u64,
        })?;
        points.push(point(&mut words(content), line)?);
    }
    let mut loops = Vec::new();
    while (loops.len() as u64) < faces {
        let (line, content) = lines.filled().ok_or(MeshError::CutOff {
            what: "faces",
            promised: faces,
            found: loops.len() as u64,
        })?;
        loops.push(face(content, line)?);
    }
    if loops.is_empty() {
        return Err(MeshError::Empty { what: "faces" });
    }
    Ok(Facets { points, loops })
}

/// Numbers of vertices and faces.
fn header(lines: &mut Lines) -> Result<(u64, u64), MeshError> {
    let nothing = MeshError::Empty {
        what: "OFF: neither a header nor counts",
    };
    let Some((mut line, mut content)) = lines.filled() else {
        return Err(nothing);
    };
    let mut all = words(content).peekable();
    if let Some(&word) = all.peek()
        && !word[0].is_ascii_digit()
        && word[0] != b'-'
    {
        all.next();
        let prefix = word.strip_suffix(b"OFF").ok_or_else(|| {
            let what = format!("\"{}\" is no OFF header", shortened(word));
            problem(line, what)
        })?;
        if all.peek() == Some(&&b"BINARY"[..]) {
            return Err(MeshError::Unsupported {
                what: "binary OFF data".to_owned(),
                advice: "save it as ASCII OFF or as PLY",
            });
        }
        if !matches!(
            prefix,
            b"" | b"C" | b"N" | b"ST" | b"CN" | b"STC" | b"STN" | b"STCN"
        ) {
            return Err(MeshError::Unsupported {
                what: format!("the header \"{}\"", shortened(word)),
                advice: "vertices must have three coordinates",
            });
        }
        if all.peek().is_none() {
            (line, content) = lines.filled().ok_or(nothing)?;
            all = words(content).peekable();
        }
    }
    // The third count, of edges, is often wrong or left out.
    let vertices = count(all.next(), "vertices", line)?;
    Ok((vertices, count(all.next(), "faces", line)?))
}

fn face(content: &[u8], line: usize) -> Result<Vec<u32>, MeshError> {
    let mut words = words(content);
    let corners = count(words.next(), "corners of a face", line)?;
    if corners < 3 {
        let has = format!("a face needs at least 3 vertices, this one has {corners}");
        return Err(problem(line, has));
    }
    let mut face = Vec::new();
    while (face.len() as u64) < corners {
        let found = face.len();
        let word = words.next().ok_or_else(|| {
            problem(
                line,
                format!("the face has {corners} corners, found {found}"),
            )
        })?;
        face.push(number(word).ok_or_else(|| {
            let what = format!(
                "\"{}\" is no vertex number: a whole number from 0",
                shortened(word)
            );
            problem(line, what)
        })?);
    }
    Ok(face)
}

/// Writes a body, with all digits of its coordinates.
///
/// # Errors
///
/// If writing fails.
pub fn write(body: &Polyhedron, mut writer: impl Write) -> Result<(), MeshError> {
    let (vertices, faces) = (body.vertices().len(), body.face_count());
    writeln!(writer, "OFF\n{vertices} {faces} {}", body.edges().len())?;
    write_lists(body, writer)
}

#[cfg(test)]
mod tests;
