//! Wavefront OBJ.
//!
//! Read are vertices (`v x y z`) and faces (`f 1 2 3`, `f 1/1 2/2 3/3`, `f 1//1 2//2 3//3`,
//! negative indices counting back from the latest vertex). Texture coordinates, normals, groups,
//! objects, materials and smoothing are passed over. All faces of the file together must be one
//! closed surface. Vertices that no face uses are dropped.

use super::{MAX_FILE_BYTES, coordinate, posed_vertices, read_limited, shortened};
use crate::{MeshError, Point3, Polyhedron, Pose};
use std::io::{BufRead, Write};

/// Reads a body.
///
/// # Errors
///
/// As [`parse`]; also if reading fails or the file is larger than
/// [`MAX_FILE_BYTES`].
pub fn read(reader: impl BufRead) -> Result<Polyhedron, MeshError> {
    let bytes = read_limited(reader, MAX_FILE_BYTES)?;
    // Names of groups and materials may be in any encoding; they are passed over.
    parse(&String::from_utf8_lossy(&bytes))
}

/// Reads a body from text.
///
/// # Errors
///
/// If a vertex or face cannot be read (the message names the line), there are none, or they do not
/// make a valid [`Polyhedron`]; several closed surfaces in one file are
/// [`MeshError::Disconnected`].
pub fn parse(text: &str) -> Result<Polyhedron, MeshError> {
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    let mut face_lines = Vec::new();
    let mut numbered = text.lines().enumerate().map(|(i, line)| (i + 1, line));
    while let Some((line, content)) = numbered.next() {
        let content = content.split('#').next().unwrap_or_default();
        let mut words: Vec<&str> = content.split_whitespace().collect();
        // A backslash at the end of a line joins the next one to it.
        while words.last() == Some(&"\\") {
            words.pop();
            let next = numbered.next().map_or("", |(_, next)| next);
            words.extend(
                next.split('#')
                    .next()
                    .unwrap_or_default()
                    .split_whitespace(),
            );
        }
        match words.split_first() {
            Some((&"v", numbers)) => vertices.push(vertex(numbers, line)?),
            Some((&"f", corners)) => {
                faces.push(face(corners, vertices.len(), line)?);
                face_lines.push(line);
            }
            _ => {}
        }
    }
    if vertices.is_empty() {
        return Err(MeshError::Empty {
            what: "vertices (lines that start with v)",
        });
    }
    if faces.is_empty() {
        return Err(MeshError::Empty {
            what: "faces (lines that start with f)",
        });
    }
    // A face may stand before its vertices, so that indices are compared with all of them.
    let count = vertices.len();
    for (corners, &line) in faces.iter().zip(&face_lines) {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= count) {
            let number = u64::from(index) + 1;
            let problem = format!("the face names vertex {number}, but the file has only {count}");
            return Err(MeshError::Parse { line, problem });
        }
    }
    let (vertices, faces) = crate::merge::compact(&vertices, &faces);
    Polyhedron::new(vertices, faces)
}

/// Coordinates, of which there may be a fourth (weight) or three more (colour).
fn vertex(words: &[&str], line: usize) -> Result<Point3, MeshError> {
    let [x, y, z, ..] = words else {
        return Err(MeshError::Parse {
            line,
            problem: format!("a vertex needs 3 coordinates, found {}", words.len()),
        });
    };
    Ok(Point3::new(
        coordinate(x, line)?,
        coordinate(y, line)?,
        coordinate(z, line)?,
    ))
}

fn face(words: &[&str], vertex_count: usize, line: usize) -> Result<Vec<u32>, MeshError> {
    words
        .iter()
        .map(|word| corner(word, vertex_count, line))
        .collect()
}

/// Index of the vertex, from 0, of "7", "7/1", "7/1/3", "7//3" or "-1".
fn corner(word: &str, vertex_count: usize, line: usize) -> Result<u32, MeshError> {
    let problem = |problem: &str| MeshError::Parse {
        line,
        problem: format!("face corner \"{}\" {problem}", shortened(word)),
    };
    let index = word.split('/').next().unwrap_or_default();
    let index: i64 = index
        .parse()
        .map_err(|_| problem("does not start with a vertex number"))?;
    let from_zero = match index {
        1.. => index - 1,
        0 => return Err(problem("is zero: vertices count from 1")),
        _ => index.saturating_add(vertex_count as i64),
    };
    u32::try_from(from_zero).map_err(|_| {
        problem(&format!(
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

/// Writes bodies in their poses, each as an object of its own: `o body_0`, `o body_1`, ...
///
/// # Errors
///
/// If writing fails or a pose is not finite.
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
