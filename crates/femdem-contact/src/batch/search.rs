//! Which bodies and walls are near each other: one search for rigid and deformable bodies.

use super::{ContactBatch, Snapshot};
use crate::broadphase::{Broadphase, Extent};
use crate::contact::BodyId;
use crate::error::ContactError;
use crate::motion::Motion;
use crate::walls::WallShape;
use femdem_mesh::Vector3;

impl ContactBatch {
    /// Refreshes the neighbours of rigid bodies and walls that have left their skins, or would in another step like
    /// the last. The contacts possible in the next step are then among the candidates
    /// ([`may_touch`](Self::may_touch)).
    pub(super) fn search(&mut self, view: Snapshot) -> Result<(), ContactError> {
        let Snapshot { bodies, walls, dt } = view;
        self.check_sound(bodies)?;
        if std::mem::take(&mut self.awake_changed) {
            let awake = self.awake.iter().enumerate().filter(|x| *x.1);
            self.awake_list = awake.map(|(i, _)| i as BodyId).collect();
            self.find_never_entered(bodies, walls);
        }
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
            let radius = self.shapes[self.body_shapes[i] as usize].radius();
            let speed = motion.velocity.norm() + motion.angular_velocity.norm() * radius;
            if self
                .broadphase
                .is_expired(i, motion.travelled + speed * dt, self.space.as_ref())
            {
                self.enter(i, motion, walls, &mut neighbours);
            }
        }
        if self.space.is_some() {
            self.find_carried(bodies, walls);
        }
        if walls_moved {
            let skin = self.wall_skin();
            let ids: Vec<BodyId> = self.rigid_ids().collect();
            for i in ids {
                self.search_walls(i as usize, &bodies[i as usize], walls, skin);
            }
            if let Some(part) = &mut self.deformable {
                part.note_walls();
            }
        }
        Ok(())
    }

    /// The same for deformable bodies, after that of rigid ones. Returns whether any of their pairs is another.
    pub(super) fn search_deformables(&mut self, walls: &[Motion]) -> Result<bool, ContactError> {
        let skin = self.wall_skin();
        let Some(part) = self.deformable.as_deref_mut() else {
            return Ok(false);
        };
        let space = self.space.as_ref();
        part.enter(&mut self.broadphase, space)?;
        let shapes = &self.walls;
        let near = |centre: &Vector3, radius: f64| {
            near_walls(shapes, walls, centre, wall_reach(radius, skin))
        };
        let is_guest = |body| self.pairs.is_guest(body);
        Ok(part.list_pairs(&self.broadphase, space, near, is_guest))
    }

    /// Refuses motions of awake bodies, and of those that were never entered, before anything is changed by them.
    fn check_sound(&self, bodies: &[Motion]) -> Result<(), ContactError> {
        let lost = |i: &usize| !bodies[*i].is_sound();
        let found = if self.awake_changed {
            let due = |i: &usize| self.awake[*i] || self.was_never_entered(*i);
            (0..bodies.len()).filter(due).find(lost)
        } else {
            let mut awake = self.awake_list.iter().map(|&i| i as usize);
            awake.find(lost)
        };
        found.map_or(Ok(()), |body| {
            Err(ContactError::NotFinite {
                body,
                position: bodies[body].frame.position.into(),
            })
        })
    }

    fn was_never_entered(&self, i: usize) -> bool {
        self.broadphase.is_out_of_date(i) && self.is_rigid(i as BodyId)
    }

    /// Enters rigid bodies that fell asleep before their first update, or before bodies attract over another gap, so that others
    /// find them.
    fn find_never_entered(&mut self, bodies: &[Motion], walls: &[Motion]) {
        let mut neighbours = Vec::new();
        for (i, motion) in bodies.iter().enumerate() {
            if !self.awake[i] && self.was_never_entered(i) {
                self.enter(i, motion, walls, &mut neighbours);
            }
        }
    }

    /// Enters sleeping bodies whose images the edges of the periodic cell have carried too far.
    fn find_carried(&mut self, bodies: &[Motion], walls: &[Motion]) {
        let mut neighbours = Vec::new();
        for (i, motion) in bodies.iter().enumerate() {
            let space = self.space.as_ref();
            if !self.awake[i]
                && self.is_rigid(i as BodyId)
                && self.broadphase.is_expired(i, motion.travelled, space)
            {
                self.enter(i, motion, walls, &mut neighbours);
            }
        }
    }

    /// Enters a rigid body and finds its neighbours.
    fn enter(&mut self, i: usize, motion: &Motion, walls: &[Motion], neighbours: &mut Vec<u32>) {
        let shape = &self.shapes[self.body_shapes[i] as usize];
        let (low, high) = shape.bounds(&motion.frame.rotation);
        let centre = motion.frame.position;
        let extent = Extent {
            low: low + centre,
            high: high + centre,
            centre,
            radius: shape.radius(),
            margin: self.broadphase.margin(shape),
            travelled: motion.travelled,
        };
        let space = self.space.as_ref();
        self.broadphase.enter(i, &extent, space);
        self.broadphase.neighbours(i, space, neighbours);
        if let Some(part) = &mut self.deformable {
            part.take_neighbours(i as BodyId, neighbours);
        }
        self.pairs.set_neighbours(i as u32, neighbours);
        let skin = self.wall_skin();
        self.search_walls(i, motion, walls, skin);
    }

    /// How far a wall may travel before the bodies near it are looked up again, m: a function of the shapes that all batches of a
    /// whole have.
    fn wall_skin(&self) -> f64 {
        let rigid = self.shapes.iter().map(|shape| shape.radius());
        let whole = self.deformable_shapes().iter();
        let whole = whole.filter(|shape| !shape.is_cracked());
        let deformable = whole.map(|shape| shape.radius());
        let largest = rigid.chain(deformable).fold(0.0, f64::max);
        Broadphase::half_skin(largest)
    }

    fn search_walls(&mut self, body: usize, motion: &Motion, walls: &[Motion], skin: f64) {
        let shape = &self.shapes[self.body_shapes[body] as usize];
        let attracts = 2.0 * self.broadphase.margin(shape);
        let reach = wall_reach(shape.radius(), skin) + attracts;
        let near = near_walls(&self.walls, walls, &motion.frame.position, reach);
        self.pairs.set_walls(body as u32, &near);
    }
}

/// How near a wall of the skin `skin` (m) a body of `radius` (m) may meet: it may travel by up to two of its own half skins
/// before the next look, m.
fn wall_reach(radius: f64, skin: f64) -> f64 {
    radius + 2.0 * Broadphase::half_skin(radius) + skin
}

/// The walls within `reach` (m) of a point, ascending.
fn near_walls(
    shapes: &[Option<WallShape>],
    walls: &[Motion],
    point: &Vector3,
    reach: f64,
) -> Vec<u32> {
    let all = (0..).zip(shapes.iter().zip(walls));
    let near = all.filter(|(_, (wall, motion))| {
        let from = motion
            .frame
            .rotation
            .tr_mul(&(point - motion.frame.position));
        let clearance = wall.as_ref().map(|wall| wall.clearance(&from));
        clearance.is_some_and(|clearance| clearance < reach)
    });
    near.map(|(w, _)| w).collect()
}
