//! Pictures of packs.

use femdem_analysis::Region;
use femdem_mesh::Point3;

use super::canvas::Image;
use super::legend;
use super::options::PictureOptions;
use super::paint::{LEGEND, draw_outline, eye, paint, pixels_per_metre};
use super::scale_bar;
use super::scene::Mesh;
use crate::{BodyValues, Colouring, Drawing, Snapshot, ViewError};

/// Draws a pack, coloured by sequence, with its container if it has one and a colour bar.
///
/// Works on the caller's rayon pool; the picture is the same for any number of threads.
///
/// # Errors
///
/// [`ViewError::Option`], [`ViewError::NothingToDraw`] without bodies, and as [`Snapshot::check`].
pub fn draw(snapshot: &Snapshot, options: &PictureOptions) -> Result<Image, ViewError> {
    match Colouring::Sequence.values(snapshot, None)? {
        Some(values) => draw_by(snapshot, &values, options),
        None => Err(ViewError::NothingToDraw),
    }
}

/// Draws a pack, coloured by `values`, with its container if it has one and a colour bar.
///
/// # Errors
///
/// As [`draw`].
pub fn draw_by(
    snapshot: &Snapshot,
    values: &BodyValues,
    options: &PictureOptions,
) -> Result<Image, ViewError> {
    options.check()?;
    snapshot.check()?;
    let mut mesh = Mesh::of_bodies(snapshot, values);
    if mesh.is_empty() {
        return Err(ViewError::NothingToDraw);
    }
    let diameter = mean_diameter(snapshot);
    let azimuth = options.azimuth.to_radians();
    let top = mesh.points().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let of_region = |region: &Region| {
        let height = region.corners().1.z.min(top + 0.6 * diameter);
        Drawing::seen_from(azimuth, region, height)
    };
    let drawing = snapshot.drawing.clone();
    let outline = drawing.or_else(|| snapshot.container.as_ref().map(of_region));
    if let Some(outline) = &outline {
        mesh.add_floor(&outline.floor);
    }

    let mut extent: Vec<Point3> = mesh.points().collect();
    extent.extend(outline.iter().flat_map(|o| o.lines.iter().flatten()));
    let view = eye(&extent, options, LEGEND);
    let (mut image, seen) = paint(&mesh, &extent, &view, options, diameter);

    if let Some(outline) = &outline {
        draw_outline(&mut image, outline, &view, &seen);
    }
    scale_bar::draw(&mut image, pixels_per_metre(&view));
    legend::draw(&mut image, LEGEND * options.width as f64, values);
    Ok(image)
}

/// Mean circumscribed diameter of the bodies \[m\].
fn mean_diameter(snapshot: &Snapshot) -> f64 {
    let diameter = |body| 2.0 * snapshot.shape_of(body).polyhedron.bounding_radius();
    snapshot.bodies.iter().map(diameter).sum::<f64>() / snapshot.bodies.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    fn small() -> PictureOptions {
        PictureOptions {
            width: 160,
            height: 120,
            ..PictureOptions::default()
        }
    }

    #[test]
    fn the_upper_cube_is_yellow_the_lower_violet_and_the_corner_white() {
        let image = draw(
            &two_cubes(),
            &PictureOptions {
                azimuth: 0.0,
                elevation: 0.0,
                ..small()
            },
        )
        .unwrap();
        assert_eq!((image.width(), image.height()), (160, 120));
        assert_eq!(image.pixel(0, 0), Some([255; 3]));
        // The stack is in the middle between the margins and the strip of the colour bar.
        let column: Vec<[u8; 3]> = (0..120).filter_map(|y| image.pixel(68, y)).collect();
        let is_yellow = |p: &&[u8; 3]| p[0] > 120 && p[1] > 100 && p[2] < p[1] / 2;
        let is_violet = |p: &&[u8; 3]| p[2] > p[1].saturating_add(30);
        let first_violet = column.iter().position(|p| is_violet(&p)).unwrap();
        assert!(column.iter().filter(is_yellow).count() > 20);
        assert!(column.iter().filter(is_violet).count() > 20);
        assert!(column[first_violet..].iter().all(|p| !is_yellow(&p)));
    }

    #[test]
    fn same_picture_at_any_number_of_threads() {
        let pool = |n| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(n)
                .build()
                .unwrap()
        };
        let one = pool(1).install(|| draw(&two_cubes(), &small())).unwrap();
        let three = pool(3).install(|| draw(&two_cubes(), &small())).unwrap();
        assert!(one == three);
    }

    #[test]
    fn bad_options_and_empty_packs_are_refused() {
        let refused = |options| draw(&two_cubes(), &options).err().unwrap().to_string();
        assert!(
            refused(PictureOptions {
                width: 0,
                ..small()
            })
            .contains("width = 0")
        );
        assert!(
            refused(PictureOptions {
                elevation: f64::NAN,
                ..small()
            })
            .contains("elevation = NaN")
        );
        let nothing = draw(&Snapshot::default(), &small());
        assert!(matches!(nothing, Err(ViewError::NothingToDraw)));
    }
}
