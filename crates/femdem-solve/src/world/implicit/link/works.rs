//! Works of the forces of a contact in an implicit step, for the energy ledger.

use super::{Link, Twist};
use femdem_contact::ContactForce;

/// Energies of a contact over a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::world::implicit) struct Works {
    /// Work of the dashpots.
    pub damping: f64,
    /// Work of friction, springs included.
    pub friction: f64,
    /// Energy that the normal spring took from the motion and does not store.
    pub step: f64,
}

impl Link {
    /// Works of the forces while the velocities change by `x`. The work of a force on the kinetic energy is
    /// at the mean of the velocities before and after. Dashpots are booked at the velocities after the step.
    /// The rest of the work of the normal force, which the spring does not store, is booked as numerical
    /// dissipation of the step.
    pub(in crate::world::implicit) fn works(&self, forces: &ContactForce, x: &[Twist]) -> Works {
        let (n, dt) = (&self.normal, self.dt);
        let change = self.relative(x);
        let edge = self.rocks().lever;
        let lever = self.lever + edge;
        let opening = |x: &Twist| n.dot(&x.velocity) + lever.dot(&x.turning);
        let mean = Twist {
            velocity: self.before.velocity + change.velocity * 0.5,
            turning: self.before.turning + change.turning * 0.5,
        };
        let spring = self.springs.normal * dt;
        let rate = [&self.before, &change].map(opening);
        let dashpot = self.slopes.normal - spring;
        let elastic = if forces.normal > 0.0 {
            forces.normal + dashpot * (rate[0] + rate[1])
        } else {
            // The sides part faster than the dashpot lets the spring expand; the spring keeps the energy it
            // has not released.
            let passed = if self.foreseen { 0.0 } else { rate[0] };
            self.elastic - spring * (passed + rate[1])
        };
        let elastic = elastic.max(0.0);
        // Force of the spring at the beginning of the step.
        let began = if self.foreseen { spring * rate[0] } else { 0.0 };
        let was = (self.elastic + began).max(0.0);
        let held = if self.springs.normal > 0.0 {
            0.5 * (elastic * elastic - was * was) / self.springs.normal
        } else {
            0.0
        };
        let viscous = (forces.normal - elastic) * (rate[0] + rate[1]) * dt;
        // Without the moment of the normal force at the edge.
        let rocking = forces.rocking - edge * forces.normal;
        Works {
            damping: viscous + rocking.dot(&mean.turning) * dt,
            friction: (forces.friction.dot(&mean.velocity) + forces.torsion * n.dot(&mean.turning))
                * dt,
            step: -forces.normal * opening(&mean) * dt + viscous - held,
        }
    }
}
