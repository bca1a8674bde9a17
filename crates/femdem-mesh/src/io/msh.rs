//! Gmsh `.msh` files of tetrahedra, formats 4.1 and 2.2.
//!
//! ASCII files of both formats are read, and binary ones of 4.1 in either byte order. Points, lines, triangles
//! and quadrilaterals are skipped, and so are groups, entities, periodicity and data; nodes that no tetrahedron
//! uses are dropped. Inverted tetrahedra are reversed. Volume elements other than four-node tetrahedra are
//! refused by name. Files carry no unit and are read as metres. (C. Geuzaine, J.-F. Remacle, Gmsh reference
//! manual, "MSH file format".)

mod elements;
mod sections;
mod values;

use super::{MAX_FILE_BYTES, read_limited};
use crate::{MeshError, TetMesh};
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

/// Code of the four-node tetrahedron.
const TETRAHEDRON: i64 = 4;

/// Reads a mesh from a file.
///
/// # Errors
///
/// As [`read`]; the message names the file.
pub fn read_file(path: impl AsRef<Path>) -> Result<TetMesh, MeshError> {
    let path = path.as_ref();
    File::open(path)
        .map_err(MeshError::from)
        .and_then(read)
        .map_err(|problem| MeshError::InFile {
            path: path.to_path_buf(),
            problem: Box::new(problem),
        })
}

/// Reads a mesh.
///
/// # Errors
///
/// As [`parse`]; also if reading fails or the file is larger than
/// [`MAX_FILE_BYTES`].
pub fn read(reader: impl Read) -> Result<TetMesh, MeshError> {
    parse(&read_limited(reader, MAX_FILE_BYTES)?)
}

/// Reads a mesh from the bytes of a file.
///
/// # Errors
///
/// If the format is another one, the file is cut off or contains an invalid number, an element names a node
/// that does not exist, there are no tetrahedra or volume elements of another kind, or the tetrahedra do not
/// form a valid [`TetMesh`].
pub fn parse(bytes: &[u8]) -> Result<TetMesh, MeshError> {
    let (points, tets) = sections::read(bytes)?.tetrahedra()?;
    TetMesh::new(points, tets)
}

/// Writes a mesh as ASCII in format 4.1, with all digits of its coordinates.
///
/// # Errors
///
/// If writing fails.
pub fn write(mesh: &TetMesh, mut writer: impl Write) -> Result<(), MeshError> {
    let (nodes, tets) = (mesh.points().len(), mesh.tets().len());
    writeln!(writer, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes")?;
    writeln!(writer, "1 {nodes} 1 {nodes}\n3 1 0 {nodes}")?;
    for tag in 1..=nodes {
        writeln!(writer, "{tag}")?;
    }
    for p in mesh.points() {
        writeln!(writer, "{} {} {}", p.x, p.y, p.z)?;
    }
    writeln!(writer, "$EndNodes\n$Elements")?;
    writeln!(writer, "1 {tets} 1 {tets}\n3 1 {TETRAHEDRON} {tets}")?;
    for (i, tet) in mesh.tets().iter().enumerate() {
        let [a, b, c, d] = tet.map(|v| u64::from(v) + 1);
        writeln!(writer, "{} {a} {b} {c} {d}", i + 1)?;
    }
    writeln!(writer, "$EndElements")?;
    writer.flush()?;
    Ok(())
}

/// Writes a mesh as ASCII in format 2.2, for older programs.
///
/// # Errors
///
/// If writing fails.
pub fn write_v2(mesh: &TetMesh, mut writer: impl Write) -> Result<(), MeshError> {
    writeln!(writer, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes")?;
    writeln!(writer, "{}", mesh.points().len())?;
    for (i, p) in mesh.points().iter().enumerate() {
        writeln!(writer, "{} {} {} {}", i + 1, p.x, p.y, p.z)?;
    }
    writeln!(writer, "$EndNodes\n$Elements\n{}", mesh.tets().len())?;
    for (i, tet) in mesh.tets().iter().enumerate() {
        let [a, b, c, d] = tet.map(|v| u64::from(v) + 1);
        // Two tags: no physical group, elementary entity 1.
        writeln!(writer, "{} {TETRAHEDRON} 2 0 1 {a} {b} {c} {d}", i + 1)?;
    }
    writeln!(writer, "$EndElements")?;
    writer.flush()?;
    Ok(())
}

#[cfg(test)]
mod tests;
