//! The mean top of a pack.

use femdem_contact::{BodyId, PeriodicCell};
use femdem_mesh::Vector3;
use femdem_solve::World;
use std::collections::BTreeMap;

/// Centroid of a body, and the height of its highest point, m.
pub(crate) fn place_and_top(world: &World, body: BodyId) -> Option<(Vector3, f64)> {
    let (_, high) = world.bounds(body)?;
    Some((world.position(body)?, high.z))
}

/// Mean top of a pack, m: the floor plan is divided into squares of side d, and the highest points
/// of the bodies whose centroids are over each square are averaged over the squares that have any. In periodic space
/// it is the plan of the cell, with the images of the bodies that lie in it.
pub(crate) fn mean_top(
    bodies: impl Iterator<Item = (Vector3, f64)>,
    cell: Option<&PeriodicCell>,
    diameter: f64,
) -> f64 {
    let mut columns: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for (p, top) in bodies {
        let p = cell.map_or(p, |cell| cell.wrapped(&p));
        let square = |x: f64| (x / diameter).floor() as i64;
        let column = columns.entry((square(p.x), square(p.y))).or_insert(0.0);
        *column = column.max(top);
    }
    if columns.is_empty() {
        0.0
    } else {
        columns.values().sum::<f64>() / columns.len() as f64
    }
}
