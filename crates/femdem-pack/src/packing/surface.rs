//! Where the bodies are: the highest point, and bodies that have left the container.

use super::Packing;
use super::ranks::largest;
use crate::error::PackError;
use femdem_contact::BodyId;
use femdem_mesh::Vector3;
use femdem_solve::Halo;

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
                    body: self.number(body),
                    height: p.z,
                    released: self.job.highest_start,
                });
            }
        }
        Ok(())
    }

    /// Updates the highest point of all bodies.
    pub(super) fn update_top(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        let own = self.world.own_bodies(0);
        let tops = own.filter_map(|body| Some(self.world.bounds(body)?.1.z));
        [self.job.top] = largest([tops.fold(0.0, f64::max)], halo)?;
        Ok(())
    }

    fn number(&self, body: BodyId) -> BodyId {
        self.world.number_in_whole(body).unwrap_or(body)
    }

    fn escaped(&self, body: BodyId, position: &Vector3) -> PackError {
        let walls = self.world.walls().map(|(_, wall)| wall);
        let nearest = walls.min_by(|a, b| a.clearance(position).total_cmp(&b.clearance(position)));
        PackError::Escaped {
            body: self.number(body),
            through: nearest.map_or_else(String::new, |w| w.name().to_owned()),
            position: (*position).into(),
            penalty: self.job.penalty,
        }
    }
}
