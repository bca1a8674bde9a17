//! STL, ASCII and binary.
//!
//! STL files consist of loose triangles. Reading welds vertices within
//! [`LOOSE_WELD`](crate::repair::LOOSE_WELD) of the diagonal, and merges coplanar neighbours into polygon faces
//! ([`Polyhedron::with_merged_faces`]), so that a cube has 6 faces. Binary files have single precision:
//! coordinates are accurate to 6e-8 of the largest. Normals and attributes are ignored; messages count facets
//! as in the file, from 0.

use super::text::{Lines, point, problem, shortened, without_mark, words};
use super::{Facets, Format, MAX_FILE_BYTES, Options, posed_vertices, read_limited};
use crate::{MeshError, Point3, Polyhedron, Pose, Vector3};
use std::io::{Read, Write};

const HEADER_BYTES: usize = 80;
const TRIANGLE_BYTES: usize = 50;

/// Keywords of lines that contain no corners.
const OTHER_KEYWORDS: [&[u8]; 5] = [b"outer", b"endloop", b"endfacet", b"facet", b"solid"];

/// Reads a body, ASCII or binary.
///
/// A file is binary if its length matches the number of triangles at byte 80, else ASCII if it starts with
/// "solid", in any case and with or without a byte order mark.
///
/// # Errors
///
/// If reading fails, a coordinate is not a finite number, the length of a binary file is not what
/// its header promises, or the triangles do not make one closed surface.
pub fn read(reader: impl Read) -> Result<Polyhedron, MeshError> {
    parse(&read_limited(reader, MAX_FILE_BYTES)?)
}

/// Reads a body from the bytes of an STL file, as [`read`].
///
/// # Errors
///
/// As [`read`].
pub fn parse(bytes: &[u8]) -> Result<Polyhedron, MeshError> {
    super::parse(bytes, Format::Stl, &Options::default()).map(|(body, _)| body)
}

pub(super) fn facets(bytes: &[u8]) -> Result<Facets, MeshError> {
    let promised = bytes.get(HEADER_BYTES..HEADER_BYTES + 4);
    let promised = promised
        .and_then(|b| b.try_into().ok())
        .map(u32::from_le_bytes);
    let expected = |n: u32| (HEADER_BYTES + 4) as u64 + u64::from(n) * TRIANGLE_BYTES as u64;
    let points = match promised {
        Some(n) if expected(n) == bytes.len() as u64 => binary_corners(&bytes[HEADER_BYTES + 4..]),
        // A binary file may begin with "solid", too, and have an extra byte.
        _ if is_text(bytes) && !bytes.contains(&0) => ascii_corners(bytes)?,
        Some(promised) => {
            return Err(MeshError::StlLength {
                promised,
                expected: expected(promised),
                found: bytes.len() as u64,
            });
        }
        None => {
            return Err(MeshError::Empty {
                what: "STL: neither \"solid\" nor a binary header",
            });
        }
    };
    if points.is_empty() {
        return Err(MeshError::Empty { what: "triangles" });
    }
    let corners: Vec<u32> = (0..points.len() as u32).collect();
    let loops = corners.chunks_exact(3).map(<[u32]>::to_vec).collect();
    Ok(Facets { points, loops })
}

fn is_text(bytes: &[u8]) -> bool {
    let text = without_mark(bytes).trim_ascii_start();
    text.get(..5)
        .is_some_and(|start| start.eq_ignore_ascii_case(b"solid"))
}

fn binary_corners(triangles: &[u8]) -> Vec<Point3> {
    let float =
        |bytes: &[u8]| f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    triangles
        .chunks_exact(TRIANGLE_BYTES)
        .flat_map(|triangle| triangle[12..48].chunks_exact(12))
        .map(|p| Point3::new(float(&p[0..4]), float(&p[4..8]), float(&p[8..12])))
        .collect()
}

/// Corners, three for each facet.
fn ascii_corners(bytes: &[u8]) -> Result<Vec<Point3>, MeshError> {
    let mut corners = Vec::new();
    let mut ended = false;
    let mut lines = Lines::new(bytes, None);
    while let Some((line, content)) = lines.filled() {
        let mut words = words(content);
        let word = words.next().unwrap_or_default();
        let is = |keyword: &[u8]| word.eq_ignore_ascii_case(keyword);
        if is(b"vertex") {
            corners.push(point(&mut words, line)?);
        } else if is(b"endfacet") && corners.len() % 3 != 0 {
            return Err(problem(line, "a facet ends that has not 3 vertices"));
        } else if is(b"endsolid") {
            ended = true;
        } else if !OTHER_KEYWORDS.iter().any(|keyword| is(keyword)) {
            let word = shortened(word);
            let what = format!("\"{word}\" is not part of an ASCII STL file");
            return Err(problem(line, what));
        }
    }
    if !ended || corners.len() % 3 != 0 {
        let what = "the file ends without \"endsolid\" or amid a facet: it is cut off";
        return Err(problem(lines.number, what));
    }
    Ok(corners)
}

/// Writes a body as binary STL.
///
/// # Errors
///
/// As [`write_binary_posed`].
pub fn write_binary(body: &Polyhedron, writer: impl Write) -> Result<(), MeshError> {
    write_binary_posed([(body, &Pose::identity())], writer)
}

/// Writes bodies in their poses as one binary STL.
///
/// # Errors
///
/// If writing fails, a pose is not finite or not a rigid motion, there are more than 2^32 - 1 triangles, or a
/// coordinate is too large for single precision.
pub fn write_binary_posed<'a>(
    bodies: impl IntoIterator<Item = (&'a Polyhedron, &'a Pose)>,
    mut writer: impl Write,
) -> Result<(), MeshError> {
    let mut buffer = Vec::new();
    let mut count = 0;
    for (body, pose) in bodies {
        for (normal, corners) in triangles(body, pose)? {
            for value in std::iter::once(normal.into())
                .chain(corners)
                .flat_map(single)
            {
                if !value.is_finite() {
                    return Err(MeshError::OutOfRange {
                        what: "a coordinate to write to binary STL",
                        value: f64::from(value),
                        allowed: "-3e38 to 3e38",
                    });
                }
                buffer.extend_from_slice(&value.to_le_bytes());
            }
            buffer.extend_from_slice(&[0; 2]);
            count += 1;
        }
    }
    let count = u32::try_from(count).map_err(|_| MeshError::TooMany {
        what: "triangles for binary STL",
        count,
        allowed: u32::MAX as usize,
    })?;
    let mut header = [0; HEADER_BYTES];
    let title = b"binary STL written by femdem, lengths in metres";
    header[..title.len()].copy_from_slice(title);
    writer.write_all(&header)?;
    writer.write_all(&count.to_le_bytes())?;
    writer.write_all(&buffer)?;
    writer.flush()?;
    Ok(())
}

/// Writes a body as ASCII STL, with all digits of its coordinates.
///
/// # Errors
///
/// If writing fails.
pub fn write_ascii(body: &Polyhedron, writer: impl Write) -> Result<(), MeshError> {
    write_ascii_posed([(body, &Pose::identity())], writer)
}

/// Writes bodies in their poses as one ASCII STL solid.
///
/// # Errors
///
/// If writing fails, or a pose is not finite or not a rigid motion.
pub fn write_ascii_posed<'a>(
    bodies: impl IntoIterator<Item = (&'a Polyhedron, &'a Pose)>,
    mut writer: impl Write,
) -> Result<(), MeshError> {
    writeln!(writer, "solid femdem")?;
    for (body, pose) in bodies {
        for (n, corners) in triangles(body, pose)? {
            writeln!(
                writer,
                "  facet normal {} {} {}\n    outer loop",
                n.x, n.y, n.z
            )?;
            for p in corners {
                writeln!(writer, "      vertex {} {} {}", p.x, p.y, p.z)?;
            }
            writeln!(writer, "    endloop\n  endfacet")?;
        }
    }
    writeln!(writer, "endsolid femdem")?;
    writer.flush()?;
    Ok(())
}

/// Unit normal and corners of each triangle of a body in its pose.
fn triangles(
    body: &Polyhedron,
    pose: &Pose,
) -> Result<impl Iterator<Item = (Vector3, [Point3; 3])> + use<>, MeshError> {
    let vertices = posed_vertices(body, pose)?;
    Ok(body.triangles().into_iter().map(move |triangle| {
        let [a, b, c] = triangle.map(|i| vertices[i as usize]);
        let normal = (b - a).cross(&(c - a));
        (normal.try_normalize(0.0).unwrap_or_default(), [a, b, c])
    }))
}

fn single(p: Point3) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

#[cfg(test)]
mod tests;
