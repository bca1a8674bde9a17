//! Shapes side by side, each with its name.

use femdem_mesh::{Point3, Polyhedron, Pose};

use super::canvas::Image;
use super::colour::Srgb;
use super::font;
use super::options::PictureOptions;
use super::paint::{eye, paint};
use super::scene::Mesh;
use crate::{Body, BodyValues, NamedShape, Snapshot, Spacing, ViewError};

const INK: Srgb = Srgb([0x33, 0x33, 0x33]);
const PAPER: Srgb = Srgb([0xff; 3]);

/// Height of the capitals of a label and of its strip, over the width of a tile.
const LETTER: f64 = 0.045;
const STRIP: f64 = 0.13;

/// A shape in a gallery.
#[derive(Clone, Debug)]
pub struct Exhibit {
    /// Text below it; one or two lines.
    pub label: String,
    /// Its surface.
    pub polyhedron: Polyhedron,
    /// Its place on the colour scale, 0 to 1.
    pub colour: f64,
}

/// Draws shapes in a grid of `columns`, row by row, each fitted to a tile of `tile` pixels width.
///
/// Works on the caller's rayon pool; the picture is the same for any number of threads.
///
/// # Errors
///
/// [`ViewError::NothingToDraw`] without shapes, [`ViewError::Option`] for no columns or a tile that is not
/// 16 to 8192 pixels wide.
pub fn gallery(exhibits: &[Exhibit], columns: usize, tile: usize) -> Result<Image, ViewError> {
    let options = PictureOptions {
        width: tile,
        height: tile,
        elevation: 20.0,
        ..PictureOptions::default()
    };
    options.check()?;
    if exhibits.is_empty() {
        return Err(ViewError::NothingToDraw);
    }
    if columns == 0 {
        return Err(ViewError::Option {
            name: "columns",
            value: columns.to_string(),
            allowed: "at least 1",
        });
    }
    let strip = (STRIP * tile as f64) as usize;
    let columns = columns.min(exhibits.len());
    let rows = exhibits.len().div_ceil(columns);
    let (width, height) = (columns * tile, rows * (tile + strip));
    let mut image = Image::new(width, vec![PAPER; width * height]);
    for (k, exhibit) in exhibits.iter().enumerate() {
        let (left, top) = (k % columns * tile, k / columns * (tile + strip));
        image.paste(&portrait(exhibit, &options), [left, top]);
        let letter = LETTER * tile as f64;
        let mut baseline = (top + tile) as f64 + letter;
        for line in exhibit.label.lines() {
            let start = left as f64 + 0.5 * (tile as f64 - font::width(line, letter));
            image.write(line, [start, baseline], letter, INK);
            baseline += 1.6 * letter;
        }
    }
    Ok(image)
}

/// One shape by itself.
fn portrait(exhibit: &Exhibit, options: &PictureOptions) -> Image {
    let snapshot = Snapshot {
        shapes: vec![NamedShape {
            name: exhibit.label.clone(),
            polyhedron: exhibit.polyhedron.clone(),
        }],
        bodies: vec![Body {
            shape: 0,
            pose: Pose::identity(),
            sequence: 0,
            sleeping: false,
        }],
        ..Snapshot::default()
    };
    let colour = BodyValues {
        title: String::new(),
        note: String::new(),
        values: vec![exhibit.colour],
        range: [0.0, 1.0],
        spacing: Spacing::Linear,
    };
    let mesh = Mesh::of_bodies(&snapshot, &colour);
    let extent: Vec<Point3> = mesh.points().collect();
    let view = eye(&extent, options, 0.0);
    let diameter = 2.0 * exhibit.polyhedron.bounding_radius();
    paint(&mesh, &extent, &view, options, diameter).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::catalogue::{CatalogueShape, Solid};

    fn exhibits(count: usize) -> Vec<Exhibit> {
        let exhibit = |solid: &Solid| Exhibit {
            label: solid.name().replace(' ', "\n"),
            polyhedron: CatalogueShape::from(*solid).polyhedron(0.1).unwrap(),
            colour: 1.0,
        };
        Solid::ALL[..count].iter().map(exhibit).collect()
    }

    #[test]
    fn every_shape_has_a_tile_with_a_body_and_a_label() {
        let image = gallery(&exhibits(5), 3, 100).unwrap();
        assert_eq!((image.width(), image.height()), (300, 2 * 113));
        let has_ink = |left: usize, top: usize, right: usize, bottom: usize| {
            let dark = |p: [u8; 3]| p.iter().map(|c| u32::from(*c)).sum::<u32>() < 600;
            (top..bottom).any(|y| (left..right).any(|x| image.pixel(x, y).is_some_and(dark)))
        };
        for k in 0..6 {
            let (left, top) = (k % 3 * 100, k / 3 * 113);
            assert_eq!(has_ink(left, top, left + 100, top + 100), k < 5, "body {k}");
            assert_eq!(
                has_ink(left, top + 101, left + 100, top + 113),
                k < 5,
                "label {k}"
            );
        }
    }

    #[test]
    fn galleries_that_cannot_be_drawn_are_refused() {
        assert!(matches!(
            gallery(&[], 3, 100),
            Err(ViewError::NothingToDraw)
        ));
        let says = |columns, tile| {
            let refused = gallery(&exhibits(1), columns, tile).err().unwrap();
            refused.to_string()
        };
        assert!(says(0, 100).contains("columns = 0"));
        assert!(says(3, 10_000).contains("width = 10000"));
    }
}
