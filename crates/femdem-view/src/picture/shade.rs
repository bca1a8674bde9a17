//! From the depth buffer to colours.

use rayon::prelude::*;

use super::canvas::Image;
use super::colour::{Light, Srgb};
use super::light::{Gaps, Lamp, Turn};
use super::raster::{DepthBuffer, NOTHING};
use super::scene::{Facet, Mesh};
use super::view::Seen;

/// Amount of light of each kind.
const SKY: f64 = 0.42;
const SKY_FROM_ABOVE: f64 = 0.14;
const LAMP: f64 = 0.76;
const EYE: f64 = 0.14;

/// The fraction of the light that remains on a line: at the border of a body, and between two of its faces.
const BORDER: f32 = 0.22;
const CREASE: f32 = 0.62;

/// Cosine of the smallest angle between two faces that counts as an edge; facets of smooth bodies meet at
/// smaller angles.
const SHARP: f64 = 0.978;

/// How much the most distant bodies fade towards the background.
const HAZE: f64 = 0.10;

/// Lights the visible part of a mesh, and averages `sub` by `sub` pixels to one.
pub(super) fn shade(mesh: &Mesh, lamp: &Lamp, gaps: &Gaps, sub: usize) -> Image {
    let seen = &gaps.seen.depth;
    let width = seen.width / sub;
    let haze = Haze::of(gaps);
    let mut pixels = vec![Srgb([0; 3]); width * (seen.height / sub)];
    let rows = pixels.par_chunks_mut(width.max(1)).enumerate();
    rows.for_each(|(y, row)| {
        for (x, to) in row.iter_mut().enumerate() {
            *to = pixel(mesh, lamp, gaps, &haze, [x * sub, y * sub], sub);
        }
    });
    Image::new(width, pixels)
}

/// One pixel of the picture. Shadow and gaps are evaluated once, at its first place that shows a body; colours,
/// facets and lines at every place.
fn pixel(
    mesh: &Mesh,
    lamp: &Lamp,
    gaps: &Gaps,
    haze: &Haze,
    [left, top]: [usize; 2],
    sub: usize,
) -> Srgb {
    let mut reach: Option<[f64; 2]> = None;
    let mut sum: Light = [0.0; 3];
    for y in top..top + sub {
        for x in left..left + sub {
            let i = y * gaps.seen.depth.width + x;
            let light = if let Some(facet) = mesh.facet(gaps.seen.facet[i]) {
                let nearness = f64::from(gaps.seen.depth.nearness[i]);
                let place = Seen {
                    x: x as f64 + 0.5,
                    y: y as f64 + 0.5,
                    nearness,
                };
                let [shared, open] = *reach.get_or_insert_with(|| {
                    let point = gaps.view.point(place);
                    let turn = Turn::of_pixel(left / sub, top / sub);
                    let n = &facet.normal;
                    [lamp.share(&point, n, turn), gaps.openness(&point, n, turn)]
                });
                let brightness = (SKY + SKY_FROM_ABOVE * facet.normal.z) * open
                    + LAMP * shared * facet.normal.dot(&lamp.direction()).max(0.0)
                    + EYE * open * facet.normal.dot(&gaps.view.toward).max(0.0);
                let ink = ink(mesh, gaps.seen, [x, y]);
                let distance = haze.amount(gaps.view.depth(nearness)) as f32;
                facet.colour.map(|c| {
                    let lit = c * brightness as f32 * ink;
                    lit + (1.0 - lit) * distance
                })
            } else {
                [1.0; 3]
            };
            for (total, part) in sum.iter_mut().zip(light) {
                *total += part;
            }
        }
    }
    Srgb::of_light(sum.map(|total| total / (sub * sub) as f32))
}

/// The fraction of the light that remains after lines: 1 away from edges.
fn ink(mesh: &Mesh, seen: &DepthBuffer, [x, y]: [usize; 2]) -> f32 {
    let here = seen.facet[y * seen.depth.width + x];
    let Some(Facet {
        normal,
        body: Some(body),
        ..
    }) = mesh.facet(here)
    else {
        return 1.0;
    };
    let mut left = 1.0_f32;
    for (dx, dy) in [(1, 0), (0, 1), (-1, 0), (0, -1)] {
        let there = seen
            .at(x as isize + dx, y as isize + dy)
            .map_or(NOTHING, |(facet, _)| facet);
        if there == here {
            continue;
        }
        let beside = mesh.facet(there).filter(|f| f.body == Some(body));
        let Some(beside) = beside else {
            return BORDER;
        };
        // Each edge between two faces is drawn on one side of it only.
        if there < here && normal.dot(&beside.normal) < SHARP {
            left = CREASE;
        }
    }
    left
}

/// The fading of distant bodies.
struct Haze {
    front: f64,
    back: f64,
}

impl Haze {
    /// From the nearest to the most distant of the pixels.
    fn of(gaps: &Gaps) -> Self {
        let depths = gaps.seen.depth.nearness.iter().filter(|n| n.is_finite());
        let (back, front) = depths.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), &n| {
            (n.min(low), n.max(high))
        });
        Self {
            front: gaps.view.depth(f64::from(front)),
            back: gaps.view.depth(f64::from(back)),
        }
    }

    fn amount(&self, depth: f64) -> f64 {
        let range = (self.front - self.back).max(f64::MIN_POSITIVE);
        HAZE * ((self.front - depth) / range).clamp(0.0, 1.0)
    }
}
