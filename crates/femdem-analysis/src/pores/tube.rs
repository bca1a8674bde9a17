//! The surface of a region: the tube around a pack.

use std::f64::consts::PI;

use femdem_mesh::Point3;

use super::surface::{Surface, SurfacePatch};
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::{NOT_UPRIGHT, Region};

/// Facets around a cylinder.
const FACETS: u32 = 360;

/// The closed surface of a box or a cylinder, with its sides and ends as parts; sides along axes on which space `repeats` itself
/// are parts of their own. A cylinder has 360 facets that touch
/// it from outside, so that none cuts into what is inside: its volume is larger by 2.5e-5 of itself.
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a ball.
pub fn tube_surface(region: &Region, repeats: [bool; 3]) -> Result<Surface, AnalysisError> {
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
    // In the order of the outline of a box.
    let sides = [
        (1, SurfacePatch::YLow),
        (0, SurfacePatch::XHigh),
        (1, SurfacePatch::YHigh),
        (0, SurfacePatch::XLow),
    ];
    let is_box = matches!(region, Region::Box { .. });
    let part = |side: usize| match sides.get(side) {
        Some((axis, part)) if is_box && repeats[*axis] => *part,
        _ => SurfacePatch::Sides,
    };
    let next = outline.iter().cycle().skip(1);
    for (side, (p, q)) in outline.iter().zip(next).enumerate() {
        let [a, b, c, d] = [at(p, low), at(q, low), at(q, high), at(p, high)];
        surface.push([a, b, c], part(side));
        surface.push([a, c, d], part(side));
        surface.push([at(&middle, low), b, a], SurfacePatch::Low);
        surface.push([at(&middle, high), d, c], SurfacePatch::High);
    }
    Ok(surface)
}

/// Depth, in mean diameters, by which bodies may reach below the floor of a container that they rest on.
const SUNKEN: f64 = 0.1;

/// The space that a flow through a pack is computed in: a box or a cylinder as wide as `container`, from `margin` (m)
/// below the lowest body to `margin` above the highest. Where bodies reach clearly below the container, as into the
/// cone of a silo, it begins at the floor and cuts them.
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::RegionKind`] for a ball,
/// [`AnalysisError::Option`] for a margin that is negative or not finite.
pub fn flow_region(pack: &Pack, container: &Region, margin: f64) -> Result<Region, AnalysisError> {
    container.validate()?;
    if !(margin >= 0.0 && margin.is_finite()) {
        return Err(AnalysisError::Option {
            name: "margin",
            value: margin,
            allowed: "zero or more and finite (m)",
        });
    }
    let slack = SUNKEN * pack.mean_diameter()?;
    let heights = (0..pack.len()).map(|i| [pack.bounds(i).min.z, pack.bounds(i).max.z]);
    let [lowest, highest] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |all, own| {
        [all[0].min(own[0]), all[1].max(own[1])]
    });
    let floor = container.corners().0.z;
    let low = if lowest < floor - slack {
        floor
    } else {
        lowest - margin
    };
    let mut region = *container;
    match &mut region {
        Region::Box { min, max } => (min.z, max.z) = (low, highest + margin),
        Region::Cylinder { z_min, z_max, .. } => (*z_min, *z_max) = (low, highest + margin),
        Region::Sphere { .. } => return Err(NOT_UPRIGHT),
    }
    region.validate()?;
    Ok(region)
}
