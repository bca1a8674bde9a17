//! A mesh as pixels: the eye, the lamp, and the edges of the container.

use femdem_mesh::Point3;

use super::canvas::Image;
use super::colour::Srgb;
use super::light::{Gaps, Lamp};
use super::options::PictureOptions;
use super::raster::{DepthBuffer, DepthMap};
use super::scale_bar;
use super::scene::Mesh;
use super::shade;
use super::view::{Frame, View, span};
use crate::Drawing;

/// Pixels of the depth buffer for each pixel of the picture, along each axis.
const SUPERSAMPLING: usize = 2;

/// Width of the strip for the colour bar, in picture widths.
pub(super) const LEGEND: f64 = 0.11;

const OUTLINE: Srgb = Srgb([0x70, 0x70, 0x70]);

/// Draws a mesh seen from `view`, and returns what is visible at each pixel.
pub(super) fn paint(
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
    let gaps = Gaps::new(view, &seen, 0.55 * diameter);
    let image = shade::shade(mesh, &lamp, &gaps, SUPERSAMPLING);
    (image, seen)
}

/// The eye, in pixels of the depth buffer: a mild perspective from the front, beside a strip of
/// `legend` picture widths at the right edge, and above that of the scale bar where there is a legend.
pub(super) fn eye(extent: &[Point3], options: &PictureOptions, legend: f64) -> View {
    let (width, height) = (options.width as f64, options.height as f64);
    let sub = SUPERSAMPLING as f64;
    let margin = 0.035 * width.min(height);
    let below = if legend > 0.0 {
        scale_bar::STRIP * height
    } else {
        0.0
    };
    let frame = Frame {
        left: sub * margin,
        top: sub * margin,
        right: sub * (width - legend * width - if legend > 0.0 { 1.5 } else { 1.0 } * margin),
        bottom: sub * (height - margin - below),
    };
    let (azimuth, elevation) = (options.azimuth.to_radians(), options.elevation.to_radians());
    let [low, high] = span(extent);
    View::fit(azimuth, elevation, 3.0 * (high - low).norm(), extent, frame)
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
pub(super) fn radius(points: &[Point3]) -> f64 {
    let count = points.len().max(1) as f64;
    let mean = points
        .iter()
        .fold(Point3::origin().coords, |sum, p| sum + p.coords / count);
    points
        .iter()
        .map(|p| (p.coords - mean).norm())
        .fold(0.0, f64::max)
}

/// Pixels of the picture for a metre in the middle of what is drawn.
pub(super) fn pixels_per_metre(view: &View) -> f64 {
    view.scale / SUPERSAMPLING as f64
}

/// Draws the container's edges, faint where bodies hide them.
pub(super) fn draw_outline(image: &mut Image, outline: &Drawing, view: &View, seen: &DepthBuffer) {
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
