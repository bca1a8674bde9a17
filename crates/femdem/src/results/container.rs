//! A job's container, as analysis and pictures see it.

use femdem_analysis::Region;
use femdem_mesh::Point3;
use femdem_pack::{Container, Packing};

use crate::Drawing;
use crate::picture::{circle, sides};

/// Lines down the cone of a silo.
const RIBS: usize = 8;

/// Highest point of the bodies \[m\].
pub(super) fn top(packing: &Packing) -> f64 {
    let bodies = (0..).map_while(|id| packing.world().bounds(id));
    bodies.map(|(_, high)| high.z).fold(0.0, f64::max)
}

/// The part of the container between upright walls, up to the rim, or to one diameter above the
/// highest body.
pub(super) fn inside(packing: &Packing) -> Region {
    let spec = packing.spec();
    let z_min = spec.container.base();
    let filled = (top(packing) + spec.diameter()).max(z_min + spec.diameter());
    match spec.container {
        Container::Box { width, depth } => Region::Box {
            min: Point3::new(-width / 2.0, -depth / 2.0, 0.0),
            max: Point3::new(width / 2.0, depth / 2.0, filled),
        },
        Container::Cylinder { diameter } | Container::Silo { diameter, .. } => Region::Cylinder {
            centre: [0.0; 2],
            radius: diameter / 2.0,
            z_min,
            z_max: filled,
        },
    }
}

/// What a picture shows of a container that is more than upright walls or has a rim.
pub(super) fn drawing(packing: &Packing) -> Option<Drawing> {
    let spec = packing.spec();
    let above = top(packing) + 0.6 * spec.diameter();
    match spec.container {
        Container::Silo {
            diameter, outlet, ..
        } => {
            let at = |z: f64, radius: f64| circle(Point3::new(0.0, 0.0, z), radius, 0.0);
            let base = spec.container.base();
            let foot = at(0.0, outlet / 2.0);
            let waist = at(base, diameter / 2.0);
            let rim = at(spec.rim.unwrap_or(above).max(base), diameter / 2.0);
            let step = foot.len() / RIBS;
            let ribs = foot.iter().zip(&waist).step_by(step).map(|(a, b)| [*a, *b]);
            let posts = waist.iter().zip(&rim).step_by(step).map(|(a, b)| [*a, *b]);
            let rings = sides(&foot).chain(sides(&waist)).chain(sides(&rim));
            Some(Drawing {
                lines: ribs.chain(posts).chain(rings).collect(),
                floor: foot,
            })
        }
        Container::Box { .. } | Container::Cylinder { .. } => {
            let rim = spec.rim?;
            Some(crate::picture::outline(&inside(packing), rim))
        }
    }
}
