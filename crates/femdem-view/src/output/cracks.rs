//! Cracks for ParaView, and tables of fragments and of facets that broke.
//!
//! `cracks.vtp` has one triangle for each facet, with corners of its own. Cell data: `opening` and `slip` (m), `damage`
//! (0 to 1, 1 is a free surface), `mode` (0 tension, 1 shear), `birth` (s), `dissipated` (J), `body`.

use std::io::{self, Write};

use super::csv::invalid;
use super::vtk::Document;
use crate::fracture::{check_cracks, check_events, check_fragments};
use crate::{CrackEvent, CrackFacet, FragmentRow};

/// Header of `fragments.csv`.
pub const FRAGMENT_COLUMNS: &str = "fragment,body,volume,mass,sieve_size,sphericity,x,y,z,vx,vy,vz";

/// Header of `events.csv`.
pub const EVENT_COLUMNS: &str = "time,x,y,z,energy,mode";

/// Writes the facets of cracks as `cracks.vtp`.
///
/// # Errors
///
/// If writing fails, or a number is not finite or out of its range (as [`io::ErrorKind::InvalidInput`]).
pub fn write(facets: &[CrackFacet], writer: impl Write) -> io::Result<()> {
    check_cracks(facets).map_err(invalid)?;
    let count = facets.len();
    let corners = 3 * count as i64;
    let mut out = Document::new("PolyData");
    out.line(&format!(
        "<Piece NumberOfPoints=\"{corners}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"{count}\">\n<Points>"
    ));
    let points = facets.iter().flat_map(|facet| facet.points);
    out.floats("points", 3, points.flat_map(<[f64; 3]>::from));
    out.line("</Points>\n<Polys>");
    out.integers("connectivity", 0..corners);
    out.integers("offsets", (1..=count as i64).map(|k| 3 * k));
    out.line("</Polys>\n<CellData Scalars=\"damage\">");
    out.floats("opening", 1, facets.iter().map(|facet| facet.opening));
    out.floats("slip", 1, facets.iter().map(|facet| facet.slip));
    out.floats("damage", 1, facets.iter().map(|facet| facet.damage));
    out.bytes("mode", facets.iter().map(|facet| facet.mode.number()));
    out.floats("birth", 1, facets.iter().map(|facet| facet.birth));
    out.floats("dissipated", 1, facets.iter().map(|facet| facet.dissipated));
    out.counts("body", facets.iter().map(|facet| facet.body));
    out.line("</CellData>\n</Piece>");
    out.finish(writer)
}

/// Writes `fragments.csv`, one fragment per line, numbered from 0.
///
/// `body` is the body that it is a part of; `volume` in m³, `mass` in kg, `sieve_size` in m, `sphericity` empty if
/// unknown; `x, y, z` \[m\] and `vx, vy, vz` \[m/s\] are place and velocity of the centre of mass.
///
/// # Errors
///
/// As [`write()`].
pub fn write_fragments(fragments: &[FragmentRow], mut writer: impl Write) -> io::Result<()> {
    check_fragments(fragments).map_err(invalid)?;
    writeln!(writer, "{FRAGMENT_COLUMNS}")?;
    for (k, row) in fragments.iter().enumerate() {
        let (p, v) = (&row.centre, &row.velocity);
        let sphericity = row.sphericity.map_or(String::new(), |s| s.to_string());
        writeln!(
            writer,
            "{k},{},{},{},{},{sphericity},{},{},{},{},{},{}",
            row.body, row.volume, row.mass, row.sieve_size, p.x, p.y, p.z, v.x, v.y, v.z
        )?;
    }
    Ok(())
}

/// Writes `events.csv`, one facet that broke per line: `time` in s, `x, y, z` in m, `energy` in J, `mode` 0 for tension
/// and 1 for shear.
///
/// # Errors
///
/// As [`write()`].
pub fn write_events(events: &[CrackEvent], mut writer: impl Write) -> io::Result<()> {
    check_events(events).map_err(invalid)?;
    writeln!(writer, "{EVENT_COLUMNS}")?;
    for event in events {
        let p = &event.point;
        writeln!(
            writer,
            "{},{},{},{},{},{}",
            event.time,
            p.x,
            p.y,
            p.z,
            event.energy,
            event.mode.number()
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CrackMode;
    use crate::testing::crack;
    use femdem_mesh::{Point3, Vector3};

    fn text(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn one_triangle_for_each_facet_with_its_data() {
        let text = text(|w| write(&[crack(0.0), crack(1.0)], w));
        assert!(text.contains("NumberOfPoints=\"6\"") && text.contains("NumberOfPolys=\"2\""));
        let cell_data = text.split("<CellData").nth(1).unwrap();
        for name in [
            "opening",
            "slip",
            "damage",
            "mode",
            "birth",
            "dissipated",
            "body",
        ] {
            assert!(cell_data.contains(&format!("Name=\"{name}\"")), "{name}");
        }
    }

    #[test]
    fn tables_have_the_columns_of_their_headers() {
        let row = FragmentRow {
            body: 3,
            volume: 1e-6,
            mass: 0.0025,
            sieve_size: 0.01,
            sphericity: None,
            centre: Point3::new(1.0, 2.0, 3.0),
            velocity: Vector3::new(-1.0, 0.0, 0.5),
        };
        let known = FragmentRow {
            sphericity: Some(0.8),
            ..row
        };
        assert_eq!(
            text(|w| write_fragments(&[row, known], w)),
            format!(
                "{FRAGMENT_COLUMNS}\n0,3,0.000001,0.0025,0.01,,1,2,3,-1,0,0.5\n\
                 1,3,0.000001,0.0025,0.01,0.8,1,2,3,-1,0,0.5\n"
            )
        );
        let event = CrackEvent {
            time: 0.001,
            point: Point3::new(0.0, 0.5, 1.0),
            energy: 0.25,
            mode: CrackMode::Shear,
        };
        assert_eq!(
            text(|w| write_events(&[event], w)),
            format!("{EVENT_COLUMNS}\n0.001,0,0.5,1,0.25,1\n")
        );
        let refused = |written: io::Result<()>| written.unwrap_err().to_string();
        let wild = FragmentRow {
            mass: f64::NAN,
            ..row
        };
        let said = refused(write_fragments(&[row, wild], io::sink()));
        assert!(said.contains("fragment 1: its mass = NaN"), "{said}");
        let late = CrackEvent {
            time: f64::INFINITY,
            ..event
        };
        let said = refused(write_events(&[late], io::sink()));
        assert!(said.contains("event 0: its time = inf"), "{said}");
    }

    #[test]
    fn facets_out_of_range_are_refused_by_name() {
        let good = crack(0.0);
        let mut far = good;
        far.points[1].y = f64::NAN;
        for (bad, words) in [
            (far, "its points = NaN"),
            (
                CrackFacet {
                    damage: 1.5,
                    ..good
                },
                "its damage = 1.5",
            ),
            (CrackFacet { slip: -1.0, ..good }, "its slip = -1"),
            (
                CrackFacet {
                    dissipated: f64::INFINITY,
                    ..good
                },
                "its dissipated = inf",
            ),
        ] {
            let said = write(&[good, bad], io::sink()).unwrap_err().to_string();
            assert!(
                said.contains("crack facet 1") && said.contains(words),
                "{said}"
            );
        }
    }
}
