//! Whether a world that was read hangs together.
//!
//! Lengths, indices and drives are checked, not every number: the checksum of a file tells those that were damaged.

use super::World;
use crate::body::Body;
use crate::error::SolveError;

impl World {
    /// Refuses a world whose parts do not fit together. The batch checks itself as it gets its shapes back.
    pub(super) fn check_stored(&self) -> Result<(), SolveError> {
        let [bodies, walls] = self.batch.slots();
        for (what, found, expected) in [
            ("bodies", self.bodies.len(), bodies),
            ("motions of bodies", self.motions.len(), bodies),
            ("drives of walls", self.wall_drives.len(), walls),
            ("motions of walls", self.wall_motions.len(), walls),
        ] {
            if found != expected {
                return Err(inconsistent(format!(
                    "it has {found} {what} where {expected} are right"
                )));
            }
        }
        let shapes = self.shapes.len();
        let lost =
            |(i, body): (u32, &Body)| self.batch.is_rigid(i) && body.shape as usize >= shapes;
        if let Some(body) = (0..).zip(&self.bodies).position(lost) {
            return Err(inconsistent(format!(
                "body {body} has shape {}, but there are {shapes}",
                self.bodies[body].shape
            )));
        }
        let ascending = self.awake.windows(2).all(|pair| pair[0] < pair[1]);
        if !ascending || !self.awake.iter().all(|&i| self.batch.is_awake(i)) {
            return Err(inconsistent(
                "its list of awake bodies is out of order".to_owned(),
            ));
        }
        let share = self.share.as_deref();
        let counts = [self.bodies.len(), self.batch.len()];
        if share.is_some_and(|share| !share.is_sound(counts)) {
            return Err(inconsistent("its share of a whole does not fit".to_owned()));
        }
        let of_bodies = self.bodies.iter().filter_map(|b| b.driven.as_deref());
        for (guide, _) in of_bodies.chain(&self.wall_drives) {
            guide.validate()?;
        }
        self.deformables
            .as_ref()
            .map_or(Ok(()), |d| d.check_stored(&self.batch))
    }
}

pub(in crate::world) fn inconsistent(why: String) -> SolveError {
    SolveError::Encoding {
        action: "decoded",
        why,
    }
}
