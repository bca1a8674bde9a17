//! Where the bodies are: the highest point, the mean top, and bodies that have left the container.

use super::Packing;
use crate::error::PackError;
use femdem_contact::BodyId;
use femdem_mesh::Vector3;
use femdem_solve::World;
use std::collections::BTreeMap;

/// A body this far (in d) above the highest start was thrown there by an error.
const THROWN: f64 = 5.0;

impl Packing {
    /// Looks for awake bodies that have left the container.
    pub(super) fn guard(&self) -> Result<(), PackError> {
        let diameter = self.job.spec.largest_diameter();
        let ceiling = self.job.highest_start + THROWN * diameter;
        for &body in self.world.awake() {
            let Some(p) = self.world.position(body) else {
                continue;
            };
            if !self.job.spec.container.holds(&p) {
                return Err(self.escaped(body, &p));
            }
            if p.z > ceiling {
                return Err(PackError::Thrown {
                    body,
                    height: p.z,
                    released: self.job.highest_start,
                });
            }
        }
        Ok(())
    }

    /// Updates the highest point of all bodies. This is one comparison for most bodies: only those whose
    /// bounding sphere may reach higher are evaluated in full.
    pub(super) fn update_top(&mut self) {
        let reach = self.job.spec.largest_diameter() / 2.0;
        let mut top = 0.0;
        for (body, p) in positions(&self.world) {
            if p.z + reach > top
                && let Some((_, high)) = self.world.bounds(body)
            {
                top = high.z.max(top);
            }
        }
        self.job.top = top;
    }

    fn escaped(&self, body: BodyId, position: &Vector3) -> PackError {
        let walls = self.world.walls().iter();
        let nearest = walls.min_by(|a, b| a.clearance(position).total_cmp(&b.clearance(position)));
        PackError::Escaped {
            body,
            through: nearest.map_or_else(String::new, |w| w.name().to_owned()),
            position: (*position).into(),
            penalty: self.job.penalty,
        }
    }
}

/// Centroids of all bodies.
pub(super) fn positions(world: &World) -> impl Iterator<Item = (BodyId, Vector3)> {
    (0..).map_while(|body| world.position(body).map(|p| (body, p)))
}

/// Mean top of a pack, m: the floor plan is divided into squares of side d, and the highest points
/// of the bodies whose centroids are over each square are averaged over the squares that have any.
pub(crate) fn mean_top(world: &World, diameter: f64) -> f64 {
    let mut columns: BTreeMap<(i64, i64), f64> = BTreeMap::new();
    for (body, p) in positions(world) {
        if let Some((_, high)) = world.bounds(body) {
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
