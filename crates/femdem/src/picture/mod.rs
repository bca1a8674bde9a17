//! Pictures of a pack, drawn without a GPU.
//!
//! Triangles are drawn into a depth buffer. Then each pixel is lit by a lamp with soft shadows and by a sky
//! that is less visible from narrow gaps, and the edges of bodies and faces are drawn. Bodies are coloured by
//! sequence of placement with viridis, which is perceptually uniform.
//!
//! ```
//! use femdem::mesh::{Pose, catalogue::Solid, catalogue::CatalogueShape};
//! use femdem::picture::{PictureOptions, draw};
//! use femdem::{Body, NamedShape, Snapshot};
//!
//! let polyhedron = CatalogueShape::from(Solid::A10).polyhedron(0.1)?;
//! let body = Body { shape: 0, pose: Pose::identity(), sequence: 0, sleeping: false };
//! let shapes = vec![NamedShape { name: "A10".to_owned(), polyhedron }];
//! let snapshot = Snapshot { shapes, bodies: vec![body], ..Snapshot::default() };
//! let image = draw(&snapshot, &PictureOptions { width: 200, height: 200, ..Default::default() })?;
//! image.write_png(std::io::sink())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod canvas;
mod colour;
mod font;
mod gallery;
mod legend;
mod light;
mod raster;
mod scene;
mod shade;
mod skin;
mod view;

use femdem_analysis::Region;
use femdem_mesh::Point3;

pub use canvas::Image;
pub use gallery::{Exhibit, gallery};
pub use skin::{Skin, draw_skins};

use crate::{BodyValues, Colouring, Drawing, Error, Snapshot};
use colour::Srgb;
use light::{Gaps, Lamp};
use raster::{DepthBuffer, DepthMap};
use scene::Mesh;
pub(crate) use scene::{circle, sides};
use view::{Frame, View};

/// Pixels of the depth buffer for each pixel of the picture, along each axis.
const SUPERSAMPLING: usize = 2;

/// Width of the strip for the colour bar, in picture widths.
const LEGEND: f64 = 0.11;

const OUTLINE: Srgb = Srgb([0x70, 0x70, 0x70]);

/// Size and point of view of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    /// Width in pixels, 16 to 8192. Default 1200.
    pub width: usize,
    /// Height in pixels, 16 to 8192. Default 1200.
    pub height: usize,
    /// Azimuth of the eye, to the right of the front, degrees. Default 24.
    pub azimuth: f64,
    /// Elevation of the eye, −90 to 90 degrees. Default 16.
    pub elevation: f64,
}

impl Default for PictureOptions {
    fn default() -> Self {
        Self {
            width: 1200,
            height: 1200,
            azimuth: 24.0,
            elevation: 16.0,
        }
    }
}

impl PictureOptions {
    fn check(&self) -> Result<(), Error> {
        for (name, value) in [("width", self.width), ("height", self.height)] {
            if !(16..=8192).contains(&value) {
                let allowed = "16 to 8192 pixels";
                return Err(Error::Option {
                    name,
                    value: value.to_string(),
                    allowed,
                });
            }
        }
        let angles = [
            ("azimuth", self.azimuth, 360.0, "-360 to 360 degrees"),
            ("elevation", self.elevation, 90.0, "-90 to 90 degrees"),
        ];
        for (name, value, most, allowed) in angles {
            if !(-most..=most).contains(&value) {
                return Err(Error::Option {
                    name,
                    value: value.to_string(),
                    allowed,
                });
            }
        }
        Ok(())
    }
}

/// Draws a pack, coloured by sequence, with its container if it has one and a colour bar.
///
/// Works on the caller's rayon pool; the picture is the same for any number of threads.
///
/// # Errors
///
/// [`Error::Option`], [`Error::NothingToDraw`] without bodies, and as [`Snapshot::check`].
pub fn draw(snapshot: &Snapshot, options: &PictureOptions) -> Result<Image, Error> {
    match Colouring::Sequence.values(snapshot, None)? {
        Some(values) => draw_by(snapshot, &values, options),
        None => Err(Error::NothingToDraw),
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
) -> Result<Image, Error> {
    options.check()?;
    snapshot.check()?;
    let mut mesh = Mesh::of_bodies(snapshot, values);
    if mesh.is_empty() {
        return Err(Error::NothingToDraw);
    }
    let diameter = mean_diameter(snapshot);
    let azimuth = options.azimuth.to_radians();
    let top = mesh.points().map(|p| p.z).fold(f64::NEG_INFINITY, f64::max);
    let of_region = |region: &Region| {
        let height = region.corners().1.z.min(top + 0.6 * diameter);
        scene::outline(region, height, azimuth)
    };
    let drawing = snapshot.drawing.clone();
    let outline = drawing.or_else(|| snapshot.container.as_ref().map(of_region));
    if let Some(outline) = &outline {
        mesh.add_floor(&outline.floor);
    }

    let mut extent = bounding_corners(mesh.points());
    extent.extend(outline.iter().flat_map(|o| o.lines.iter().flatten()));
    let view = eye(&extent, options, LEGEND);
    let (mut image, seen) = paint(&mesh, &extent, &view, options, diameter);

    if let Some(outline) = &outline {
        draw_outline(&mut image, outline, &view, &seen);
    }
    legend::draw(&mut image, LEGEND * options.width as f64, values);
    Ok(image)
}

/// The drawing of an upright container up to a height \[m\], for the usual point of view.
pub(crate) fn outline(container: &Region, top: f64) -> Drawing {
    let azimuth = PictureOptions::default().azimuth;
    scene::outline(container, top, azimuth.to_radians())
}

/// A small picture of values, 0 to 1, row by row from the top, in viridis as PNG.
pub(crate) fn viridis_png(
    width: usize,
    values: impl Iterator<Item = f64>,
) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    Image::new(width, values.map(colour::viridis).collect()).write_png(&mut bytes)?;
    Ok(bytes)
}

/// Draws a mesh seen from `view`, and returns what is visible at each pixel.
fn paint(
    mesh: &Mesh,
    extent: &[Point3],
    view: &View,
    options: &PictureOptions,
    diameter: f64,
) -> (Image, DepthBuffer) {
    let [width, height] = [options.width, options.height].map(|size| SUPERSAMPLING * size);
    let seen = DepthBuffer::of(mesh, view, width, height);
    let lamp = lamp(
        mesh,
        extent,
        options.azimuth.to_radians(),
        diameter,
        width.max(height).min(4096),
    );
    let gaps = Gaps {
        view,
        seen: &seen,
        reach: 0.55 * diameter,
    };
    let image = shade::shade(mesh, &lamp, &gaps, SUPERSAMPLING);
    (image, seen)
}

/// Mean circumscribed diameter of the bodies \[m\].
fn mean_diameter(snapshot: &Snapshot) -> f64 {
    let diameter = |body| 2.0 * snapshot.shape_of(body).polyhedron.bounding_radius();
    snapshot.bodies.iter().map(diameter).sum::<f64>() / snapshot.bodies.len() as f64
}

/// Corners of the box around the points.
fn bounding_corners(points: impl Iterator<Item = Point3>) -> Vec<Point3> {
    let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [low, high] = points.fold(start, |[low, high], p| {
        let least = [0, 1, 2].map(|k| p[k].min(low[k]));
        [least, [0, 1, 2].map(|k| p[k].max(high[k]))]
    });
    let corner =
        |i: usize| Point3::from([0, 1, 2].map(|k| if i >> k & 1 == 0 { low[k] } else { high[k] }));
    (0..8).map(corner).collect()
}

/// The eye, in pixels of the depth buffer: a mild perspective from the front, beside a strip of
/// `legend` picture widths at the right edge.
fn eye(extent: &[Point3], options: &PictureOptions, legend: f64) -> View {
    let (width, height) = (options.width as f64, options.height as f64);
    let sub = SUPERSAMPLING as f64;
    let margin = 0.035 * width.min(height);
    let frame = Frame {
        left: sub * margin,
        top: sub * margin,
        right: sub * (width - legend * width - if legend > 0.0 { 1.5 } else { 1.0 } * margin),
        bottom: sub * (height - margin),
    };
    let (azimuth, elevation) = (options.azimuth.to_radians(), options.elevation.to_radians());
    View::fit(azimuth, elevation, 6.0 * radius(extent), extent, frame)
}

/// The lamp: above, in front and to the left of the eye, far away.
fn lamp(mesh: &Mesh, extent: &[Point3], azimuth: f64, diameter: f64, size: usize) -> Lamp {
    let edge = size as f64;
    let frame = Frame {
        left: 1.0,
        top: 1.0,
        right: edge - 1.0,
        bottom: edge - 1.0,
    };
    let view = View::fit(azimuth - 0.75, 0.9, f64::INFINITY, extent, frame);
    let seen = DepthMap::of(mesh, &view, size, size);
    Lamp::new(view, seen, 0.045 * diameter)
}

/// Largest distance of the points from their mean \[m\].
fn radius(points: &[Point3]) -> f64 {
    let count = points.len().max(1) as f64;
    let mean = points
        .iter()
        .fold(Point3::origin().coords, |sum, p| sum + p.coords / count);
    points
        .iter()
        .map(|p| (p.coords - mean).norm())
        .fold(0.0, f64::max)
}

/// Draws the container's edges, faint where bodies hide them.
fn draw_outline(image: &mut Image, outline: &Drawing, view: &View, seen: &DepthBuffer) {
    let sub = SUPERSAMPLING as f64;
    let line_width = image.width() as f64 / 800.0;
    for [from, to] in &outline.lines {
        let ends = [view.see(from), view.see(to)];
        let place = ends.map(|end| [end.x / sub, end.y / sub]);
        let along = [place[1][0] - place[0][0], place[1][1] - place[0][1]];
        let length2 = (along[0] * along[0] + along[1] * along[1]).max(f64::MIN_POSITIVE);
        image.stroke(&[place], line_width, OUTLINE, |x, y| {
            let [dx, dy] = [x as f64 + 0.5 - place[0][0], y as f64 + 0.5 - place[0][1]];
            let t = ((dx * along[0] + dy * along[1]) / length2).clamp(0.0, 1.0);
            let near = ends[0].nearness + t * (ends[1].nearness - ends[0].nearness);
            let hidden = seen
                .at((x * SUPERSAMPLING) as isize, (y * SUPERSAMPLING) as isize)
                .is_some_and(|(_, front)| f64::from(front) > near * (1.0 + 1e-4));
            if hidden { 0.0 } else { 0.9 }
        });
    }
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
        assert!(matches!(nothing, Err(Error::NothingToDraw)));
    }
}
