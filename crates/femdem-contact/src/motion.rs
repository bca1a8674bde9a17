//! The state of a body as the contact stage sees it.

use crate::shape::Frame;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Frame, velocities and inertia of one body. Walls and driven bodies have zero inverse
/// mass and inertia.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Body to world; the origin is the centroid.
    pub frame: Frame,
    /// Velocity of the origin, m/s.
    pub velocity: Vector3,
    /// Angular velocity, world axes, rad/s.
    pub angular_velocity: Vector3,
    /// 1/m, 1/kg.
    pub inverse_mass: f64,
    /// Inverse inertia tensor in world axes, 1/(kg m^2).
    pub inverse_inertia: Matrix3,
    /// Largest eigenvalue of `inverse_inertia`, 1/(kg m^2).
    pub inverse_inertia_max: f64,
    /// Upper bound of the path length of any point of the body so far, m.
    pub travelled: f64,
}

impl Motion {
    /// A body at rest with zero inverse mass and inertia.
    pub fn fixed(frame: Frame) -> Self {
        Self {
            frame,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            inverse_mass: 0.0,
            inverse_inertia: Matrix3::zeros(),
            inverse_inertia_max: 0.0,
            travelled: 0.0,
        }
    }

    /// Velocity of the body's point at `arm` from its origin, m/s.
    #[inline]
    pub fn velocity_at(&self, arm: &Vector3) -> Vector3 {
        self.velocity + self.angular_velocity.cross(arm)
    }

    /// Largest inverse mass against a unit force in any direction at `arm`, 1/kg.
    #[inline]
    pub fn inverse_mass_at(&self, arm: &Vector3) -> f64 {
        self.inverse_mass + self.inverse_inertia_max * arm.norm_squared()
    }

    /// Whether every number is finite, and none of the inverse masses negative.
    pub(crate) fn is_sound(&self) -> bool {
        let all = |v: &Vector3| v.iter().all(|x| x.is_finite());
        let inverse = |x: f64| x >= 0.0 && x.is_finite();
        all(&self.frame.position)
            && all(&self.velocity)
            && all(&self.angular_velocity)
            && self.frame.rotation.iter().all(|x| x.is_finite())
            && inverse(self.inverse_mass)
            && inverse(self.inverse_inertia_max)
            && self.inverse_inertia.iter().all(|x| x.is_finite())
            && self.travelled.is_finite()
    }
}
