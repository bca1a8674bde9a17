//! Where the bodies are: the highest point, and bodies that have left the container.

use super::Packing;
use super::top::positions;
use crate::error::PackError;
use femdem_contact::BodyId;
use femdem_mesh::Vector3;

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
        let walls = self.world.walls().map(|(_, wall)| wall);
        let nearest = walls.min_by(|a, b| a.clearance(position).total_cmp(&b.clearance(position)));
        PackError::Escaped {
            body,
            through: nearest.map_or_else(String::new, |w| w.name().to_owned()),
            position: (*position).into(),
            penalty: self.job.penalty,
        }
    }
}
