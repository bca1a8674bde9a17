//! Normal damping with an exact coefficient of restitution.
//!
//! The dashpot acts along the gradient of the contact energy, in the space of both
//! bodies' motions: F_d = 2 zeta sqrt(m_eff) |grad U| / sqrt(2 U) times the closing rate.
//! It scales the whole elastic wrench, so the restitution depends on zeta alone,
//! whatever touches what (face, edge or vertex).
//!
//! Two errors of first order in the step are corrected. The velocity is half a step old ([`against_lag`]),
//! and a dashpot whose force begins with a jump within a step acts for only a part of that step ([`Birth`]).
//! The remaining error is of second order.
//!
//! Rocking about the contact point is orthogonal to that gradient; see [`crate::rocking`].

use crate::kernel::Overlap;
use crate::motion::Motion;
use femdem_mesh::Vector3;

/// A contact counts as new if it is at most this many times as deep as it can have become within the step.
const SLACK: f64 = 1.1;

/// Result of the normal dashpot of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Damped {
    /// Elastic plus viscous force over elastic force; at least 0 (no tension).
    pub scale: f64,
    /// Inverse effective masses of A and B along the contact direction, levers included, 1/kg.
    pub inverse_mass: [f64; 2],
    /// Viscous coefficient, N s/m.
    pub viscosity: f64,
    /// Correction for a new patch.
    pub birth: Option<Birth>,
}

/// Generalised inverse mass of one body for a unit force at the contact with its lever.
fn inverse_mass(motion: &Motion, torque: &Vector3, magnitude: f64) -> f64 {
    let lever = torque / magnitude;
    motion.inverse_mass + lever.dot(&(motion.inverse_inertia * lever))
}

/// The time of a contact evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Moment {
    /// Time since the evaluation before, s.
    pub dt: f64,
    /// Whether the patch did not exist then.
    pub fresh: bool,
}

/// Corrections in the first evaluation of a new patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Birth {
    /// Time for which the springs have been stretched, at their present stiffness, s.
    pub since: f64,
    /// Factor of the dashpots' forces.
    pub weight: f64,
}

/// Factor that corrects a dashpot for a velocity that is half a step old; `dt` is the step, s. `rate` is its
/// viscosity over the mass, 1/s. `sharpness` is p/(2 (p - 1)) for an energy proportional to the depth to the
/// power of p; it is 1 for a linear spring.
///
/// With e = rate dt/2, spring and dashpot act as F (1 + e) and c (1 + e) would without lag. The energy grows
/// by e p/(2 (p - 1)), so the ratio of damping is kept by c (1 - e p/(4 (p - 1))).
pub(crate) fn against_lag(rate: f64, dt: f64, sharpness: f64) -> f64 {
    let h = 0.25 * rate * dt * sharpness;
    // 1 - h for short steps; stays positive for long ones.
    (1.0 + h * h).sqrt() - h
}

/// Quantities of a contact, or of all patches of a pair together, that the dashpot depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sums {
    /// Elastic force, N; for several patches the sum of the magnitudes.
    force: f64,
    /// J.
    energy: f64,
    /// N/m.
    stiffness: f64,
    /// Inverse effective mass along the gradient of the energy, 1/kg.
    inverse_mass: f64,
}

impl Sums {
    /// Viscous over elastic force per closing speed, s/m.
    fn rate(&self, zeta: f64) -> f64 {
        2.0 * zeta / (2.0 * self.energy * self.inverse_mass).sqrt()
    }

    /// p/(2 (p - 1)): 1 for a face, 3/4 for an edge, 1/2 at least.
    fn sharpness(&self) -> f64 {
        let sharpness = self.force * self.force / (2.0 * self.energy * self.stiffness);
        if sharpness > 0.5 {
            sharpness.min(1.0)
        } else {
            0.5
        }
    }

    /// The correction for a contact that closes at `closing` (m/s), if it is new. One evaluation has the
    /// weight of a whole step: one half stands for the time to come, the other for the time since the touch.
    ///
    /// The impulse of a viscous force c ~ x^(p - 2) since then is c x/(p - 1), and F/K = x/(p - 1).
    fn birth(&self, closing: f64, moment: Moment) -> Option<Birth> {
        let way = closing * moment.dt;
        // 2 U/F = 2 x/p. Bodies that overlap from the start are deeper than one step of closing.
        let came = 2.0 * self.energy < SLACK * self.force * way && self.stiffness > 0.0;
        let part = (self.force / (self.stiffness * way)).min(1.0);
        moment.fresh.then_some(if came {
            Birth {
                since: part * moment.dt,
                weight: 0.5 + part,
            }
        } else {
            Birth {
                since: 0.0,
                weight: 1.0,
            }
        })
    }
}

/// All patches of a pair together. Their inverse mass grows where their forces oppose each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Whole(Sums);

impl Whole {
    pub fn new<'a>(patches: impl Iterator<Item = &'a Overlap>, a: &Motion, b: &Motion) -> Self {
        let (mut energy, mut pressed, mut stiffness) = (0.0, 0.0, 0.0);
        let mut total = [Vector3::zeros(); 3];
        for patch in patches {
            energy += patch.energy;
            stiffness += patch.foundation.stiffness;
            pressed += patch.force_magnitude();
            total[0] += patch.force;
            total[1] += patch.torque_a();
            total[2] += patch.torque_b();
        }
        let square = total[0].norm_squared();
        let response = square * (a.inverse_mass + b.inverse_mass)
            + total[1].dot(&(a.inverse_inertia * total[1]))
            + total[2].dot(&(b.inverse_inertia * total[2]));
        Self(Sums {
            force: pressed,
            energy,
            stiffness,
            inverse_mass: response * (pressed / square).powi(2),
        })
    }

    /// Factor of a patch's friction dashpots over those that it would have alone. The dashpots of all patches
    /// together are those of all springs on the same bodies, shared by stiffness.
    pub fn friction_share(&self, patch: &Overlap) -> f64 {
        if self.0.stiffness > 0.0 {
            (patch.foundation.stiffness / self.0.stiffness).sqrt()
        } else {
            1.0
        }
    }
}

/// Scales the elastic wrench of `overlap` by the dashpot of ratio `zeta`. For one of several patches, `whole`
/// is the pair: patches that press the same way are damped as one contact, and patches that press against
/// each other are damped separately.
pub(crate) fn damp(
    overlap: &Overlap,
    whole: Option<&Whole>,
    a: &Motion,
    b: &Motion,
    zeta: f64,
    moment: Moment,
) -> Damped {
    let magnitude = overlap.force_magnitude();
    let (torque_a, torque_b) = (overlap.torque_a(), overlap.torque_b());
    let inverse_mass = [
        inverse_mass(a, &torque_a, magnitude),
        inverse_mass(b, &torque_b, magnitude),
    ];
    let total = inverse_mass[0] + inverse_mass[1];
    let mut damped = Damped {
        scale: 1.0,
        inverse_mass,
        viscosity: 0.0,
        birth: None,
    };
    let alone = Sums {
        force: magnitude,
        energy: overlap.energy,
        stiffness: overlap.foundation.stiffness,
        inverse_mass: total,
    };
    let sums = whole.map_or(alone, |w| Sums {
        // The quotient is undefined where the patches' forces cancel.
        inverse_mass: w.0.inverse_mass.min(total),
        ..w.0
    });
    let power = overlap.force.dot(&(b.velocity - a.velocity))
        + torque_b.dot(&b.angular_velocity)
        + torque_a.dot(&a.angular_velocity);
    let closing = -power / magnitude;
    damped.birth = alone.birth(closing, moment);
    if zeta == 0.0 || sums.inverse_mass <= 0.0 || sums.energy <= 0.0 {
        return damped;
    }
    let rate = sums.rate(zeta);
    damped.viscosity = rate * magnitude;
    let frequency = rate * sums.force * sums.inverse_mass;
    let factor = against_lag(frequency, moment.dt, sums.sharpness())
        * damped.birth.map_or(1.0, |birth| birth.weight);
    damped.scale = (1.0 + factor * rate * closing).max(0.0);
    damped
}
