//! The mean top of a pack.

use femdem_contact::BodyId;
use femdem_mesh::Vector3;
use femdem_solve::World;
use std::collections::BTreeMap;

/// Centroids of all bodies.
pub(super) fn positions(world: &World) -> impl Iterator<Item = (BodyId, Vector3)> {
    let bodies = world.body_ids();
    bodies.filter_map(|body| Some((body, world.position(body)?)))
}

/// Mean top of a pack, m: the floor plan is divided into squares of side d, and the highest points
/// of the bodies whose centroids are over each square are averaged over the squares that have any. In periodic space
/// it is the plan of the cell, with the images of the bodies that lie in it.
pub(crate) fn mean_top(world: &World, diameter: f64) -> f64 {
    let mut columns: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for (body, p) in positions(world) {
        if let Some((_, high)) = world.bounds(body) {
            let p = world.cell().map_or(p, |cell| cell.wrapped(&p));
            let square = |x: f64| (x / diameter).floor() as i64;
            let column = columns.entry((square(p.x), square(p.y))).or_insert(0.0);
            *column = column.max(high.z);
        }
    }
    if columns.is_empty() {
        0.0
    } else {
        columns.values().sum::<f64>() / columns.len() as f64
    }
}
