//! What deformable bodies may meet, found by the search of the batch.

use super::DeformablePart;
use super::body::SoftBody;
use super::pairs::Key;
use crate::broadphase::{Broadphase, Extent};
use crate::contact::BodyId;
use crate::deform::side::Side;
use crate::error::ContactError;
use crate::periodic::Space;
use femdem_mesh::Vector3;

impl DeformablePart {
    /// A rigid body was entered anew: those of its `neighbours` that are deformable are taken out of them.
    pub fn take_neighbours(&mut self, body: BodyId, neighbours: &mut Vec<BodyId>) {
        let own = neighbours
            .extract_if(.., |other| self.contains(*other))
            .collect();
        self.entered.insert(body, own);
    }

    /// A wall has left its skin, or is new.
    pub fn note_walls(&mut self) {
        self.walls_moved = true;
    }

    /// Enters the deformable bodies that have left their skins.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] for a periodic cell that is too small for a body.
    pub fn enter(
        &mut self,
        search: &mut Broadphase,
        space: Option<&Space>,
    ) -> Result<(), ContactError> {
        let bodies = self.bodies.iter_mut().enumerate();
        for (i, body) in bodies.filter(|(_, body)| body.is_there) {
            if !search.is_expired(i, body.travelled, space) {
                continue;
            }
            let (bounds, radius) = body.extent();
            let half_skin = Broadphase::half_skin(radius);
            if let Some(space) = space {
                space.check_fits(
                    "side of a periodic cell over the diameter of the largest deformable body, with a margin for its motion",
                    2.0 * (radius + half_skin),
                )?;
            }
            // A node may move one way as far as the mean moves the other way.
            body.stretch_to(radius, 2.0 * half_skin);
            let extent = Extent {
                low: bounds.low.coords,
                high: bounds.high.coords,
                centre: body.centre,
                radius,
                margin: 0.0,
                travelled: body.travelled,
            };
            search.enter(i, &extent, space);
            self.entered.insert(i as BodyId, Vec::new());
        }
        Ok(())
    }

    /// Lists the pairs of the bodies that were entered anew, and those with walls that have moved: those with a body that is no
    /// guest. `near_walls` gives the walls near a body from its centre and radius, m. Returns whether any pair is another.
    pub fn list_pairs(
        &mut self,
        search: &Broadphase,
        space: Option<&Space>,
        near_walls: impl Fn(&Vector3, f64) -> Vec<u32>,
        is_guest: impl Fn(BodyId) -> bool,
    ) -> bool {
        let entered = std::mem::take(&mut self.entered);
        let walls_moved = std::mem::take(&mut self.walls_moved);
        if entered.is_empty() && !walls_moved {
            return false;
        }
        let mut found: Vec<Key> = Vec::new();
        let mut neighbours = Vec::new();
        for (&body, deformables) in &entered {
            if !self.contains(body) {
                let present = deformables.iter().filter(|b| self.contains(**b));
                found.extend(present.map(|&b| (Side::Rigid(body), b)));
                continue;
            }
            search.neighbours(body as usize, space, &mut neighbours);
            found.extend(neighbours.iter().map(|&other| self.key(body, other)));
            if self.self_contact(body) {
                found.push((Side::Deformable(body), body));
            }
        }
        found.retain(|&(a, b)| match a {
            Side::Deformable(a) | Side::Rigid(a) => !(is_guest(a) && is_guest(b)),
            Side::Wall(_) => true,
        });
        let meets_walls = |body: BodyId| walls_moved || entered.contains_key(&body);
        let own = |(_, body): &(BodyId, &SoftBody)| body.is_there && !body.is_guest;
        for (b, body) in (0..).zip(&self.bodies).filter(own) {
            if meets_walls(b) {
                let near = near_walls(&body.centre, body.extent().1);
                found.extend(near.into_iter().map(|wall| (Side::Wall(wall), b)));
            }
        }
        found.sort_unstable();
        found.dedup();
        let is_due = |&(a, b): &Key| match a {
            Side::Deformable(a) | Side::Rigid(a) => {
                entered.contains_key(&a) || entered.contains_key(&b)
            }
            Side::Wall(_) => meets_walls(b),
        };
        let (shapes, bodies) = (&self.shapes, &self.bodies);
        let edge = |i: BodyId| shapes[bodies[i as usize].shape as usize].edge();
        let swaps = |(a, b): Key| matches!(a, Side::Deformable(i) if edge(i) < edge(b));
        self.pairs.renew(found, is_due, swaps)
    }

    /// The pair of a deformable body with another body.
    fn key(&self, body: BodyId, other: BodyId) -> Key {
        if self.contains(other) {
            (Side::Deformable(body.min(other)), body.max(other))
        } else {
            (Side::Rigid(other), body)
        }
    }
}
