//! The inside of the container that walls of planes form.

use femdem_analysis::{PeriodicSpace, Region};
use femdem_contact::{WallPlane, WallShape};
use femdem_mesh::{Point3, Pose, Vector3};

use crate::Snapshot;

/// A normal is level or upright, and a mantle round, to this.
const EXACT: f64 = 1e-9;

/// A wall has at least so many upright planes if it is a mantle.
const FACETS: usize = 8;

/// The space that upright walls or the sides of a periodic cell bound, from the floor, or the upper end of a cone, to the lid, or one mean diameter above the
/// highest body. `None` where they do not bound a box or an upright cylinder with a floor, and where a wall is no plane.
pub(super) fn inside<'a>(
    walls: impl Iterator<Item = (&'a WallShape, Pose)>,
    snapshot: &Snapshot,
) -> Option<Region> {
    let (mut planes, mut mantle) = (Vec::new(), None);
    for (wall, pose) in walls {
        let own: Vec<WallPlane> = wall
            .planes()?
            .planes()
            .iter()
            .map(|p| posed(p, &pose))
            .collect();
        match own.len() < FACETS || own.iter().any(|plane| !is_level(&plane.normal)) {
            true => planes.extend(own),
            false if mantle.is_none() => mantle = Some(round(&own)?),
            false => return None,
        }
    }
    let mut floor = f64::NEG_INFINITY;
    let mut lid = f64::INFINITY;
    let mut low = [f64::NEG_INFINITY; 2];
    let mut high = [f64::INFINITY; 2];
    for WallPlane { normal, offset } in planes {
        if normal.z > 1.0 - EXACT {
            floor = floor.max(offset);
        } else if normal.z < EXACT - 1.0 {
            lid = lid.min(-offset);
        } else if let Some(k) = (0..2).find(|&k| normal[k].abs() > 1.0 - EXACT) {
            if normal[k] > 0.0 {
                low[k] = low[k].max(offset);
            } else {
                high[k] = high[k].min(-offset);
            }
        } else if let (Some(([x, y], radius)), true) = (mantle, normal.z > EXACT) {
            // A plane of a cone meets the mantle at this height.
            let on_axis = offset - normal.x * x - normal.y * y;
            floor = floor.max((on_axis + normal.xy().norm() * radius) / normal.z);
        } else {
            return None;
        }
    }
    let [top, diameter] = extent(snapshot);
    let mut z_max = lid.min((top + diameter).max(floor + diameter));
    if let Some(PeriodicSpace { cell, lower }) = &snapshot.space {
        let side = |k: usize| (lower[k], lower[k] + cell.edges()[(k, k)]);
        for k in (0..2).filter(|&k| cell.repeats(k)) {
            (low[k], high[k]) = side(k);
        }
        if cell.repeats(2) {
            (floor, z_max) = side(2);
        }
    }
    let region = match mantle {
        Some((centre, radius)) => Region::Cylinder {
            centre,
            radius,
            z_min: floor,
            z_max,
        },
        None => Region::Box {
            min: Point3::new(low[0], low[1], floor),
            max: Point3::new(high[0], high[1], z_max),
        },
    };
    // Where a side is open it is no region.
    region.validate().is_ok().then_some(region)
}

fn posed(plane: &WallPlane, pose: &Pose) -> WallPlane {
    let normal = pose.rotation * plane.normal;
    WallPlane {
        normal,
        offset: plane.offset + normal.dot(&pose.translation.vector),
    }
}

fn is_level(normal: &Vector3) -> bool {
    normal.z.abs() <= EXACT
}

/// Axis and radius of the upright cylinder that planes touch all around, evenly.
fn round(planes: &[WallPlane]) -> Option<([f64; 2], f64)> {
    let count = planes.len() as f64;
    let radius = -planes.iter().map(|plane| plane.offset).sum::<f64>() / count;
    let toward = planes.iter().map(|p| p.normal * (p.offset + radius));
    let centre = toward.sum::<Vector3>() * (2.0 / count);
    let mut gaps = planes
        .iter()
        .map(|p| p.normal.dot(&centre) - p.offset - radius);
    let fits = radius > 0.0 && gaps.all(|gap| gap.abs() <= EXACT * radius);
    fits.then_some(([centre.x, centre.y], radius))
}

/// Highest point of the bodies, and their mean circumscribed diameter, m.
fn extent(snapshot: &Snapshot) -> [f64; 2] {
    let (mut top, mut sum) = (f64::NEG_INFINITY, 0.0);
    for body in &snapshot.bodies {
        let surface = &snapshot.shapes[body.shape as usize].polyhedron;
        let points = surface.vertices().iter().map(|p| (body.pose * p).z);
        top = points.fold(top, f64::max);
        sum += 2.0 * surface.bounding_radius();
    }
    [top, sum / snapshot.bodies.len() as f64]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Body, NamedShape};
    use femdem_contact::Wall;
    use femdem_pack::Container;

    /// A cube with a diagonal of 0.02 m whose centre is at a height of 0.05 m.
    fn snapshot() -> Snapshot {
        let cube = "P5".parse::<femdem_mesh::catalogue::CatalogueShape>();
        Snapshot {
            shapes: vec![NamedShape {
                name: "cube".to_owned(),
                polyhedron: cube.unwrap().polyhedron(0.02).unwrap(),
            }],
            bodies: vec![Body {
                shape: 0,
                pose: Pose::translation(0.0, 0.0, 0.05),
                sequence: 0,
                sleeping: false,
            }],
            ..Snapshot::default()
        }
    }

    fn region(walls: &[WallShape], at: Pose) -> Option<Region> {
        inside(walls.iter().map(|wall| (wall, at)), &snapshot())
    }

    fn close(region: &Region, low: [f64; 3], high: [f64; 3]) {
        let (min, max) = region.corners();
        let all = |a: Point3, b: [f64; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 1e-12);
        assert!(all(min, low) && all(max, high), "{region:?}");
    }

    #[test]
    fn containers_of_packs_have_their_insides() {
        let top = 0.05 + 0.01 / 3_f64.sqrt() + 0.02;
        let (width, depth) = (0.2, 0.1);
        let mut walls = Container::Box { width, depth }.walls().unwrap();
        let found = region(&walls, Pose::identity()).unwrap();
        close(&found, [-0.1, -0.05, 0.0], [0.1, 0.05, top]);
        // Lower under a lid, and elsewhere with all walls.
        walls.push(
            Wall::half_space("lid", -Vector3::z(), -0.06)
                .unwrap()
                .into(),
        );
        let found = region(&walls, Pose::translation(1.0, 0.0, 0.001)).unwrap();
        close(&found, [0.9, -0.05, 0.001], [1.1, 0.05, 0.061]);
        assert!(region(&walls[..4], Pose::identity()).is_none());

        let silo = Container::Silo {
            diameter: 0.2,
            outlet: 0.16,
            half_angle: 45.0,
        };
        let found = region(&silo.walls().unwrap(), Pose::translation(0.0, 2.0, 0.0));
        close(&found.unwrap(), [-0.1, 1.9, 0.02], [0.1, 2.1, top]);
    }
}
