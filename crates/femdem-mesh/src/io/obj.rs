//! Wavefront OBJ.
//!
//! Vertices (`v x y z`) and faces (`f 1 2 3`, `f 1/1 2/2 3/3`, `f 1//1 2//2 3//3`, negative indices counting
//! back from the latest vertex) are read. Texture coordinates, normals, groups, objects, materials and
//! smoothing are skipped. All faces of the file together must form one closed surface. Vertices of equal
//! coordinates are welded, vertices that no face uses are dropped.

use super::text::{Lines, number, point, problem, shortened, words};
use super::{Facets, Format, MAX_FILE_BYTES, Options, posed_vertices, read_limited};
use crate::{MeshError, Polyhedron, Pose};
use std::io::{BufRead, Write};

/// Reads a body.
///
/// # Errors
///
/// As [`parse`]; also if reading fails or the file is larger than
/// [`MAX_FILE_BYTES`].
pub fn read(reader: impl BufRead) -> Result<Polyhedron, MeshError> {
    parse(read_limited(reader, MAX_FILE_BYTES)?)
}

/// Reads a body from text. Names of groups and materials may be in any encoding.
///
/// # Errors
///
/// If a vertex or face cannot be read (the message names the line), there are none, or they do not form one
/// closed surface; several closed surfaces in one file are [`MeshError::Disconnected`],
/// [`MeshError::Touching`] or, one inside another, [`MeshError::Hollow`].
pub fn parse(text: impl AsRef<[u8]>) -> Result<Polyhedron, MeshError> {
    super::parse(text.as_ref(), Format::Obj, &Options::default()).map(|(body, _)| body)
}

pub(super) fn facets(bytes: &[u8]) -> Result<Facets, MeshError> {
    let mut points = Vec::new();
    let mut loops = Vec::new();
    let mut loop_lines = Vec::new();
    let mut lines = Lines::new(bytes, Some(b'#'));
    while let Some((line, content)) = lines.next() {
        // A backslash at the end of a line joins the next one to it.
        let mut joined;
        let mut content = content;
        if continues(content).is_some() {
            joined = content.to_vec();
            while let Some(start) = continues(&joined) {
                joined.truncate(start);
                joined.extend_from_slice(b" ");
                joined.extend_from_slice(lines.next().map_or(b"", |(_, next)| next));
            }
            content = &joined;
        }
        let mut words = words(content);
        match words.next() {
            Some(b"v") => points.push(point(&mut words, line)?),
            Some(b"f") => {
                loops.push(face(words, points.len(), line)?);
                loop_lines.push(line);
            }
            _ => {}
        }
    }
    if points.is_empty() {
        return Err(MeshError::Empty {
            what: "vertices (lines that start with v)",
        });
    }
    if loops.is_empty() {
        return Err(MeshError::Empty {
            what: "faces (lines that start with f)",
        });
    }
    // A face may stand before its vertices, so that indices are compared with all of them.
    let count = points.len();
    for (corners, &line) in loops.iter().zip(&loop_lines) {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= count) {
            let number = u64::from(index) + 1;
            let names = format!("the face names vertex {number}, but the file has only {count}");
            return Err(problem(line, names));
        }
    }
    Ok(Facets { points, loops })
}

/// The position of a backslash that ends the line.
fn continues(line: &[u8]) -> Option<usize> {
    let line = line.trim_ascii_end();
    let before = line.strip_suffix(b"\\")?;
    let own_word = before.last().is_none_or(u8::is_ascii_whitespace);
    own_word.then_some(before.len())
}

fn face<'a>(
    words: impl Iterator<Item = &'a [u8]>,
    vertex_count: usize,
    line: usize,
) -> Result<Vec<u32>, MeshError> {
    let corners: Vec<u32> = words
        .map(|word| corner(word, vertex_count, line))
        .collect::<Result<_, _>>()?;
    if corners.len() < 3 {
        let has = format!("a face needs at least 3 vertices, found {}", corners.len());
        return Err(problem(line, has));
    }
    Ok(corners)
}

/// Index of the vertex, from 0, of "7", "7/1", "7/1/3", "7//3" or "-1".
fn corner(word: &[u8], vertex_count: usize, line: usize) -> Result<u32, MeshError> {
    let bad = |what: &str| problem(line, format!("face corner \"{}\" {what}", shortened(word)));
    let index = word.split(|&b| b == b'/').next().unwrap_or_default();
    let index: i64 = number(index).ok_or_else(|| bad("does not start with a vertex number"))?;
    let from_zero = match index {
        1.. => index - 1,
        0 => return Err(bad("is zero: vertices count from 1")),
        _ => index.saturating_add(vertex_count as i64),
    };
    u32::try_from(from_zero).map_err(|_| {
        bad(&format!(
            "names no vertex: {vertex_count} vertices stand before this line"
        ))
    })
}

/// Writes a body, with all digits of its coordinates.
///
/// # Errors
///
/// If writing fails.
pub fn write(body: &Polyhedron, writer: impl Write) -> Result<(), MeshError> {
    write_posed([(body, &Pose::identity())], writer)
}

/// Writes bodies in their poses, each as a separate object: `o body_0`, `o body_1`, ...
///
/// # Errors
///
/// If writing fails, or a pose is not finite or not a rigid motion.
pub fn write_posed<'a>(
    bodies: impl IntoIterator<Item = (&'a Polyhedron, &'a Pose)>,
    mut writer: impl Write,
) -> Result<(), MeshError> {
    let mut first = 1;
    for (i, (body, pose)) in bodies.into_iter().enumerate() {
        writeln!(writer, "o body_{i}")?;
        for p in posed_vertices(body, pose)? {
            writeln!(writer, "v {} {} {}", p.x, p.y, p.z)?;
        }
        for face in body.faces() {
            write!(writer, "f")?;
            for &v in face {
                write!(writer, " {}", first + u64::from(v))?;
            }
            writeln!(writer)?;
        }
        first += body.vertices().len() as u64;
    }
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests;
