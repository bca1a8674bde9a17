//! Layer 2: contacts of many bodies that the caller moves.

mod build;
mod query;
mod update;

pub use build::*;
pub use query::*;
pub use update::*;

use std::sync::Arc;

use femdem_solve::contact::{
    BodyId, ContactBatch, ContactLaws, Frame, MaterialId, Motion, WallShape,
};
use femdem_solve::mesh::{Matrix3, Pose, Vector3};

use crate::border::Failure;
use crate::form::Form;
use crate::plain::{FemdemMotion, FemdemPose};
use crate::threads::Threads;

/// A batch with what it needs to know of its bodies.
pub(crate) struct Batch {
    batch: ContactBatch,
    threads: Threads,
    /// What was added, by its number.
    shapes: Vec<Arc<Form>>,
    bodies: Vec<Body>,
    /// Of all numbers of bodies and of walls.
    motions: Vec<Motion>,
    walls: Vec<Motion>,
}

/// A body as the caller does not tell it anew in each step.
#[derive(Clone, Copy)]
struct Body {
    /// At the origin: with the mass and the inertia in its own axes.
    own: Motion,
    /// Largest distance of a point from the centroid, m.
    radius: f64,
    /// Where it was in the last update.
    last: Option<FemdemPose>,
    /// Bound of the way that any point has made from update to update, m.
    travelled: f64,
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
            travelled: 0.0,
        })
    }

    /// The body as it moves now. The distance of two places bounds what a point has travelled between them as far as contacts
    /// know, since they see it there only: the shift, and the turn by an angle t, which moves a point by 2 r sin(t/2).
    /// For unit quaternions that is at most 2 r |q - q'|.
    fn motion(&mut self, now: &FemdemMotion) -> Result<Motion, Failure> {
        let frame = now.pose.frame()?;
        if let Some(last) = self.last.replace(now.pose) {
            let shift = frame.position - Vector3::from(last.position);
            self.travelled += shift.norm() + 2.0 * self.radius * turn(&last, &now.pose);
        }
        let [velocity, angular_velocity] = now.velocity.parts();
        let axes = frame.rotation;
        Ok(Motion {
            frame,
            velocity,
            angular_velocity,
            inverse_inertia: axes * self.own.inverse_inertia * axes.transpose(),
            travelled: self.travelled,
            ..self.own
        })
    }
}

/// The distance of two quaternions, of which q and -q are the same rotation.
fn turn(a: &FemdemPose, b: &FemdemPose) -> f64 {
    let distance = |sign: f64| {
        let parts = a.rotation.iter().zip(b.rotation);
        parts.map(|(a, b)| (a - sign * b).powi(2)).sum::<f64>()
    };
    distance(1.0).min(distance(-1.0)).sqrt()
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
            shapes: Vec::new(),
            bodies: Vec::new(),
            motions: Vec::new(),
            walls: Vec::new(),
        }
    }

    fn add_body(
        &mut self,
        form: &Arc<Form>,
        density: f64,
        material: MaterialId,
    ) -> Result<BodyId, Failure> {
        let body = Body::new(form, density)?;
        let known = self.shapes.iter().position(|own| Arc::ptr_eq(own, form));
        let shape = match known {
            Some(shape) => shape as u32,
            None => {
                self.shapes.push(Arc::clone(form));
                self.batch.add_shape(form.contact.clone())
            }
        };
        let id = self.batch.add_body(shape)?;
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
        if let Some(slot) = self.walls.get_mut(id as usize) {
            *slot = still;
        } else {
            self.walls.push(still);
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
        self.motions.clear();
        for (id, (body, now)) in (0..).zip(self.bodies.iter_mut().zip(now)) {
            self.motions.push(if self.batch.contains(id) {
                let motion = body.motion(now);
                motion.map_err(|failure| failure.at("motions", id as usize))?
            } else {
                Motion::fixed(Frame::identity())
            });
        }
        let (batch, motions, walls) = (&mut self.batch, &self.motions, &self.walls);
        Ok(self.threads.run(|| batch.update(motions, walls, dt))?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_solve::mesh::Rotation;
    use femdem_solve::mesh::nalgebra::Translation3;

    /// A turn by an angle t moves a point at the distance 1 by at most 2 sin(t/2): that is bounded, by at most half too much.
    #[test]
    fn the_way_of_a_turn_bounds_that_of_its_points() {
        let place =
            |turn: Rotation| FemdemPose::from(Pose::from_parts(Translation3::identity(), turn));
        for angle in [1e-9, 1e-3, 0.5, 2.0, 3.1, 6.0_f64] {
            for start in [Vector3::zeros(), Vector3::new(1.0, -2.0, 0.3)] {
                let first = Rotation::from_scaled_axis(start);
                let then = Rotation::from_scaled_axis(Vector3::z() * angle);
                let way = 2.0 * (0.5 * angle).sin().abs();
                let bound = 2.0 * turn(&place(first), &place(then * first));
                let most = 1.5 * way + 1e-15;
                assert!(
                    bound >= way * (1.0 - 1e-6) && bound <= most,
                    "{angle}: {way} {bound}"
                );
            }
        }
    }
}
