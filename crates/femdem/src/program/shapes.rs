//! `femdem shapes`: the catalogue.

use anyhow::Result;
use femdem::mesh::catalogue::CatalogueShape;
use serde::Serialize;

use super::say;

/// A solid by its circumscribed diameter d and mass m.
#[derive(Serialize)]
struct Row {
    id: String,
    name: &'static str,
    volume_over_d3: f64,
    area_over_d2: f64,
    inradius_over_d: f64,
    /// About any axis through the centroid: every solid of the catalogue is isotropic.
    inertia_over_m_d2: f64,
    vertices: usize,
    faces: usize,
}

impl Row {
    fn of(shape: CatalogueShape) -> Result<Self> {
        let body = shape.polyhedron(1.0)?;
        let mass = body.mass_properties();
        Ok(Self {
            id: shape.id(),
            name: shape.name(),
            volume_over_d3: mass.volume,
            area_over_d2: body.area(),
            inradius_over_d: body.inradius(),
            inertia_over_m_d2: mass.inertia.trace() / 3.0 / mass.volume,
            vertices: body.vertices().len(),
            faces: body.face_count(),
        })
    }
}

pub(crate) fn list(json: bool) -> Result<()> {
    let rows = CatalogueShape::all()
        .map(Row::of)
        .collect::<Result<Vec<_>>>()?;
    if json {
        say(&serde_json::to_string_pretty(&rows)?);
        return Ok(());
    }
    say(&format!(
        "{:<4} {:<28} {:>10} {:>10} {:>10} {:>10} {:>8} {:>5}",
        "id", "name", "volume/d3", "area/d2", "inradius/d", "I/(m d2)", "vertices", "faces"
    ));
    for row in &rows {
        say(&format!(
            "{:<4} {:<28} {:>10.6} {:>10.6} {:>10.6} {:>10.6} {:>8} {:>5}",
            row.id,
            row.name,
            row.volume_over_d3,
            row.area_over_d2,
            row.inradius_over_d,
            row.inertia_over_m_d2,
            row.vertices,
            row.faces
        ));
    }
    say("\nd: circumscribed diameter. A3m and A4m are the mirror images of the chiral A3 and A4.");
    Ok(())
}
