//! How a body moves or is acted on as a whole.

use femdem_mesh::Vector3;

/// Velocity and turning of a body (m/s, rad/s), or force and torque (N, N m).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Twist {
    pub velocity: Vector3,
    pub turning: Vector3,
}

impl Twist {
    pub fn dot(&self, other: &Self) -> f64 {
        self.velocity.dot(&other.velocity) + self.turning.dot(&other.turning)
    }

    pub fn add_scaled(&mut self, other: &Self, scale: f64) {
        self.velocity += other.velocity * scale;
        self.turning += other.turning * scale;
    }
}
