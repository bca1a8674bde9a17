//! Contacts for ParaView: one point for each contact, at its centre of pressure.
//!
//! Point data: `force` (on the partner, N), `normal` (from body to partner), `normal_force` and
//! `tangential_force` (N), `area` (m²), `penetration` (m), `class` (patch dimension: 2 face-face,
//! 1 edge-face, 0 point), `body` and `partner` (−1 for a wall), `patch` (number of the patch within
//! its pair). Glyphs scaled by `force` show the force network.

use std::io::{self, Write};

use super::csv::invalid;
use super::vtk::Document;
use crate::{ContactRow, Partner, Snapshot};

/// Writes the contacts.
///
/// # Errors
///
/// If writing fails, or the snapshot does not pass [`Snapshot::check`] (as
/// [`io::ErrorKind::InvalidInput`]).
pub fn write(snapshot: &Snapshot, writer: impl Write) -> io::Result<()> {
    snapshot.check().map_err(invalid)?;
    let rows = &snapshot.contacts;
    let count = rows.len();
    let mut out = Document::new("PolyData");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>"
    ));
    out.floats(
        "points",
        3,
        rows.iter().flat_map(|row| <[f64; 3]>::from(row.point)),
    );
    out.line("</Points>\n<Verts>");
    out.integers("connectivity", 0..count as i64);
    out.integers("offsets", 1..=count as i64);
    out.line("</Verts>\n<PointData Scalars=\"normal_force\" Vectors=\"force\">");
    point_data(&mut out, rows);
    out.line("</PointData>\n</Piece>");
    out.finish(writer)
}

fn point_data<'a>(out: &mut Document<'a>, rows: &'a [ContactRow]) {
    let force = |row: &ContactRow| row.normal * row.normal_force + row.friction;
    out.floats(
        "force",
        3,
        rows.iter()
            .flat_map(move |row| <[f64; 3]>::from(force(row))),
    );
    out.floats(
        "normal",
        3,
        rows.iter().flat_map(|row| <[f64; 3]>::from(row.normal)),
    );
    out.floats("normal_force", 1, rows.iter().map(|row| row.normal_force));
    out.floats(
        "tangential_force",
        1,
        rows.iter().map(|row| row.friction.norm()),
    );
    out.floats("area", 1, rows.iter().map(|row| row.area));
    out.floats("penetration", 1, rows.iter().map(ContactRow::penetration));
    out.bytes("class", rows.iter().map(|row| row.class.dimension()));
    out.integers("body", rows.iter().map(|row| i64::from(row.body)));
    out.integers(
        "partner",
        rows.iter().map(|row| match row.partner {
            Partner::Body(body) => i64::from(body),
            Partner::Wall(_) => -1,
        }),
    );
    out.integers("patch", rows.iter().map(|row| i64::from(row.patch)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    #[test]
    fn one_point_for_each_contact() {
        let mut bytes = Vec::new();
        write(&two_cubes(), &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains("NumberOfPoints=\"2\" NumberOfVerts=\"2\""));
        for name in [
            "force",
            "normal",
            "normal_force",
            "tangential_force",
            "area",
            "class",
            "patch",
        ] {
            assert!(text.contains(&format!("Name=\"{name}\"")), "{name}");
        }
    }
}
