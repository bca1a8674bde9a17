//! PLY, the Polygon File Format of Stanford: ASCII, binary little endian and binary big endian.
//!
//! The properties `x`, `y`, `z` of the element `vertex` and the list `vertex_indices` (or `vertex_index`) of
//! the element `face` are read, of any type and in any order among others; other elements are skipped. Vertices
//! of equal coordinates are welded.

mod header;
mod values;

use super::{Facets, Format, MAX_FILE_BYTES, Options, read_limited, write_lists};
use crate::{MeshError, Point3, Polyhedron};
use header::{Element, Header, Kind, Property};
use std::io::{Read, Write};
use values::Values;

/// Reads a body.
///
/// # Errors
///
/// As [`parse`]; also if reading fails or the file is larger than
/// [`MAX_FILE_BYTES`].
pub fn read(reader: impl Read) -> Result<Polyhedron, MeshError> {
    parse(&read_limited(reader, MAX_FILE_BYTES)?)
}

/// Reads a body from the bytes of a PLY file.
///
/// # Errors
///
/// If the header cannot be read (the message names the line) or has no vertices or faces, the data end early or
/// contain an invalid number, or the faces do not form one closed surface.
pub fn parse(bytes: &[u8]) -> Result<Polyhedron, MeshError> {
    super::parse(bytes, Format::Ply, &Options::default()).map(|(body, _)| body)
}

pub(super) fn facets(bytes: &[u8]) -> Result<Facets, MeshError> {
    let Header {
        encoding,
        elements,
        mut values,
    } = header::read(bytes)?;
    let (mut points, mut loops) = (Vec::new(), Vec::new());
    for element in &elements {
        match element.name.as_slice() {
            b"vertex" => points = read_points(element, &mut values)?,
            b"face" => loops = read_loops(element, &mut values)?,
            b"tristrips" => {
                return Err(MeshError::Unsupported {
                    what: "triangle strips".to_owned(),
                    advice: "save it with faces",
                });
            }
            _ => skip(element, &mut values)?,
        }
    }
    let what = match (points.is_empty(), loops.is_empty()) {
        (true, _) => "vertices",
        (_, true) => "faces",
        _ => {
            values.check_end(encoding)?;
            return Ok(Facets { points, loops });
        }
    };
    Err(MeshError::Empty { what })
}

fn read_points(element: &Element, values: &mut Values) -> Result<Vec<Point3>, MeshError> {
    let find = |name: &[u8]| {
        let at = element.properties.iter().position(|p| p.name == name);
        at.filter(|&i| matches!(element.properties[i].kind, Kind::Scalar(_)))
            .ok_or(MeshError::Empty {
                what: "coordinates: the vertices need the properties x, y and z",
            })
    };
    let axes = [find(b"x")?, find(b"y")?, find(b"z")?];
    let mut points = Vec::new();
    while (points.len() as u64) < element.count {
        let mut at = Point3::origin();
        for (i, property) in element.properties.iter().enumerate() {
            let found = points.len() as u64;
            match property.kind {
                Kind::Scalar(scalar) => {
                    let value = values.scalar(scalar, || element.cut_off(found))?;
                    for axis in (0..3).filter(|&axis| axes[axis] == i) {
                        at[axis] = value;
                    }
                }
                Kind::List(..) => skip_property(property, values, || element.cut_off(found))?,
            }
        }
        points.push(at);
    }
    Ok(points)
}

fn read_loops(element: &Element, values: &mut Values) -> Result<Vec<Vec<u32>>, MeshError> {
    let is_loop = |p: &Property| {
        matches!(p.kind, Kind::List(..))
            && matches!(&p.name[..], b"vertex_indices" | b"vertex_index")
    };
    let Some(at) = element.properties.iter().position(is_loop) else {
        return Err(MeshError::Empty {
            what: "faces: the element face needs the list vertex_indices",
        });
    };
    let mut loops = Vec::new();
    while (loops.len() as u64) < element.count {
        let face = loops.len();
        let cut_off = || element.cut_off(face as u64);
        let mut corners = Vec::new();
        for (i, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List(length, item) if i == at => {
                    for _ in 0..values.whole(length, cut_off)? {
                        corners.push(values.whole(item, cut_off)?);
                    }
                }
                _ => skip_property(property, values, cut_off)?,
            }
        }
        if corners.len() < 3 {
            return Err(MeshError::FaceTooShort {
                face,
                count: corners.len(),
            });
        }
        loops.push(corners);
    }
    Ok(loops)
}

fn skip(element: &Element, values: &mut Values) -> Result<(), MeshError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    // Every property takes at least a byte, so that the end of the file ends the loop.
    for found in 0..element.count {
        for property in &element.properties {
            skip_property(property, values, || element.cut_off(found))?;
        }
    }
    Ok(())
}

fn skip_property(
    property: &Property,
    values: &mut Values,
    cut_off: impl Fn() -> MeshError,
) -> Result<(), MeshError> {
    match property.kind {
        Kind::Scalar(scalar) => values.scalar(scalar, cut_off).map(|_| ()),
        Kind::List(length, item) => {
            for _ in 0..values.whole(length, &cut_off)? {
                values.scalar(item, &cut_off)?;
            }
            Ok(())
        }
    }
}

/// Writes a body as ASCII PLY, with all digits of its coordinates.
///
/// # Errors
///
/// If writing fails.
pub fn write(body: &Polyhedron, mut writer: impl Write) -> Result<(), MeshError> {
    let (vertices, faces) = (body.vertices().len(), body.face_count());
    writeln!(writer, "ply\nformat ascii 1.0\ncomment lengths in metres")?;
    writeln!(writer, "element vertex {vertices}")?;
    for axis in ["x", "y", "z"] {
        writeln!(writer, "property double {axis}")?;
    }
    writeln!(writer, "element face {faces}")?;
    writeln!(writer, "property list uint uint vertex_indices\nend_header")?;
    write_lists(body, writer)
}

#[cfg(test)]
mod tests;
