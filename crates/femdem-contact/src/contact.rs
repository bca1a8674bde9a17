//! What the batch stage reports: contacts and loads.

use crate::damping::Damped;
use crate::friction::Friction;
use crate::kernel::Overlap;
use crate::motion::Motion;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// A body of the batch, by order of addition.
pub type BodyId = u32;

/// The other side of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Partner {
    /// A body.
    Body(BodyId),
    /// A wall, by order of addition.
    Wall(u32),
}

/// One contact patch of a touching pair: a body or wall A, and a body B. Convex bodies touch in
/// one patch; others may touch in several, each a contact of its own. Vectors are in world axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Side A: the body with the lower index, or a wall.
    pub a: Partner,
    /// Side B.
    pub b: BodyId,
    /// Rank of the patch within its pair, from 0.
    pub patch: u32,
    /// Contact point (centre of pressure), m.
    pub point: Vector3,
    /// Contact point relative to the origins of A and B, m.
    pub arm_a: Vector3,
    /// See `arm_a`.
    pub arm_b: Vector3,
    /// Unit normal from A to B.
    pub normal: Vector3,
    /// Elastic part of the normal force, N.
    pub elastic_force: f64,
    /// Normal force on B along `normal`, damping included, N.
    pub normal_force: f64,
    /// Free moment on B that comes with the elastic force, N m.
    pub moment: Vector3,
    /// Moment on B of the dashpots against rocking, N m.
    pub rocking: Vector3,
    /// Friction force on B, N.
    pub friction: Vector3,
    /// Friction moment on B about the normal, N m.
    pub torsion: f64,
    /// Whether the patch slides.
    pub slides: bool,
    /// Contact area, m^2.
    pub area: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Contact energy U, J.
    pub energy: f64,
    /// Energy in the friction springs, J.
    pub spring_energy: f64,
    /// Normal stiffness, N/m.
    pub stiffness: f64,
    /// Stiffness of the tangential spring, N/m.
    pub tangential_stiffness: f64,
    /// Polar second moment of the normal stiffness over the patch, N m.
    pub stiffness_second: f64,
    /// Shares of A and B in the stability bound; see [`Load::frequency2`].
    pub(crate) shares: [f64; 2],
    /// Contribution to the viscous rate bound of A and B, 1/s.
    pub(crate) rate: [f64; 2],
}

/// Puts the parts of one patch together.
pub(crate) fn assemble(
    (a, b, patch): (Partner, BodyId, u32),
    overlap: &Overlap,
    damped: &Damped,
    friction: &Friction,
    motions: [&Motion; 2],
) -> Contact {
    let elastic_force = overlap.force_magnitude();
    let bound = |k: f64, w: [f64; 2], i: usize| k * (w[i] + (w[0] * w[1]).sqrt());
    let rate = [0, 1].map(|i| {
        bound(damped.viscosity, damped.inverse_mass, i)
            + bound(friction.viscosity, friction.inverse_mass, i)
    });
    let w = friction.inverse_mass;
    let shares = [0, 1].map(|i| {
        if w[i] > 0.0 {
            1.0 + (w[1 - i] / w[i]).sqrt()
        } else {
            0.0
        }
    });
    Contact {
        a,
        b,
        patch,
        point: motions[1].frame.position + overlap.arm_b,
        arm_a: overlap.arm_a,
        arm_b: overlap.arm_b,
        normal: overlap.normal,
        elastic_force,
        normal_force: elastic_force * damped.scale,
        moment: overlap.moment,
        rocking: damped.rocking,
        friction: friction.force,
        torsion: friction.torsion,
        slides: friction.slides,
        area: overlap.area,
        volume: overlap.volume,
        energy: overlap.energy,
        spring_energy: friction.energy,
        stiffness: overlap.stiffness,
        tangential_stiffness: friction.stiffness,
        stiffness_second: overlap.stiffness_second,
        shares,
        rate,
    }
}

impl Contact {
    /// Total force on B, N.
    pub fn force_on_b(&self) -> Vector3 {
        self.normal * self.normal_force + self.friction
    }

    /// Penetration estimate, m: overlap volume over contact area.
    pub fn penetration(&self) -> f64 {
        if self.area > 0.0 {
            self.volume / self.area
        } else {
            0.0
        }
    }

    /// Normal force over its elastic part: what the dashpot makes of it.
    fn damping_scale(&self) -> f64 {
        if self.elastic_force > 0.0 {
            self.normal_force / self.elastic_force
        } else {
            0.0
        }
    }
}

/// Force and torque on a body about its origin.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Wrench {
    /// Force, N.
    pub force: Vector3,
    /// Torque about the origin, N m.
    pub torque: Vector3,
}

impl Wrench {
    fn add(&mut self, force: Vector3, moment: Vector3, arm: &Vector3) {
        self.force += force;
        self.torque += moment + arm.cross(&force);
    }

    /// Power at the given velocities, W.
    pub fn power(&self, velocity: &Vector3, angular_velocity: &Vector3) -> f64 {
        self.force.dot(velocity) + self.torque.dot(angular_velocity)
    }
}

/// Everything the contacts do to one body.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Load {
    /// Total wrench.
    pub total: Wrench,
    /// The part of the normal damping.
    pub damping: Wrench,
    /// The part of friction and torsion.
    pub friction: Wrench,
    /// Sum of the normal forces, N.
    pub normal_sum: f64,
    /// Number of bodies and walls in contact; the patches of a pair count once.
    pub contacts: u32,
    /// Stiffness of the contacts against moving the body, weighted by its shares, N/m.
    pub stiffness: Matrix3,
    /// The same against turning it, N m.
    pub turning_stiffness: Matrix3,
    /// Bound of the viscous rates, 1/s.
    pub rate: f64,
}

impl Load {
    /// Adds a contact; `side` 0 is A, 1 is B.
    pub(crate) fn add(&mut self, contact: &Contact, side: usize) {
        let (sign, arm) = if side == 1 {
            (1.0, &contact.arm_b)
        } else {
            (-1.0, &contact.arm_a)
        };
        let scale = contact.damping_scale();
        let elastic = contact.normal * (sign * contact.elastic_force);
        let moment = contact.moment * sign;
        let friction = contact.friction * sign;
        let torsion = contact.normal * (sign * contact.torsion);
        let rocking = contact.rocking * sign;
        self.total.add(
            elastic * scale + friction,
            moment * scale + rocking + torsion,
            arm,
        );
        self.friction.add(friction, torsion, arm);
        self.damping.add(
            elastic * (scale - 1.0),
            moment * (scale - 1.0) + rocking,
            arm,
        );
        self.normal_sum += contact.normal_force;
        self.contacts += u32::from(contact.patch == 0);
        self.add_stiffness(contact, arm, contact.shares[side]);
        self.rate += contact.rate[side];
    }

    fn add_stiffness(&mut self, contact: &Contact, arm: &Vector3, share: f64) {
        let n = &contact.normal;
        let (kn, kt) = (
            contact.stiffness * share,
            contact.tangential_stiffness * share,
        );
        // Springs along and across the normal, at the contact point.
        self.stiffness += n * (n * (kn - kt)).transpose();
        let lever = arm.cross(n);
        self.turning_stiffness +=
            lever * (lever * (kn - kt)).transpose() - arm * (arm * kt).transpose();
        // The foundation spread over the patch: rocking by half its polar second moment,
        // torsion by the tangential share of all of it.
        let second = contact.stiffness_second * share;
        let ratio = if contact.stiffness > 0.0 {
            contact.tangential_stiffness / contact.stiffness
        } else {
            0.0
        };
        self.turning_stiffness += n * (n * (second * (ratio - 0.5))).transpose();
        for k in 0..3 {
            self.stiffness[(k, k)] += kt;
            self.turning_stiffness[(k, k)] += kt * arm.norm_squared() + 0.5 * second;
        }
    }

    /// Bound of the squared frequencies of a body, 1/s^2, with its inverse mass and largest
    /// inverse moment of inertia.
    ///
    /// The stiffness matrix of a pair, scaled by masses, is at most its own diagonal blocks
    /// times 1 + sqrt(w_j/w_i) and 1 + sqrt(w_i/w_j), w the inverse masses at the contact:
    /// the shares. Each body's block is at most the sum of its two diagonal blocks.
    pub fn frequency2(&self, inverse_mass: f64, inverse_inertia: f64) -> f64 {
        largest(&self.stiffness) * inverse_mass + largest(&self.turning_stiffness) * inverse_inertia
    }
}

/// Upper bound of the largest eigenvalue of a symmetric matrix: the root of the largest row
/// sum of its square.
fn largest(m: &Matrix3) -> f64 {
    let square = m * m;
    let row = |i: usize| (0..3).map(|j| square[(i, j)].abs()).sum::<f64>();
    row(0).max(row(1)).max(row(2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_lies_just_above_the_largest_eigenvalue() {
        let mut x = 0.3_f64;
        let mut next = || {
            x = (x * 997.0 + 0.123).fract();
            x - 0.5
        };
        for _ in 0..200 {
            let a = Matrix3::from_fn(|_, _| next());
            let m = a * a.transpose();
            let exact = m.symmetric_eigenvalues().max();
            let bound = largest(&m);
            assert!(
                bound >= exact * (1.0 - 1e-12) && bound < 1.4 * exact,
                "{bound} {exact}"
            );
        }
    }
}
