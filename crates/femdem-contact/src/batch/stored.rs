//! Whether a batch that was read hangs together.
//!
//! Lengths and indices are checked, not the numbers behind them: a checksum of the file tells those that were damaged.

use super::ContactBatch;
use super::pairs::{Cache, Pair};
use crate::body_shape::BodyShape;
use crate::contact::Partner;
use crate::error::ContactError;
use crate::walls::WallShape;

/// Refuses a batch whose parts do not fit together, or `shapes` that are not those of its bodies.
pub(super) fn check(batch: &ContactBatch, shapes: &[BodyShape]) -> Result<(), ContactError> {
    for body in batch.rigid_ids() {
        let shape = batch.body_shapes[body as usize];
        let Some(kind) = shapes.get(shape as usize) else {
            return Err(ContactError::NoSuch {
                what: "shape",
                index: shape as usize,
                count: shapes.len(),
            });
        };
        if batch.pairs.kind_of(body as usize) != Some(kind.kind()) {
            return Err(ContactError::Stored {
                what: format!("the kind, convex, sphere or mesh, of the shape of body {body}"),
            });
        }
    }
    let (bodies, walls) = (batch.body_shapes.len(), batch.walls.len());
    let table = &batch.pairs;
    let lengths = [
        ("numbers of bodies", batch.body_slots.total(), bodies),
        ("numbers of walls", batch.wall_slots.total(), walls),
        (
            "materials of bodies",
            batch.materials.of_bodies.len(),
            bodies,
        ),
        ("materials of walls", batch.materials.of_walls.len(), walls),
        ("bodies awake or asleep", batch.awake.len(), bodies),
        ("loads on bodies", batch.sums.loads.len(), bodies),
        ("lists of neighbours", table.neighbours.len(), bodies),
        ("loads on walls", batch.sums.walls.len(), walls),
        ("searches of walls", batch.wall_expires.len(), walls),
        ("kinds of walls", table.wall_count(), walls),
    ];
    for (what, found, expected) in lengths {
        if found != expected {
            return Err(ContactError::Stored {
                what: format!("the number of {what}, {found} where {expected} are right,"),
            });
        }
    }
    let is_body = |body: u32| batch.is_rigid(body);
    let mut present = (0..).zip(&batch.walls);
    let sound = batch.body_slots.is_sound()
        && batch.wall_slots.is_sound()
        && present.all(|(w, wall)| batch.wall_slots.holds(w) == wall.is_some())
        && (0..)
            .zip(&batch.awake)
            .all(|(i, awake)| !awake || is_body(i))
        && batch.bonds.are_sound(is_body)
        && batch.broadphase.fits(|body| batch.contains(body))
        && batch.awake_list.iter().all(|&i| is_body(i))
        && table.indices_fit()
        && table
            .neighbours
            .iter()
            .enumerate()
            .all(|(body, list)| list.iter().all(|n| table.is_pair_of(body as u32, n)));
    let fits = |pair: &Pair| {
        let b_is_there = is_body(pair.b);
        let a_is_there = match pair.a {
            Partner::Body(a) => is_body(a),
            Partner::Wall(a) => batch.wall(a).is_some(),
        };
        if !(a_is_there && b_is_there && table.has_its_cache(pair)) {
            return false;
        }
        let convex = |body: u32| {
            let shape = *batch.body_shapes.get(body as usize)?;
            shapes.get(shape as usize)?.convex()
        };
        let cached = match (&pair.cache, pair.a) {
            (Cache::Mesh(_) | Cache::Sphere(_), _) => true,
            (Cache::Body(cache), Partner::Body(a)) => convex(a)
                .zip(convex(pair.b))
                .is_some_and(|(a, b)| cache.fits(a, b)),
            (Cache::Wall(cache), Partner::Wall(wall)) => batch
                .wall(wall)
                .and_then(WallShape::planes)
                .zip(convex(pair.b))
                .is_some_and(|(wall, body)| cache.fits(wall, body)),
            _ => false,
        };
        let own = pair.contacts().all(|c| (c.a, c.b) == (pair.a, pair.b));
        cached && own
    };
    if sound && table.pairs().all(fits) {
        return Ok(());
    }
    Err(ContactError::Stored {
        what: "the table of pairs".to_owned(),
    })
}
