//! Supports and loads on parts of the skin.

use femdem_mesh::{Point3, Vector3};
use femdem_solve::deformable::DeformableModel;
use femdem_solve::statics::Loading;
use std::collections::BTreeMap;

/// Holds, along an axis, the nodes that `select` picks.
pub fn hold(
    loading: &mut Loading,
    model: &DeformableModel,
    axis: usize,
    select: impl Fn(&Vector3) -> bool,
) {
    for (held, x) in loading.held.iter_mut().zip(model.nodes()) {
        held[axis] |= select(x);
    }
}

/// Adds a traction, N/m^2, given the outward unit normal, on the faces whose corners `select` picks.
/// Nodal forces are those of the elements' own functions: a third of the force of a face for each
/// corner of a linear one, and for each middle of an edge of a quadratic one.
pub fn traction(
    loading: &mut Loading,
    model: &DeformableModel,
    select: impl Fn(&Point3) -> bool,
    traction: impl Fn(&Vector3) -> Vector3,
) {
    let mesh = model.mesh();
    let points = mesh.points();
    let first = points.len() as u32;
    let middles: BTreeMap<[u32; 2], u32> = model.mid_edges().iter().copied().zip(first..).collect();
    let chosen = |face: &&[u32; 3]| face.iter().all(|&i| select(&points[i as usize]));
    for &[a, b, c] in mesh.skin().iter().filter(chosen) {
        let [p, q, r] = [a, b, c].map(|i| points[i as usize]);
        let area = 0.5 * (q - p).cross(&(r - p));
        let force = traction(&area.normalize()) * area.norm() / 3.0;
        let carriers = [[a, b], [b, c], [c, a]].map(|[i, j]| {
            let middle = middles.get(&[i.min(j), i.max(j)]);
            middle.copied().unwrap_or(i)
        });
        for node in carriers {
            loading.forces[node as usize] += force;
        }
    }
}
