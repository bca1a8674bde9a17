//! Bodies for ParaView: one polyhedral cell for each body (VTK type 42), in an unstructured grid.
//!
//! Cell data: `body`, `sequence`, `shape`, `coordination`, `force_sum` (sum of the normal forces,
//! N) and `sleeping`. Points are in metres.

use std::io::{self, Write};

use femdem_mesh::Polyhedron;

use super::csv::invalid;
use super::vtk::Document;
use crate::{Body, BodyLoad, NamedShape, Snapshot};

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
    let bodies = || bodies.iter().zip(numbers);
    write_rows(&snapshot.shapes, Some(&loads), writer, &|take| {
        bodies().try_for_each(|(body, number)| take(body, *number))
    })
}

/// Passes on bodies with their numbers, in the order of a file.
pub type Numbered<'a> = dyn Fn(&mut dyn FnMut(&Body, i64) -> io::Result<()>) -> io::Result<()> + 'a;

/// As [`write_numbered`], of bodies without contacts, of these shapes, that are passed on several times: they need not be in memory
/// together.
///
/// # Errors
///
/// If writing or passing on fails, and as [`io::ErrorKind::InvalidInput`] for a body of no such shape.
pub fn write_passed(
    shapes: &[NamedShape],
    bodies: &Numbered<'_>,
    writer: impl Write,
) -> io::Result<()> {
    write_rows(shapes, None, writer, bodies)
}

/// `loads` are those of the bodies, if they have contacts.
fn write_rows(
    shapes: &[NamedShape],
    loads: Option<&[BodyLoad]>,
    writer: impl Write,
    bodies: &Numbered<'_>,
) -> io::Result<()> {
    let of = |body: &Body| {
        let shape = shapes.get(body.shape as usize);
        let none = || format!("shape {} of {}", body.shape, shapes.len());
        let shape = shape.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, none()));
        Ok::<_, io::Error>(&shape?.polyhedron)
    };
    let (mut count, mut points, mut stream) = (0_usize, 0_usize, 0_usize);
    bodies(&mut |body, _| {
        let polyhedron = of(body)?;
        count += 1;
        points += polyhedron.vertices().len();
        stream += stream_length(polyhedron);
        Ok(())
    })?;
    // The sum so far of a number of each body, with what is passed on of it.
    let sums = |size: &dyn Fn(&Polyhedron) -> usize,
                take: &mut dyn FnMut(&Polyhedron, i64, i64) -> io::Result<()>| {
        let mut sum = 0;
        bodies(&mut |body, _| {
            let polyhedron = of(body)?;
            let before = sum;
            sum += size(polyhedron) as i64;
            take(polyhedron, before, sum)
        })
    };
    let corners = |polyhedron: &Polyhedron| polyhedron.vertices().len();
    let mut out = Document::new("UnstructuredGrid");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{count}\">"
    ));
    out.line("<Points>");
    out.given_floats("points", 3, 3 * points, |take| {
        bodies(&mut |body, _| {
            let vertices = of(body)?.vertices().iter();
            let mut places = vertices.flat_map(|vertex| <[f64; 3]>::from(body.pose * vertex));
            places.try_for_each(&mut *take)
        })
    });
    out.line("</Points>\n<Cells>");
    // The vertices of the bodies follow each other, so that those of a cell are consecutive numbers.
    out.integers("connectivity", 0..points as i64);
    out.given_integers("offsets", count, |take| {
        sums(&corners, &mut |_, _, end| take(end))
    });
    out.bytes("types", std::iter::repeat_n(VTK_POLYHEDRON, count));
    out.given_integers("faces", stream, |take| {
        sums(&corners, &mut |polyhedron, start, _| {
            face_stream(polyhedron, start, take)
        })
    });
    out.given_integers("faceoffsets", count, |take| {
        sums(&stream_length, &mut |_, _, end| take(end))
    });
    out.line("</Cells>\n<CellData Scalars=\"sequence\">");
    out.given_integers("body", count, |take| bodies(&mut |_, number| take(number)));
    out.given_integers("sequence", count, |take| {
        bodies(&mut |body, _| take(i64::from(body.sequence)))
    });
    out.given_integers("shape", count, |take| {
        bodies(&mut |body, _| take(i64::from(body.shape)))
    });
    match loads {
        Some(loads) => {
            let coordination = loads.iter().map(|load| i64::from(load.coordination));
            out.integers("coordination", coordination);
            out.floats("force_sum", 1, loads.iter().map(|load| load.force_sum));
        }
        None => {
            out.integers("coordination", std::iter::repeat_n(0, count));
            out.floats("force_sum", 1, std::iter::repeat_n(0.0, count));
        }
    }
    out.given_bytes("sleeping", count, |take| {
        bodies(&mut |body, _| take(u8::from(body.sleeping)))
    });
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

/// Passes on the face stream of a polyhedron in VTK: the number of its faces, then for each face the number of its
/// corners and their point indices.
fn face_stream(
    polyhedron: &Polyhedron,
    start: i64,
    take: &mut dyn FnMut(i64) -> io::Result<()>,
) -> io::Result<()> {
    take(polyhedron.face_count() as i64)?;
    for face in polyhedron.faces() {
        take(face.len() as i64)?;
        let mut corners = face.iter().map(|&vertex| start + i64::from(vertex));
        corners.try_for_each(&mut *take)?;
    }
    Ok(())
}

fn stream_length(polyhedron: &Polyhedron) -> usize {
    let faces = polyhedron.faces();
    1 + faces.map(|face| 1 + face.len()).sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    #[test]
    fn second_cube_has_its_own_points_and_six_faces() {
        let snapshot = two_cubes();
        let polyhedron = &snapshot.shape_of(&snapshot.bodies[1]).polyhedron;
        let mut stream = Vec::new();
        let take = &mut |value| {
            stream.push(value);
            Ok(())
        };
        face_stream(polyhedron, 8, take).unwrap();
        assert_eq!(stream.len(), stream_length(polyhedron));
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
