//! VTU, the XML file of VTK for unstructured grids: writing only, for ParaView and similar programs.

use crate::{MeshError, TetMesh};
use std::fmt::Display;
use std::io::Write;

/// Code of the tetrahedron in VTK.
const TETRAHEDRON: u8 = 10;

/// Writes a mesh in ASCII with all digits of its coordinates, and scalars at its points, each with a name and
/// one value per point.
///
/// # Errors
///
/// If writing fails, a scalar has not one value per point, or a value is not finite.
pub fn write(
    mesh: &TetMesh,
    scalars: &[(&str, &[f64])],
    mut writer: impl Write,
) -> Result<(), MeshError> {
    let (points, tets) = (mesh.points().len(), mesh.tets().len());
    for (_, values) in scalars {
        check(values, points)?;
    }
    writeln!(
        writer,
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n\
         <UnstructuredGrid>\n\
         <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{tets}\">\n<Points>"
    )?;
    let coordinates = mesh.points().iter().map(|p| [p.x, p.y, p.z]);
    array(
        &mut writer,
        "type=\"Float64\" Name=\"points\" NumberOfComponents=\"3\"",
        coordinates,
    )?;
    writeln!(writer, "</Points>\n<Cells>")?;
    let corners = mesh.tets().iter().copied();
    array(&mut writer, "type=\"Int64\" Name=\"connectivity\"", corners)?;
    array(
        &mut writer,
        "type=\"Int64\" Name=\"offsets\"",
        (1..=tets).map(|i| [4 * i]),
    )?;
    array(
        &mut writer,
        "type=\"UInt8\" Name=\"types\"",
        (0..tets).map(|_| [TETRAHEDRON]),
    )?;
    writeln!(writer, "</Cells>\n<PointData>")?;
    for (name, values) in scalars {
        let head = format!("type=\"Float64\" Name=\"{}\"", escaped(name));
        array(&mut writer, &head, values.iter().map(|&x| [x]))?;
    }
    writeln!(
        writer,
        "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>"
    )?;
    writer.flush()?;
    Ok(())
}

fn check(values: &[f64], points: usize) -> Result<(), MeshError> {
    if values.len() != points {
        return Err(MeshError::OutOfRange {
            what: "the number of values of a scalar at the points",
            value: values.len() as f64,
            allowed: "the number of points of the mesh",
        });
    }
    match values.iter().find(|x| !x.is_finite()) {
        None => Ok(()),
        Some(&value) => Err(MeshError::OutOfRange {
            what: "a scalar at a point",
            value,
            allowed: "a finite number",
        }),
    }
}

/// Rows of numbers, one row per line.
fn array<T: Display, const N: usize>(
    writer: &mut impl Write,
    head: &str,
    rows: impl Iterator<Item = [T; N]>,
) -> Result<(), MeshError> {
    writeln!(writer, "<DataArray {head} format=\"ascii\">")?;
    for row in rows {
        for (i, x) in row.iter().enumerate() {
            write!(writer, "{}{x}", if i > 0 { " " } else { "" })?;
        }
        writeln!(writer)?;
    }
    writeln!(writer, "</DataArray>")?;
    Ok(())
}

/// Text escaped for an XML attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('"', "&quot;")
        .replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{CatalogueShape, Solid};

    #[test]
    fn a_mesh_and_its_scalars_are_written() {
        let cube = CatalogueShape::from(Solid::P5).polyhedron(1.0).unwrap();
        let mesh = TetMesh::centroid_fan(&cube).unwrap();
        let field: Vec<f64> = mesh.distance_to_skin();
        let mut file = Vec::new();
        write(&mesh, &[("a <field>", &field)], &mut file).unwrap();
        let text = String::from_utf8(file).unwrap();
        assert!(
            text.contains("NumberOfPoints=\"9\" NumberOfCells=\"12\""),
            "{text}"
        );
        assert!(text.contains("Name=\"a &lt;field>\""), "{text}");
        let lines_of = |name: &str| {
            let after = text.split(&format!("Name=\"{name}\"")).nth(1).unwrap();
            let rows = after
                .split_once("\n")
                .unwrap()
                .1
                .split("</DataArray>")
                .next()
                .unwrap();
            rows.lines().map(str::to_owned).collect::<Vec<_>>()
        };
        assert_eq!(lines_of("offsets").last().unwrap(), "48");
        assert_eq!(lines_of("types"), ["10"; 12]);
        let back: Vec<Vec<f64>> = lines_of("points")
            .iter()
            .map(|row| row.split(' ').map(|x| x.parse().unwrap()).collect())
            .collect();
        for (row, point) in back.iter().zip(mesh.points()) {
            assert_eq!(row, point.coords.as_slice());
        }
        for (row, tet) in lines_of("connectivity").iter().zip(mesh.tets()) {
            assert_eq!(*row, tet.map(|i| i.to_string()).join(" "));
        }
    }

    #[test]
    fn scalars_must_fit_the_points() {
        let cube = CatalogueShape::from(Solid::P5).polyhedron(1.0).unwrap();
        let mesh = TetMesh::centroid_fan(&cube).unwrap();
        for values in [vec![0.0; 8], vec![f64::NAN; 9]] {
            let written = write(&mesh, &[("field", &values)], Vec::new());
            assert!(matches!(written, Err(MeshError::OutOfRange { .. })));
        }
    }
}
