//! What a body may touch within the step to come.

use super::ContactBatch;
use super::pairs::{Cache, Pair};
use crate::contact::{BodyId, Partner};
use crate::motion::Motion;
use crate::shape::BodyShape;
use crate::walls::WallShape;
use femdem_mesh::Vector3;

/// The rate of a free body varies within a step by its nutation; half as much again bounds it.
const NUTATION: f64 = 1.5;

/// How B moves against A.
struct Approach {
    /// Velocity of B's centroid, as seen from A, m/s.
    velocity: Vector3,
    /// Speed at which any point of either may turn beside that, m/s.
    turning: f64,
}

impl Approach {
    /// Largest speed along a direction from A to B at which they may close, m/s.
    fn closing(&self, direction: &Vector3) -> f64 {
        self.turning - self.velocity.dot(direction)
    }
}

impl ContactBatch {
    /// Whether a body may touch something that it does not touch, within `dt` (s) at the present velocities, as far as
    /// is known of its pairs. `bodies` and `walls` as in the last [`update`](Self::update).
    ///
    /// Whoever chooses steps may want one before a touch that is no longer than one after it: then the dashpots know
    /// how long a new contact has lasted.
    pub fn may_touch(&self, body: BodyId, bodies: &[Motion], walls: &[Motion], dt: f64) -> bool {
        self.pairs.of(body).any(|pair| {
            let a = match pair.a {
                Partner::Body(i) => bodies.get(i as usize),
                Partner::Wall(w) => walls.get(w as usize),
            };
            let motions = a.zip(bodies.get(pair.b as usize));
            !pair.touches() && motions.is_some_and(|(a, b)| self.may_meet(pair, a, b, dt))
        })
    }

    fn may_meet(&self, pair: &Pair, a: &Motion, b: &Motion, dt: f64) -> bool {
        let approach = self.approach(pair, a, b);
        let way = (approach.velocity.norm() + approach.turning) * dt;
        if pair.is_clear(a.travelled + b.travelled + way) {
            return false;
        }
        let convex = |body: BodyId| self.shape_of(body)?.convex();
        // The budget of a cache counts all motion. A plane between the two tells what brings them together.
        let close = |gap: f64, direction: &Vector3| gap < approach.closing(direction) * dt;
        match (&pair.cache, pair.a) {
            (Cache::Body(cache), Partner::Body(i)) => {
                let shapes = convex(i).zip(convex(pair.b));
                let gap = shapes.and_then(|(in_a, in_b)| cache.gap(in_a, &a.frame, in_b, &b.frame));
                gap.is_none_or(|(gap, direction)| close(gap, &direction))
            }
            (Cache::Wall(_), Partner::Wall(w)) => {
                let planes = self.walls.get(w as usize).and_then(WallShape::planes);
                planes.zip(convex(pair.b)).is_none_or(|(wall, body)| {
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

    fn approach(&self, pair: &Pair, a: &Motion, b: &Motion) -> Approach {
        let turn = |motion: &Motion, radius: f64| motion.angular_velocity.norm() * radius;
        let radius = self.shape_of(pair.b).map_or(0.0, BodyShape::radius);
        let (carried, of_a) = match pair.a {
            Partner::Body(i) => (a.velocity, self.shape_of(i).map_or(0.0, BodyShape::radius)),
            // A wall has no end: it is seen from where the body is.
            Partner::Wall(_) => {
                let arm = b.frame.position - a.frame.position;
                (a.velocity_at(&arm), radius)
            }
        };
        Approach {
            velocity: b.velocity - carried,
            turning: NUTATION * (turn(a, of_a) + turn(b, radius)),
        }
    }

    fn shape_of(&self, body: BodyId) -> Option<&BodyShape> {
        let shape = self.body_shapes.get(body as usize)?;
        self.shapes.get(*shape as usize)
    }
}
