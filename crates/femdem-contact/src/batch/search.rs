//! Which bodies and walls are near each other.

use super::{ContactBatch, Snapshot};
use crate::body_shape::BodyShape;
use crate::broadphase::Broadphase;
use crate::contact::BodyId;
use crate::error::ContactError;
use crate::motion::Motion;

impl ContactBatch {
    /// Enters bodies that fell asleep before their first update, or before bodies attract over another gap, so that others find
    /// them.
    pub(super) fn find_never_entered(
        &mut self,
        bodies: &[Motion],
        walls: &[Motion],
    ) -> Result<(), ContactError> {
        let mut neighbours = Vec::new();
        for (i, motion) in bodies.iter().enumerate() {
            if self.awake[i] || !self.broadphase.is_out_of_date(i) || !self.is_rigid(i as BodyId) {
                continue;
            }
            if !motion.is_sound() {
                return Err(not_finite(i, motion));
            }
            self.enter(i, motion, walls, &mut neighbours);
        }
        Ok(())
    }

    /// Enters a body and finds its neighbours.
    fn enter(&mut self, i: usize, motion: &Motion, walls: &[Motion], neighbours: &mut Vec<u32>) {
        let shape = &self.shapes[self.body_shapes[i] as usize];
        let space = self.space.as_ref();
        self.broadphase.enter(i, shape, motion, space);
        self.broadphase.neighbours(i, space, neighbours);
        self.pairs.set_neighbours(i as u32, neighbours);
        self.search_walls(i, motion, walls);
    }

    /// Refreshes the neighbours of bodies and walls that have left their skins, or would in another step like
    /// the last. The contacts possible in the next step are then among the candidates
    /// ([`may_touch`](Self::may_touch)).
    pub(super) fn search(&mut self, view: Snapshot) -> Result<(), ContactError> {
        let Snapshot { bodies, walls, dt } = view;
        let mut walls_moved = false;
        for (w, motion) in walls.iter().enumerate() {
            if self.walls[w].is_some() && motion.travelled >= self.wall_expires[w] {
                self.wall_expires[w] = motion.travelled + self.wall_skin();
                walls_moved = true;
            }
        }
        let mut neighbours = Vec::new();
        for k in 0..self.awake_list.len() {
            let i = self.awake_list[k] as usize;
            let motion = &bodies[i];
            if !motion.is_sound() {
                return Err(not_finite(i, motion));
            }
            let radius = self.shapes[self.body_shapes[i] as usize].radius();
            let speed = motion.velocity.norm() + motion.angular_velocity.norm() * radius;
            if self
                .broadphase
                .is_expired(i, motion.travelled + speed * dt, self.space.as_ref())
            {
                self.enter(i, motion, walls, &mut neighbours);
            }
        }
        if walls_moved {
            let ids: Vec<BodyId> = self.rigid_ids().collect();
            for i in ids {
                self.search_walls(i as usize, &bodies[i as usize], walls);
            }
        }
        Ok(())
    }

    /// How far a wall may travel before the bodies near it are looked up again, m.
    fn wall_skin(&self) -> f64 {
        let largest = |m: f64, s: &BodyShape| m.max(Broadphase::half_skin(s));
        self.shapes.iter().fold(0.0, largest)
    }

    fn search_walls(&mut self, body: usize, motion: &Motion, walls: &[Motion]) {
        let shape = &self.shapes[self.body_shapes[body] as usize];
        // The body may travel up to two half skins before the next such search.
        let attracts = 2.0 * self.broadphase.margin(shape);
        let reach =
            shape.radius() + 2.0 * Broadphase::half_skin(shape) + self.wall_skin() + attracts;
        let near: Vec<u32> = self
            .walls()
            .filter(|(w, wall)| {
                let frame = &walls[*w as usize].frame;
                let x = frame
                    .rotation
                    .tr_mul(&(motion.frame.position - frame.position));
                wall.clearance(&x) < reach
            })
            .map(|(w, _)| w)
            .collect();
        self.pairs.set_walls(body as u32, &near);
    }
}

fn not_finite(body: usize, motion: &Motion) -> ContactError {
    ContactError::NotFinite {
        body,
        position: motion.frame.position.into(),
    }
}
