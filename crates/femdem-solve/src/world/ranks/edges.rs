//! How far the edges of a periodic cell carry bodies against each other, since they were dealt.

use super::ranks;
use crate::error::SolveError;
use crate::halo::Halo;
use crate::world::World;
use crate::world::time_step::LARGEST_MOVE;
use femdem_contact::PeriodicCell;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// What all ranks know of the edges. An image of A that B meets is carried by as many edges as A and B are away from the middle,
/// and by those between the images beside each other.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Edges {
    /// Their paths when the bodies were dealt, m.
    paths: [f64; 3],
    /// Number of edges to a place amid the bodies, and from there to the farthest of them.
    middle: [f64; 3],
    far: [f64; 3],
    /// Most edges between images that may meet.
    beside: [f64; 3],
}

impl Edges {
    /// Number of edges from the middle to a place.
    pub fn away(&self, cell: Option<&PeriodicCell>, x: &Vector3) -> [f64; 3] {
        let image = cell.map_or([0; 3], |cell| cell.split(x).0);
        [0, 1, 2].map(|k| f64::from(image[k]) - self.middle[k])
    }

    /// A body has come so far away.
    pub fn reach(&mut self, away: [f64; 3]) {
        for (far, own) in self.far.iter_mut().zip(away) {
            *far = far.max(own.abs());
        }
    }

    /// What is left of the way (m) that images may be carried against those beside them, at these paths of the edges.
    pub fn slack(&self, way: f64, paths: [f64; 3]) -> f64 {
        way - carried(self.beside, paths)
    }

    /// How far the edges have gone since the bodies were dealt, m.
    pub fn since(&self, now: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| now[k] - self.paths[k])
    }

    /// Whether what was read can be.
    pub fn is_sound(&self) -> bool {
        let lengths = [self.paths, self.far, self.beside].concat();
        lengths.iter().all(|x| x.is_finite() && *x >= 0.0)
            && self.middle.iter().all(|x| x.is_finite())
    }
}

/// How far edges carry a body that is so many of them away, m.
pub(super) fn carried(away: [f64; 3], paths: [f64; 3]) -> f64 {
    let each = away.iter().zip(paths);
    each.map(|(n, path)| n.abs() * path).sum()
}

/// Most edges between images of bodies that may meet, until an edge has gone `way` (m): of upright cells one of each, and of
/// leaning ones as many as lead back over the lean.
fn beside(cell: &PeriodicCell, way: f64) -> [f64; 3] {
    let edges = cell.edges();
    let over = |lean: f64, side: f64| 1.0 + ((lean + way) / side).ceil();
    let along_y = match cell.repeats(1) {
        true => over(edges.m23.abs(), edges.m22),
        false => 0.0,
    };
    let lean = edges.m13.abs() + along_y * edges.m12.abs();
    let along_x = match cell.repeats(0) {
        true => over(lean, edges.m11),
        false => 0.0,
    };
    [along_x, along_y, 1.0]
}

impl World {
    /// The edges for bodies that are dealt now and may go so far, m: the same on all ranks.
    pub(super) fn edges(&self, way: f64, halo: &mut dyn Halo) -> Result<Edges, SolveError> {
        let Some(cell) = self.cell() else {
            return Ok(Edges::default());
        };
        let rigid = self.live_bodies().map(|(_, body)| body.position);
        let soft = self.own_nodes().map(|(_, nodes, _)| nodes.middle());
        // The least of the numbers and of their negatives.
        let mut least = [f64::MAX; 6];
        for x in rigid.chain(soft) {
            let (image, _) = cell.split(&x);
            for k in 0..3 {
                let number = f64::from(image[k]);
                least[k] = least[k].min(number);
                least[3 + k] = least[3 + k].min(-number);
            }
        }
        halo.least(&mut least)?;
        if least[0] > -least[3] {
            // No bodies at all.
            least = [0.0; 6];
        }
        let ends = [0, 1, 2].map(|k| [least[k], -least[3 + k]]);
        let middle = ends.map(|[low, high]| (0.5 * (low + high)).round());
        let far = [0, 1, 2].map(|k| (ends[k][1] - middle[k]).max(middle[k] - ends[k][0]));
        Ok(Edges {
            paths: self.batch.edge_paths(),
            middle,
            far,
            beside: beside(cell, way),
        })
    }

    /// Refuses edges of a periodic cell that go so far in a step, m, that bodies may meet others that their rank does not know.
    pub(in crate::world) fn check_edges(&self, ways: [f64; 3]) -> Result<(), SolveError> {
        let share = self.share.as_deref().filter(|share| share.is_of_many());
        let Some(whole) = share.map(|share| &share.whole) else {
            return Ok(());
        };
        let Edges { far, beside, .. } = whole.edges;
        let most = carried(far, ways).max(carried(beside, ways));
        if most <= LARGEST_MOVE * whole.largest {
            return Ok(());
        }
        Err(ranks(&format!(
            "the edges of the periodic cell carry a body by {most:.3e} m in a step, more than {LARGEST_MOVE} of the largest radius of all bodies: lower time_step.largest, or run it on one rank"
        )))
    }
}
