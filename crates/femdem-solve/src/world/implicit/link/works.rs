//! Works of the forces of a contact in an implicit step, for the energy ledger.

use super::{Link, Twist};
use femdem_contact::ContactForce;

/// Energies that the forces of a contact took from the motion in a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::world::implicit) struct Works {
    /// By the normal force and the moments of the patch, and by the dashpots in them.
    pub pressing: f64,
    pub damping: f64,
    /// By friction, springs included.
    pub friction: f64,
}

impl Link {
    /// Works of the forces while the velocities change by `x`. The work of a force on the kinetic energy is
    /// at the mean of the velocities before and after; dashpots are booked at the velocities after the step.
    pub(in crate::world::implicit) fn works(&self, forces: &ContactForce, x: &[Twist]) -> Works {
        let (n, dt) = (&self.normal, self.dt);
        let change = self.relative(x);
        let mean = Twist {
            velocity: self.before.velocity + change.velocity * 0.5,
            turning: self.before.turning + change.turning * 0.5,
        };
        let edge = self.rocks().lever;
        let lever = self.lever + edge;
        let opening = |x: &Twist| n.dot(&x.velocity) + lever.dot(&x.turning);
        let rate = opening(&self.before) + opening(&change);
        let dashpot = self.slopes.normal - self.springs.normal * dt;
        // The sides part faster than the dashpot lets the spring expand.
        let viscous = if forces.normal > 0.0 {
            -dashpot * rate
        } else {
            let passed = if self.foreseen {
                opening(&change)
            } else {
                rate
            };
            -(self.elastic - self.springs.normal * dt * passed).max(0.0)
        };
        // Without the moment of the normal force at the edge.
        let rocking = forces.rocking - edge * forces.normal;
        let pressing = -(forces.normal * opening(&mean) + rocking.dot(&mean.turning)) * dt;
        Works {
            pressing,
            damping: -viscous * rate * dt,
            friction: -(forces.friction.dot(&mean.velocity)
                + forces.torsion * n.dot(&mean.turning))
                * dt,
        }
    }
}
