//! Contacts that may begin within the next step.

use super::ContactBatch;
use super::pairs::{Cache, Pair};
use crate::body_shape::BodyShape;
use crate::contact::{BodyId, Partner};
use crate::motion::Motion;
use crate::sphere::Meeting;
use crate::walls::WallShape;
use femdem_mesh::Vector3;

/// Within a step the angular speed of a free body varies by its nutation; 1.5 times the present speed bounds
/// it.
const NUTATION: f64 = 1.5;

/// Relative motion of B against A.
struct Approach {
    /// Velocity of B's centroid relative to A, m/s.
    velocity: Vector3,
    /// Bound of the additional speed of any point due to both rotations, m/s.
    turning: f64,
}

impl Approach {
    /// Largest closing speed along a direction from A to B, m/s.
    fn closing(&self, direction: &Vector3) -> f64 {
        self.turning - self.velocity.dot(direction)
    }
}

impl ContactBatch {
    /// Whether a body may begin to touch something within `dt` (s) at the present velocities, judged from its
    /// candidate pairs; what bonds hold to it does not count. `bodies` and `walls` as in the last [`update`](Self::update).
    ///
    /// Use this to keep the step before a first touch no longer than the steps after it; the dashpot's
    /// correction for new contacts assumes equal steps.
    pub fn may_touch(&self, body: BodyId, bodies: &[Motion], walls: &[Motion], dt: f64) -> bool {
        self.pairs.of(body).any(|pair| {
            let a = match pair.a {
                Partner::Body(i) => bodies.get(i as usize),
                Partner::Wall(w) => walls.get(w as usize),
            };
            let motions = a.zip(bodies.get(pair.b as usize));
            let meet = |(a, b): (&Motion, &Motion)| match (pair.a, &self.space) {
                (Partner::Body(_), Some(space)) => self.may_meet(pair, &space.image(a, b).0, b, dt),
                _ => self.may_meet(pair, a, b, dt),
            };
            let bonded = matches!(pair.a, Partner::Body(a) if self.bonds.hold((a, pair.b)));
            !pair.touches() && !bonded && motions.is_some_and(meet)
        })
    }

    fn may_meet(&self, pair: &Pair, a: &Motion, b: &Motion, dt: f64) -> bool {
        // Without its shapes, a batch that was read cannot tell.
        let Some(approach) = self.approach(pair, a, b) else {
            return true;
        };
        let way = (approach.velocity.norm() + approach.turning) * dt;
        if pair.is_clear(a.travelled + b.travelled + way) {
            return false;
        }
        let convex = |body: BodyId| self.shape_of(body)?.convex();
        let frames = [&a.frame, &b.frame];
        // The travel budget of a cache counts all motion; a plane between the two counts only closing motion.
        let close = |gap: f64, direction: &Vector3| gap < approach.closing(direction) * dt;
        match (&pair.cache, pair.a) {
            (Cache::Body(cache), Partner::Body(i)) => {
                let shapes = convex(i).zip(convex(pair.b));
                let gap = shapes.and_then(|(in_a, in_b)| cache.gap(in_a, &a.frame, in_b, &b.frame));
                gap.is_none_or(|(gap, direction)| close(gap, &direction))
            }
            (Cache::Sphere(_), Partner::Body(i)) => {
                let shapes = self.shape_of(i).zip(self.shape_of(pair.b));
                let meeting =
                    shapes.and_then(|(in_a, in_b)| Meeting::of_bodies([in_a, in_b], frames));
                meeting.is_none_or(|meeting| {
                    let (gap, direction) = meeting.gap();
                    close(gap, &direction)
                })
            }
            (Cache::Wall(_) | Cache::Sphere(_), Partner::Wall(w)) => {
                let planes = self.wall(w).and_then(WallShape::planes);
                planes
                    .zip(self.shape_of(pair.b))
                    .is_none_or(|(wall, body)| {
                        let centre = b.frame.position - a.frame.position;
                        wall.planes().iter().any(|plane| {
                            let normal = a.frame.rotation * plane.normal;
                            let reach = body.support(&-b.frame.rotation.tr_mul(&normal));
                            close(normal.dot(&centre) - plane.offset - reach, &normal)
                        })
                    })
            }
            _ => true,
        }
    }

    /// `None` if a shape is not there.
    fn approach(&self, pair: &Pair, a: &Motion, b: &Motion) -> Option<Approach> {
        let turn = |motion: &Motion, radius: f64| motion.angular_velocity.norm() * radius;
        let radius = self.shape_of(pair.b)?.radius();
        let (carried, of_a) = match pair.a {
            Partner::Body(i) => (a.velocity, self.shape_of(i)?.radius()),
            // A wall is unbounded: its velocity is taken at the centre of the body.
            Partner::Wall(_) => {
                let arm = b.frame.position - a.frame.position;
                (a.velocity_at(&arm), radius)
            }
        };
        Some(Approach {
            velocity: b.velocity - carried,
            turning: NUTATION * (turn(a, of_a) + turn(b, radius)),
        })
    }

    fn shape_of(&self, body: BodyId) -> Option<&BodyShape> {
        self.shapes.get(self.shape_index(body)? as usize)
    }
}
