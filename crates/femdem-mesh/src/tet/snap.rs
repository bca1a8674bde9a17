//! Recovering the corners and sharp edges of a surface.

use super::draft::{Draft, edges};
use super::features::{Features, Place};
use crate::{MeshError, Point3};

/// Radius ratios that moving or inserting a point must leave; smoothing improves them.
const FLOOR: f64 = 0.1;
/// Corners take a point of the skin from as far as this part of the lattice's length.
const REACH: f64 = 3.0;
/// Points of the skin tried for one corner.
const TRIES: usize = 8;
/// Edges whose middles are farther from the surface than this part of the lattice's length cut
/// under it.
const UNDERCUT: f64 = 0.05;
/// Rounds of moving points to sharp edges and smoothing.
const ROUNDS: usize = 6;

/// Moves points of the skin to corners and sharp edges, and inserts points where none can be moved.
pub(super) fn snap(draft: &mut Draft, features: &Features, length: f64) -> Result<(), MeshError> {
    for round in 0..ROUNDS {
        let missed = snap_corners(draft, features, length);
        let crossing = snap_edges(draft, features, length, round > 0)?;
        draft.smooth(4);
        if missed + crossing == 0 {
            break;
        }
    }
    draft.smooth(12);
    Ok(())
}

/// Gives each corner a point; returns how many had none.
fn snap_corners(draft: &mut Draft, features: &Features, length: f64) -> usize {
    let mut missed = 0;
    for (index, corner) in features.corners.iter().enumerate() {
        let place = Place::Corner(index as u32);
        if draft.places.contains(&place) {
            continue;
        }
        let is_free = |i: usize| matches!(draft.places[i], Place::Patch(_) | Place::Chain(_));
        let mut near: Vec<(f64, u32)> = draft
            .points
            .iter()
            .enumerate()
            .filter(|(i, _)| is_free(*i))
            .map(|(i, p)| ((p - corner).norm(), i as u32))
            .filter(|(distance, _)| *distance < REACH * length)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        missed += 1;
        for &(_, i) in near.iter().take(TRIES) {
            if draft.try_move(i, *corner, place, FLOOR) {
                break;
            }
        }
    }
    missed
}

/// Moves one end of every edge of the skin that joins different patches to the sharp edge between them;
/// where neither end can go and `insert` is true, puts a new point there. Returns how many such
/// edges there were: moves can make others.
fn snap_edges(
    draft: &mut Draft,
    features: &Features,
    length: f64,
    insert: bool,
) -> Result<usize, MeshError> {
    let mut found = 0;
    for edge in edges(&draft.skin()?) {
        if !crosses_sharp_edge(draft, features, edge, length) {
            continue;
        }
        found += 1;
        let mut targets: Vec<(f64, u32, u32, Point3)> = edge
            .into_iter()
            .filter(|&i| matches!(draft.places[i as usize], Place::Patch(_)))
            .filter_map(|i| {
                let here = draft.points[i as usize];
                let (chain, foot) = features.nearest_sharp(&here)?;
                Some(((foot - here).norm(), i, chain, foot))
            })
            .collect();
        targets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut targets = targets.into_iter();
        let moved =
            targets.any(|(_, i, chain, foot)| draft.try_move(i, foot, Place::Chain(chain), FLOOR));
        let ends = edge.map(|i| draft.points[i as usize]);
        let middle = nalgebra::center(&ends[0], &ends[1]);
        if let Some((chain, foot)) = features.nearest_sharp(&middle)
            && insert
            && !moved
        {
            draft.try_split(edge, foot, Place::Chain(chain), 0.5 * FLOOR);
        }
    }
    Ok(found)
}

/// Whether an edge of the skin joins different patches, or cuts under a sharp edge within one
/// (patches can go around the end of a sharp edge).
fn crosses_sharp_edge(draft: &Draft, features: &Features, edge: [u32; 2], length: f64) -> bool {
    let [a, b] = edge.map(|i| draft.places[i as usize]);
    if !features.share_patch(&a, &b) {
        return true;
    }
    if !matches!((a, b), (Place::Patch(_), Place::Patch(_))) {
        return false;
    }
    let [p, q] = edge.map(|i| draft.points[i as usize]);
    let middle = nalgebra::center(&p, &q);
    let near = |foot: Point3, reach: f64| (foot - middle).norm() < reach;
    features
        .nearest_sharp(&middle)
        .is_some_and(|(_, foot)| near(foot, 0.5 * (q - p).norm()))
        && !near(features.nearest(&middle).1, UNDERCUT * length)
}
