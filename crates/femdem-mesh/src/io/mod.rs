//! Files: surfaces as Wavefront OBJ, STL, OFF and PLY; meshes of tetrahedra for Gmsh and as VTU.
//!
//! Surfaces are welded, oriented and checked, see [`repair`](crate::repair): a file holds one closed surface,
//! or the error names the facets at fault, counted from 0.
//!
//! Files may be hostile. At most [`MAX_FILE_BYTES`] are read, and counts in headers are not trusted before the
//! items have been read. Memory is bounded by a constant times the length of the file, and time by that times
//! its logarithm; polygons have at most [`MAX_FACET_CORNERS`] corners.

pub mod msh;
pub mod obj;
pub mod off;
pub mod ply;
pub mod stl;
mod text;
pub mod vtu;

pub use crate::repair::{FacetList, Options, Orient, Report};

use crate::pose::checked_pose;
use crate::repair::{LOOSE_WELD, close};
use crate::{MeshError, Point3, Polyhedron, Pose};
use std::fs::File;
use std::io::{BufReader, Read, Write};
use std::path::Path;

/// Largest file that is read \[bytes\].
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Most corners of a polygon in a file.
pub const MAX_FACET_CORNERS: usize = 1 << 10;

/// A format of surface files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, `.obj`.
    Obj,
    /// STL, ASCII or binary, `.stl`.
    Stl,
    /// Object File Format of Geomview, `.off`.
    Off,
    /// Polygon File Format of Stanford, ASCII or binary, `.ply`.
    Ply,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::Obj, Self::Stl, Self::Off, Self::Ply];

    /// The format of a file, from its extension, in any case.
    ///
    /// # Errors
    ///
    /// [`MeshError::UnknownFormat`] for any other extension.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let ending = path.extension().unwrap_or_default().to_string_lossy();
        match ending.to_ascii_lowercase().as_str() {
            "obj" => Ok(Self::Obj),
            "stl" => Ok(Self::Stl),
            "off" => Ok(Self::Off),
            "ply" => Ok(Self::Ply),
            _ => Err(MeshError::UnknownFormat {
                path: path.to_path_buf(),
            }),
        }
    }
}

/// Vertices and loops of vertex numbers as in the file.
struct Facets {
    points: Vec<Point3>,
    loops: Vec<Vec<u32>>,
}

/// Reads a body from a file; its extension, .obj, .stl, .off or .ply in any case, determines the format.
///
/// # Errors
///
/// If the extension is another one, the file cannot be read, or it does not hold one closed surface; the
/// message names the file.
pub fn read_file(path: impl AsRef<Path>) -> Result<Polyhedron, MeshError> {
    read_file_with(path, &Options::default()).map(|(body, _)| body)
}

/// Reads a body from a file as [`read_file`], with options, and reports what was done to it.
///
/// # Errors
///
/// As [`read_file`]; also if the options are out of range.
pub fn read_file_with(
    path: impl AsRef<Path>,
    options: &Options,
) -> Result<(Polyhedron, Report), MeshError> {
    let path = path.as_ref();
    let format = Format::of_path(path)?;
    File::open(path)
        .map_err(MeshError::from)
        .and_then(|file| read(BufReader::new(file), format, options))
        .map_err(|problem| MeshError::InFile {
            path: path.to_path_buf(),
            problem: Box::new(problem),
        })
}

/// Reads a body in a format, with options, and reports what was done to it.
///
/// # Errors
///
/// If reading fails, there are more than [`MAX_FILE_BYTES`], or as [`parse`].
pub fn read(
    reader: impl Read,
    format: Format,
    options: &Options,
) -> Result<(Polyhedron, Report), MeshError> {
    parse(&read_limited(reader, MAX_FILE_BYTES)?, format, options)
}

/// Reads a body from the bytes of a file, with options, and reports what was done to it.
///
/// # Errors
///
/// If the bytes are not in the format, or the facets, after the changes that the options allow, do not form one
/// closed surface.
pub fn parse(
    bytes: &[u8],
    format: Format,
    options: &Options,
) -> Result<(Polyhedron, Report), MeshError> {
    let Facets { points, loops } = match format {
        Format::Obj => obj::facets(bytes),
        Format::Stl => stl::facets(bytes),
        Format::Off => off::facets(bytes),
        Format::Ply => ply::facets(bytes),
    }?;
    let too_long = loops.iter().find(|l| l.len() > MAX_FACET_CORNERS);
    if let Some(corners) = too_long {
        return Err(MeshError::TooMany {
            what: "corners of a facet",
            count: corners.len(),
            allowed: MAX_FACET_CORNERS,
        });
    }
    match format {
        // Loose triangles: flat faces are merged again.
        Format::Stl => close(points, loops, options, LOOSE_WELD)
            .map(|(body, report)| (body.with_merged_faces(), report)),
        _ => close(points, loops, options, 0.0),
    }
}

/// All bytes of a reader, or an error if there are more than `allowed`.
fn read_limited(reader: impl Read, allowed: u64) -> Result<Vec<u8>, MeshError> {
    let mut bytes = Vec::new();
    reader.take(allowed + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > allowed {
        return Err(MeshError::FileTooLarge { allowed });
    }
    Ok(bytes)
}

/// World coordinates of a body's vertices; an error if the pose is not a rigid motion, or the coordinates are
/// not finite.
fn posed_vertices(body: &Polyhedron, pose: &Pose) -> Result<Vec<Point3>, MeshError> {
    let pose = checked_pose(pose)?;
    let vertices: Vec<Point3> = body.vertices().iter().map(|v| pose * v).collect();
    let bad = vertices
        .iter()
        .position(|v| !v.iter().all(|x| x.is_finite()));
    match bad {
        None => Ok(vertices),
        Some(vertex) => {
            let Point3 { coords } = vertices[vertex];
            Err(MeshError::NotFinite {
                vertex,
                x: coords.x,
                y: coords.y,
                z: coords.z,
            })
        }
    }
}

/// Writes a line for each vertex, then for each face the number of its vertices and their indices:
/// the body of OFF and of ASCII PLY.
fn write_lists(body: &Polyhedron, mut writer: impl Write) -> Result<(), MeshError> {
    for p in body.vertices() {
        writeln!(writer, "{} {} {}", p.x, p.y, p.z)?;
    }
    for face in body.faces() {
        write!(writer, "{}", face.len())?;
        for v in face {
            write!(writer, " {v}")?;
        }
        writeln!(writer)?;
    }
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests;
