//! A job's container in the form that analysis and pictures take.

use femdem_analysis::{Region, Vessel};
use femdem_mesh::{Point3, Polyhedron};
use femdem_pack::{Container, Packing};
use femdem_view::picture::{circle, sides};
use femdem_view::sharp_edges;

use crate::Drawing;

/// Lines down the cone of a silo.
const RIBS: usize = 8;

/// Highest point of the bodies \[m\].
pub(super) fn top(packing: &Packing) -> f64 {
    let world = packing.world();
    let bodies = world.body_ids().filter_map(|id| world.bounds(id));
    bodies.map(|(_, high)| high.z).fold(0.0, f64::max)
}

/// The part of the container between upright walls, up to the rim, or to one diameter above the
/// highest body; none for a solid of any form.
pub(super) fn inside(packing: &Packing) -> Option<Region> {
    let spec = packing.spec();
    let z_min = spec.container.base();
    let filled = (top(packing) + spec.diameter()).max(z_min + spec.diameter());
    Some(match spec.container {
        Container::Mesh(_) => return None,
        Container::Box { width, depth } | Container::Periodic { width, depth } => Region::Box {
            min: Point3::new(-width / 2.0, -depth / 2.0, 0.0),
            max: Point3::new(width / 2.0, depth / 2.0, filled),
        },
        Container::Cylinder { diameter } | Container::Silo { diameter, .. } => Region::Cylinder {
            centre: [0.0; 2],
            radius: diameter / 2.0,
            z_min,
            z_max: filled,
        },
    })
}

/// What the bed lies in, if that is more than the part between upright walls.
pub(super) fn vessel(packing: &Packing) -> Option<Vessel> {
    let container = &packing.spec().container;
    match *container {
        Container::Box { .. } | Container::Periodic { .. } | Container::Cylinder { .. } => None,
        Container::Silo {
            diameter, outlet, ..
        } => Some(Vessel::Silo {
            centre: [0.0; 2],
            radius: diameter / 2.0,
            outlet_radius: outlet / 2.0,
            floor: 0.0,
            waist: container.base(),
        }),
        Container::Mesh(ref mesh) => Some(Vessel::Solid {
            surface: Box::new(mesh.surface().clone()),
            floor: 0.0,
        }),
    }
}

/// What a picture shows of a container that is more than upright walls or has a rim.
pub(super) fn drawing(packing: &Packing) -> Option<Drawing> {
    let spec = packing.spec();
    let above = top(packing) + 0.6 * spec.diameter();
    match spec.container {
        Container::Mesh(ref mesh) => Some(of_solid(mesh.surface())),
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
        Container::Box { .. } | Container::Periodic { .. } | Container::Cylinder { .. } => {
            let rim = spec.rim?;
            Some(Drawing::of_region(&inside(packing)?, rim))
        }
    }
}

/// The sharp edges of a solid, on a floor as wide as itself.
fn of_solid(solid: &Polyhedron) -> Drawing {
    let reach = |k: usize| {
        solid
            .vertices()
            .iter()
            .map(|p| p[k].abs())
            .fold(0.0, f64::max)
    };
    let (x, y) = (reach(0), reach(1));
    let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
    Drawing {
        floor: corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec(),
        lines: sharp_edges(solid.vertices(), &solid.triangles()),
    }
}
