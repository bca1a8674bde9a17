//! Recovering the corners and sharp edges of a surface.

use super::body::Body;
use super::draft::{Draft, Place, edges};
use crate::{MeshError, Point3};

/// Radius ratios that moving or inserting a point must leave; smoothing improves them.
const FLOOR: f64 = 0.1;
/// Corners take a point of the skin from as far as this part of the lattice's length.
const REACH: f64 = 0.9;
/// Points of the skin tried for one corner.
const TRIES: usize = 8;
/// Rounds of moving points to sharp edges and smoothing.
const ROUNDS: usize = 3;

/// Moves points of the skin to corners and sharp edges, and inserts points where none can be moved.
pub(super) fn snap(draft: &mut Draft, body: &Body, length: f64) -> Result<(), MeshError> {
    for round in 0..ROUNDS {
        let missed = snap_corners(draft, body, length);
        let crossing = snap_edges(draft, body, round > 0)?;
        draft.smooth(4);
        if missed + crossing == 0 {
            break;
        }
    }
    draft.smooth(12);
    Ok(())
}

/// Gives each corner a point; returns how many still have none.
fn snap_corners(draft: &mut Draft, body: &Body, length: f64) -> usize {
    let mut missed = 0;
    for corner in &body.corners {
        let mut near: Vec<(f64, u32)> = draft
            .points
            .iter()
            .enumerate()
            .filter(|(i, _)| draft.places[*i] != Place::Inside)
            .map(|(i, p)| ((p - corner).norm(), i as u32))
            .filter(|(distance, _)| *distance < REACH * length)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let taken = |&&(_, i): &&(f64, u32)| {
            draft.places[i as usize] == Place::Corner && draft.points[i as usize] == *corner
        };
        if near.iter().find(taken).is_some() {
            continue;
        }
        near.retain(|&(_, i)| draft.places[i as usize] != Place::Corner);
        let mut tries = near.iter().take(TRIES);
        if !tries.any(|&(_, i)| draft.try_move(i, *corner, Place::Corner, FLOOR)) {
            missed += 1;
        }
    }
    missed
}

/// Moves one end of every edge of the skin that joins two patches to the sharp edge between them;
/// where neither end can go and `insert` is true, puts a new point there. Returns how many such
/// edges are left.
fn snap_edges(draft: &mut Draft, body: &Body, insert: bool) -> Result<usize, MeshError> {
    let mut left = 0;
    for edge in edges(&draft.skin()?) {
        let [a, b] = edge.map(|i| draft.places[i as usize]);
        let (Place::Patch(p), Place::Patch(q)) = (a, b) else {
            continue;
        };
        if p == q {
            continue;
        }
        let mut targets: Vec<(f64, u32, u32, Point3)> = edge
            .into_iter()
            .filter_map(|i| {
                let here = draft.points[i as usize];
                let (chain, foot) = body.nearest_sharp(&here)?;
                Some(((foot - here).norm(), i, chain, foot))
            })
            .collect();
        targets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut targets = targets.into_iter();
        if targets.any(|(_, i, chain, foot)| draft.try_move(i, foot, Place::Chain(chain), FLOOR)) {
            continue;
        }
        if insert {
            let ends = edge.map(|i| draft.points[i as usize]);
            let middle = nalgebra::center(&ends[0], &ends[1]);
            if let Some((chain, foot)) = body.nearest_sharp(&middle)
                && draft.try_split(edge, foot, Place::Chain(chain), 0.5 * FLOOR)
            {
                continue;
            }
        }
        left += 1;
    }
    Ok(left)
}
