//! Layer 2: contacts of many bodies that the caller moves.

mod build;
mod query;
mod update;

pub use build::*;
pub use query::*;
pub use update::*;

use std::collections::BTreeMap;
use std::sync::Arc;

use femdem_solve::contact::{
    BodyId, ContactBatch, ContactLaws, Frame, MaterialId, Motion, WallShape,
};
use femdem_solve::mesh::{Matrix3, Pose, Vector3};

use crate::border::Failure;
use crate::form::Form;
use crate::plain::FemdemMotion;
use crate::threads::Threads;

/// A batch with what it needs to know of its bodies.
pub(crate) struct Batch {
    batch: ContactBatch,
    threads: Threads,
    /// What was added with its number, by its address, which stays its own as long as it is kept here.
    shapes: BTreeMap<usize, (Arc<Form>, u32)>,
    bodies: Vec<Body>,
    /// Of all numbers of bodies in the last update, and of walls.
    motions: Vec<Motion>,
    walls: Vec<Motion>,
    /// Where the walls will be in the next; the travel of these means nothing.
    next_walls: Vec<Motion>,
}

/// A body as the caller does not tell it anew in each step.
#[derive(Clone, Copy)]
struct Body {
    /// At the origin: with the mass and the inertia in its own axes.
    own: Motion,
    /// Largest distance of a point from the centroid, m.
    radius: f64,
    /// As it moved in the last update.
    last: Option<Motion>,
}

impl Body {
    fn new(form: &Form, density: f64) -> Result<Self, Failure> {
        let mass = form.mass();
        let own = match density {
            0.0 => Motion::fixed(Frame::identity()),
            _ if density > 0.0 && density.is_finite() => {
                heavy(density * mass.volume, &(mass.inertia * density))?
            }
            _ => {
                let allowed =
                    "positive and finite, in kg/m^3, or 0 for a body that contacts do not move";
                return Err(Failure::refused("density", density, allowed));
            }
        };
        Ok(Self {
            own,
            radius: form.contact.radius(),
            last: None,
        })
    }

    /// The body as it moves now. Contacts see it in updates only, so that its way is from place to place.
    fn motion(&self, now: &FemdemMotion) -> Result<Motion, Failure> {
        let (frame, [velocity, angular_velocity]) = now.checked()?;
        let axes = frame.rotation;
        let mut motion = Motion {
            frame,
            velocity,
            angular_velocity,
            inverse_inertia: axes * self.own.inverse_inertia * axes.transpose(),
            ..self.own
        };
        if let Some(last) = &self.last {
            motion.travelled = last.travelled + motion.way_from(last, self.radius);
        }
        reached(motion)
    }
}

/// Refuses a place without a finite way to it.
fn reached(motion: Motion) -> Result<Motion, Failure> {
    if motion.travelled.is_finite() {
        return Ok(motion);
    }
    let allowed = "finite, in m, from update to update";
    Err(Failure::refused("way", motion.travelled, allowed))
}

/// A body of a mass in kg and an inertia about its centroid in kg m^2, at the origin.
fn heavy(mass: f64, inertia: &Matrix3) -> Result<Motion, Failure> {
    let zero = Vector3::zeros();
    Ok(Motion::rigid(&Pose::identity(), zero, zero, mass, inertia)?)
}

impl Batch {
    fn new(laws: impl Into<ContactLaws>) -> Self {
        Self {
            batch: ContactBatch::new(laws),
            threads: Threads::default(),
            shapes: BTreeMap::new(),
            bodies: Vec::new(),
            motions: Vec::new(),
            walls: Vec::new(),
            next_walls: Vec::new(),
        }
    }

    fn add_body(
        &mut self,
        form: &Arc<Form>,
        density: f64,
        material: MaterialId,
    ) -> Result<BodyId, Failure> {
        let body = Body::new(form, density)?;
        let (_, shape) = self
            .shapes
            .entry(Arc::as_ptr(form).addr())
            .or_insert_with(|| {
                let shape = self.batch.add_shape(form.contact.clone());
                (Arc::clone(form), shape)
            });
        let id = self.batch.add_body(*shape)?;
        self.batch.set_material(id, material)?;
        if let Some(slot) = self.bodies.get_mut(id as usize) {
            *slot = body;
        } else {
            self.bodies.push(body);
        }
        Ok(id)
    }

    fn add_wall(
        &mut self,
        wall: impl Into<WallShape>,
        material: MaterialId,
    ) -> Result<u32, Failure> {
        let id = self.batch.add_wall(wall);
        self.batch.set_wall_material(id, material)?;
        let still = Motion::fixed(Frame::identity());
        for walls in [&mut self.walls, &mut self.next_walls] {
            match walls.get_mut(id as usize) {
                Some(slot) => *slot = still,
                None => walls.push(still),
            }
        }
        Ok(id)
    }

    /// Contacts where the bodies are now; what is given for numbers not in use is not read.
    fn update(&mut self, now: &[FemdemMotion], dt: f64) -> Result<(), Failure> {
        let [slots, _] = self.batch.slots();
        if now.len() != slots {
            let what = "one for each number of a body in use so far, as femdem_batch_slots tells";
            return Err(Failure::size("motions", now.len(), slots, what));
        }
        let bodies = (0..).zip(self.bodies.iter().zip(now));
        let motions = bodies.map(|(id, (body, now))| {
            if self.batch.contains(id) {
                let motion = body.motion(now);
                motion.map_err(|failure| failure.at("motions", id as usize))
            } else {
                Ok(Motion::fixed(Frame::identity()))
            }
        });
        let motions = motions.collect::<Result<Vec<_>, _>>()?;
        let walls = self.moved_walls(&motions)?;
        let batch = &mut self.batch;
        self.threads.run(|| batch.update(&motions, &walls, dt))?;
        for (body, motion) in self.bodies.iter_mut().zip(&motions) {
            body.last = Some(*motion);
        }
        (self.motions, self.walls) = (motions, walls);
        Ok(())
    }

    /// Where the walls are now, while bodies have these motions.
    fn moved_walls(&self, bodies: &[Motion]) -> Result<Vec<Motion>, Failure> {
        let moved = |(id, (last, next)): (u32, (&Motion, &Motion))| {
            if self.batch.wall(id).is_none() {
                return Ok(*last);
            }
            let travelled = last.travelled + self.batch.wall_way(last, next, bodies);
            let moved = reached(Motion { travelled, ..*next });
            moved.map_err(|failure| failure.at("walls", id as usize))
        };
        let walls = self.walls.iter().zip(&self.next_walls);
        (0..).zip(walls).map(moved).collect()
    }
}
