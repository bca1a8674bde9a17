//! Normal damping with an exact coefficient of restitution.
//!
//! The dashpot acts along the gradient of the contact energy, in the space of both
//! bodies' motions: F_d = 2 zeta sqrt(m_eff) |grad U| / sqrt(2 U) times the closing rate.
//! It scales the whole elastic wrench, so the restitution depends on zeta alone,
//! whatever touches what (face, edge or vertex).
//!
//! Rocking about the contact point is orthogonal to that gradient, so the scaling leaves it
//! undamped. A dashpot spread over the patch damps it too: a moment against the relative
//! rotation in the contact plane, with the same fraction of critical damping, bounded so
//! that the centre of pressure stays within the patch (no tension).

use crate::kernel::Overlap;
use crate::motion::Motion;
use femdem_mesh::Vector3;

/// The response of the pair to its own contact direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Damped {
    /// Elastic plus viscous force over elastic force; at least 0 (no tension).
    pub scale: f64,
    /// Inverse effective masses of A and B along the contact direction, levers included, 1/kg.
    pub inverse_mass: [f64; 2],
    /// Viscous coefficient, N s/m.
    pub viscosity: f64,
    /// Rocking moment on B, N m.
    pub rocking: Vector3,
    /// Its viscosity, N m s.
    pub rocking_viscosity: f64,
}

impl Damped {
    /// Takes the forces of the dashpots out; their viscosities stay.
    pub fn leave_springs(&mut self) {
        self.scale = 1.0;
        self.rocking = Vector3::zeros();
    }
}

/// Generalised inverse mass of one body for a unit force at the contact with its lever.
fn inverse_mass(motion: &Motion, torque: &Vector3, magnitude: f64) -> f64 {
    let lever = torque / magnitude;
    motion.inverse_mass + lever.dot(&(motion.inverse_inertia * lever))
}

/// All patches of a pair together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Whole {
    /// J.
    energy: f64,
    /// Inverse effective mass of the pair along its total gradient, 1/kg; larger where the patches
    /// press against each other.
    inverse_mass: f64,
    /// N/m.
    stiffness: f64,
}

impl Whole {
    pub fn new<'a>(patches: impl Iterator<Item = &'a Overlap>, a: &Motion, b: &Motion) -> Self {
        let (mut energy, mut pressed, mut stiffness) = (0.0, 0.0, 0.0);
        let mut total = [Vector3::zeros(); 3];
        for patch in patches {
            energy += patch.energy;
            stiffness += patch.stiffness.max(0.0);
            pressed += patch.force_magnitude();
            total[0] += patch.force;
            total[1] += patch.torque_a();
            total[2] += patch.torque_b();
        }
        let square = total[0].norm_squared();
        let response = square * (a.inverse_mass + b.inverse_mass)
            + total[1].dot(&(a.inverse_inertia * total[1]))
            + total[2].dot(&(b.inverse_inertia * total[2]));
        Self {
            energy,
            inverse_mass: response * (pressed / square).powi(2),
            stiffness,
        }
    }

    /// What a patch has of the friction dashpots that it would have alone: together they are those of all
    /// springs on the same bodies, shared out by stiffness.
    pub fn friction_share(&self, patch: &Overlap) -> f64 {
        if self.stiffness > 0.0 {
            (patch.stiffness.max(0.0) / self.stiffness).sqrt()
        } else {
            1.0
        }
    }
}

/// Scales the elastic wrench of `overlap` by the dashpot of ratio `zeta`. If it is one of several
/// patches, `whole` is the pair: patches that press the same way are damped as one contact would
/// be, and patches that press against each other each by itself.
pub(crate) fn damp(
    overlap: &Overlap,
    whole: Option<&Whole>,
    a: &Motion,
    b: &Motion,
    zeta: f64,
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
        rocking: Vector3::zeros(),
        rocking_viscosity: 0.0,
    };
    let (energy, along) = match whole {
        // The quotient has no value where the patches' forces cancel.
        Some(w) => (w.energy, w.inverse_mass.min(total)),
        None => (overlap.energy, total),
    };
    if zeta == 0.0 || along <= 0.0 || energy <= 0.0 {
        return damped;
    }
    let power = overlap.force.dot(&(b.velocity - a.velocity))
        + torque_b.dot(&b.angular_velocity)
        + torque_a.dot(&a.angular_velocity);
    let closing = -power / magnitude;
    let rate = 2.0 * zeta / (2.0 * energy * along).sqrt();
    damped.viscosity = rate * magnitude;
    damped.scale = (1.0 + rate * closing).max(0.0);
    let inverse_inertia = a.inverse_inertia_max + b.inverse_inertia_max;
    if inverse_inertia > 0.0 {
        // Half of the polar second moment belongs to either axis in the plane.
        damped.rocking_viscosity =
            2.0 * zeta * (0.5 * overlap.stiffness_second / inverse_inertia).sqrt();
    }
    damped.rocking = rocking(
        overlap,
        a,
        b,
        damped.rocking_viscosity,
        magnitude * damped.scale,
    );
    damped
}

/// Moment on B of the dashpots spread over the patch.
fn rocking(
    overlap: &Overlap,
    a: &Motion,
    b: &Motion,
    viscosity: f64,
    normal_force: f64,
) -> Vector3 {
    let n = &overlap.normal;
    let turn = b.angular_velocity - a.angular_velocity;
    let turn = turn - n * n.dot(&turn);
    let moment = -turn * viscosity;
    let most = normal_force * overlap.torsion_radius;
    let size = moment.norm();
    if size > most {
        moment * (most / size)
    } else {
        moment
    }
}
