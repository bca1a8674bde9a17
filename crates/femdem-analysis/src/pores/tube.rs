//! The surface of a region: the tube around a pack.

use std::f64::consts::PI;

use femdem_mesh::Point3;

use super::surface::{Surface, SurfacePatch};
use crate::error::AnalysisError;
use crate::region::{NOT_UPRIGHT, Region};

/// Facets around a cylinder.
const FACETS: u32 = 360;

/// The closed surface of a box or a cylinder, with its sides and ends as parts. A cylinder has 360 facets that touch
/// it from outside, so that none cuts into what is inside: its volume is larger by 2.5e-5 of itself.
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a ball.
pub fn tube_surface(region: &Region) -> Result<Surface, AnalysisError> {
    region.validate()?;
    let (low, high) = region.corners();
    let outline: Vec<[f64; 2]> = match *region {
        Region::Box { min, max } => vec![
            [min.x, min.y],
            [max.x, min.y],
            [max.x, max.y],
            [min.x, max.y],
        ],
        Region::Cylinder { centre, radius, .. } => {
            let step = 2.0 * PI / f64::from(FACETS);
            let corner = |i: u32| {
                let (sin, cos) = (f64::from(i) * step).sin_cos();
                let reach = radius / (0.5 * step).cos();
                [centre[0] + reach * cos, centre[1] + reach * sin]
            };
            (0..FACETS).map(corner).collect()
        }
        Region::Sphere { .. } => return Err(NOT_UPRIGHT),
    };
    let (low, high) = (low.z, high.z);
    let middle = {
        let (a, b) = region.corners();
        let half = (a.coords + b.coords) * 0.5;
        [half.x, half.y]
    };
    let at = |p: &[f64; 2], z: f64| Point3::new(p[0], p[1], z);
    let mut surface = Surface::default();
    let next = outline.iter().cycle().skip(1);
    for (p, q) in outline.iter().zip(next) {
        let [a, b, c, d] = [at(p, low), at(q, low), at(q, high), at(p, high)];
        surface.push([a, b, c], SurfacePatch::Sides);
        surface.push([a, c, d], SurfacePatch::Sides);
        surface.push([at(&middle, low), b, a], SurfacePatch::Low);
        surface.push([at(&middle, high), d, c], SurfacePatch::High);
    }
    Ok(surface)
}
