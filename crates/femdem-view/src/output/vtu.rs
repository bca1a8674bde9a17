//! Bodies for ParaView: one polyhedral cell for each body (VTK type 42), in an unstructured grid.
//!
//! Cell data: `body`, `sequence`, `shape`, `coordination`, `force_sum` (sum of the normal forces,
//! N) and `sleeping`. Points are in metres.

use std::io::{self, Write};

use super::csv::invalid;
use super::vtk::Document;
use crate::{Body, BodyLoad, Snapshot};

const VTK_POLYHEDRON: u8 = 42;

/// Writes the bodies.
///
/// # Errors
///
/// If writing fails, or the snapshot does not pass [`Snapshot::check`] (as
/// [`io::ErrorKind::InvalidInput`]).
pub fn write(snapshot: &Snapshot, writer: impl Write) -> io::Result<()> {
    let numbers: Vec<i64> = (0..snapshot.bodies.len() as i64).collect();
    write_numbered(snapshot, &numbers, writer)
}

/// As [`write()`], with the numbers of the bodies: those of a scene that has other bodies too.
///
/// # Errors
///
/// As [`write()`], and as [`io::ErrorKind::InvalidInput`] unless there is a number for every body.
pub fn write_numbered(snapshot: &Snapshot, numbers: &[i64], writer: impl Write) -> io::Result<()> {
    let loads = snapshot.loads().map_err(invalid)?;
    let bodies = &snapshot.bodies;
    if numbers.len() != bodies.len() {
        let message = format!("{} numbers for {} bodies", numbers.len(), bodies.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    let sizes = bodies
        .iter()
        .map(|body| snapshot.shape_of(body).polyhedron.vertices().len() as i64);
    let starts = running_sum(sizes);
    let points = starts.last().copied().unwrap_or(0);
    let mut out = Document::new("UnstructuredGrid");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{}\">",
        bodies.len()
    ));
    out.line("<Points>");
    out.floats(
        "points",
        3,
        bodies.iter().flat_map(|body| coordinates(snapshot, body)),
    );
    out.line("</Points>\n<Cells>");
    // The vertices of the bodies follow each other, so that those of a cell are consecutive numbers.
    out.integers("connectivity", 0..points);
    out.integers("offsets", starts.iter().skip(1).copied());
    out.bytes("types", bodies.iter().map(|_| VTK_POLYHEDRON));
    let streams = bodies
        .iter()
        .zip(&starts)
        .map(|(body, &start)| face_stream(snapshot, body, start));
    let ends = running_sum(streams.clone().map(|stream| stream.len() as i64));
    out.integers("faces", streams.flatten());
    out.integers("faceoffsets", ends.into_iter().skip(1));
    out.line("</Cells>\n<CellData Scalars=\"sequence\">");
    out.integers("body", numbers.iter().copied());
    cell_data(&mut out, bodies, &loads);
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

fn cell_data<'a>(out: &mut Document<'a>, bodies: &'a [Body], loads: &'a [BodyLoad]) {
    out.integers(
        "sequence",
        bodies.iter().map(|body| i64::from(body.sequence)),
    );
    out.integers("shape", bodies.iter().map(|body| i64::from(body.shape)));
    out.integers(
        "coordination",
        loads.iter().map(|load| i64::from(load.coordination)),
    );
    out.floats("force_sum", 1, loads.iter().map(|load| load.force_sum));
    out.bytes(
        "sleeping",
        bodies.iter().map(|body| u8::from(body.sleeping)),
    );
}

/// World coordinates of a body's vertices, one after another.
fn coordinates<'a>(
    snapshot: &'a Snapshot,
    body: &'a Body,
) -> impl Iterator<Item = f64> + Clone + 'a {
    let vertices = snapshot.shape_of(body).polyhedron.vertices();
    vertices
        .iter()
        .flat_map(|vertex| <[f64; 3]>::from(body.pose * vertex))
}

/// The face stream of a polyhedron in VTK: the number of its faces, then for each face the number of its
/// corners and their point indices.
fn face_stream(snapshot: &Snapshot, body: &Body, start: i64) -> Vec<i64> {
    let polyhedron = &snapshot.shape_of(body).polyhedron;
    let mut stream = vec![polyhedron.face_count() as i64];
    for face in polyhedron.faces() {
        stream.push(face.len() as i64);
        stream.extend(face.iter().map(|&vertex| start + i64::from(vertex)));
    }
    stream
}

/// Sums of the first 0, 1, 2, ... of the values.
fn running_sum(values: impl Iterator<Item = i64>) -> Vec<i64> {
    let mut sums = vec![0];
    let mut sum = 0;
    sums.extend(values.map(|value| {
        sum += value;
        sum
    }));
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    #[test]
    fn second_cube_has_its_own_points_and_six_faces() {
        let snapshot = two_cubes();
        let stream = face_stream(&snapshot, &snapshot.bodies[1], 8);
        assert_eq!(stream.len(), 1 + 6 * 5);
        assert_eq!(stream[..2], [6, 4]);
        let mut corners: Vec<i64> = stream[1..]
            .chunks(5)
            .flat_map(|f| f[1..].to_vec())
            .collect();
        corners.sort_unstable();
        // Each of the 8 vertices belongs to 3 faces.
        let expected: Vec<i64> = (8..16).flat_map(|i| [i; 3]).collect();
        assert_eq!(corners, expected);
    }

    #[test]
    fn every_field_is_there() {
        let mut bytes = Vec::new();
        write(&two_cubes(), &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains("NumberOfPoints=\"16\" NumberOfCells=\"2\""));
        for name in [
            "body",
            "sequence",
            "shape",
            "coordination",
            "force_sum",
            "sleeping",
        ] {
            assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
        }
    }

    #[test]
    fn every_body_needs_a_number() {
        let refused = write_numbered(&two_cubes(), &[7], io::sink()).unwrap_err();
        assert!(refused.to_string().contains("1 numbers for 2 bodies"));
    }

    #[test]
    fn an_empty_pack_is_a_valid_file() {
        let mut bytes = Vec::new();
        write(&Snapshot::default(), &mut bytes).unwrap();
        assert!(
            String::from_utf8(bytes)
                .unwrap()
                .contains("NumberOfCells=\"0\"")
        );
    }
}
