//! `femdem shapes`: the shapes that --shape accepts.

use std::path::Path;

use anyhow::{Result, bail};
use femdem::mesh::catalogue::CatalogueShape;
use femdem::mesh::shapes::Shape;
use femdem::output;
use femdem::picture::{Exhibit, gallery};
use serde::Serialize;

use super::cli::ShapesArgs;
use super::say;

/// Columns of the gallery, and width of a tile in pixels.
const COLUMNS: usize = 6;
const TILE: usize = 300;

/// A shape by its circumscribed diameter d and mass m; a parametric one with its defaults.
#[derive(Serialize)]
struct Row {
    id: String,
    name: &'static str,
    volume_over_d3: f64,
    area_over_d2: f64,
    /// Of the largest sphere about the centroid inside; none for a body that is not convex.
    inradius_over_d: Option<f64>,
    /// Mean of the three principal moments; for the solids, which are isotropic, the moment about any axis.
    inertia_over_m_d2: f64,
    vertices: usize,
    faces: usize,
    convex: bool,
    size: &'static str,
    size_over_d: f64,
    /// Other names, each with the settings that it stands for.
    aliases: Vec<String>,
    parameters: Vec<ParameterRow>,
}

#[derive(Serialize)]
struct ParameterRow {
    name: &'static str,
    default: String,
    range: String,
    meaning: String,
}

impl Row {
    fn of(shape: &Shape) -> Result<Self> {
        let of_size_1 = shape.polyhedron(1.0)?;
        let size = 0.5 / of_size_1.bounding_radius();
        let body = of_size_1.scaled(size)?;
        let mass = body.mass_properties();
        let parameter = |p: femdem::mesh::shapes::Parameter| ParameterRow {
            name: p.name,
            default: p.default,
            range: p.range,
            meaning: p.meaning,
        };
        Ok(Self {
            id: shape.name(),
            name: shape.summary(),
            volume_over_d3: mass.volume,
            area_over_d2: body.area(),
            inradius_over_d: body.is_convex().then(|| body.inradius()),
            inertia_over_m_d2: mass.inertia.trace() / 3.0 / mass.volume,
            vertices: body.vertices().len(),
            faces: body.face_count(),
            convex: body.is_convex(),
            size: shape.size_meaning(),
            size_over_d: size,
            aliases: aliases(&shape.name()),
            parameters: shape.parameters().into_iter().map(parameter).collect(),
        })
    }

    fn is_solid(&self) -> bool {
        self.parameters.is_empty()
    }
}

/// Other names of a shape, such as "raschig", and "trilobe = lobed:lobes=3".
fn aliases(name: &str) -> Vec<String> {
    let own = Shape::aliases()
        .iter()
        .filter(|(_, text)| text.split(':').next() == Some(name));
    let told = own.map(|(alias, text)| match text.contains(':') {
        true => format!("{alias} = {text}"),
        false => (*alias).to_owned(),
    });
    told.collect()
}

/// The 18 solids, then the parametric shapes with their defaults.
fn all() -> Vec<Shape> {
    let solids = CatalogueShape::all().map(Shape::from);
    solids.chain(Shape::all()).collect()
}

pub(crate) fn run(args: &ShapesArgs) -> Result<()> {
    if let Some(path) = &args.picture {
        return draw(path);
    }
    let rows = all().iter().map(Row::of).collect::<Result<Vec<_>>>()?;
    if args.json {
        say(&serde_json::to_string_pretty(&rows)?);
    } else {
        list(&rows);
    }
    Ok(())
}

fn list(rows: &[Row]) {
    say(&format!(
        "{:<4} {:<28} {:>10} {:>10} {:>10} {:>10} {:>8} {:>5}",
        "id", "name", "volume/d3", "area/d2", "inradius/d", "I/(m d2)", "vertices", "faces"
    ));
    for row in rows.iter().filter(|row| row.is_solid()) {
        say(&format!(
            "{:<4} {:<28} {:>10.6} {:>10.6} {:>10.6} {:>10.6} {:>8} {:>5}",
            row.id,
            row.name,
            row.volume_over_d3,
            row.area_over_d2,
            row.inradius_over_d.unwrap_or_default(),
            row.inertia_over_m_d2,
            row.vertices,
            row.faces
        ));
    }
    say(
        "\nA3m and A4m are the mirror images of the chiral A3 and A4.\n\n\
         With parameters, such as --shape cylinder:aspect=2,sides=24, each with its default and range:",
    );
    for row in rows.iter().filter(|row| !row.is_solid()) {
        let kind = if row.convex { "convex" } else { "not convex" };
        say(&format!(
            "\n{}: {} ({kind}, {} faces, volume {:.4} d3)\n  size: {}, {:.4} d",
            row.id, row.name, row.faces, row.volume_over_d3, row.size, row.size_over_d
        ));
        for p in &row.parameters {
            let setting = format!("{}={}", p.name, p.default);
            say(&format!("  {setting:<22} {} ({})", p.meaning, p.range));
        }
    }
    say("\nOther names:");
    for (alias, text) in Shape::aliases() {
        say(&format!("  {alias:<12} {text}"));
    }
    say("\nd: circumscribed diameter. Numbers of a shape are those of its default parameters.");
}

/// Draws all shapes with their defaults.
fn draw(path: &Path) -> Result<()> {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if ending.as_deref() != Some("png") {
        bail!(
            "{} is no .png: give another file with --picture",
            path.display()
        );
    }
    let shapes = all();
    let mut exhibits = Vec::with_capacity(shapes.len());
    for (k, shape) in shapes.iter().enumerate() {
        exhibits.push(Exhibit {
            label: label(shape),
            polyhedron: shape.polyhedron(1.0)?,
            colour: k as f64 / (shapes.len() - 1) as f64,
        });
    }
    let picture = gallery(&exhibits, COLUMNS, TILE)?;
    output::write_file(path, |w| picture.write_png(w))?;
    Ok(())
}

/// The name that --shape takes, and for a solid its description.
fn label(shape: &Shape) -> String {
    match shape {
        Shape::Solid(solid) => format!("{}\n{}", solid.id(), solid.name()),
        other => other.name(),
    }
}
