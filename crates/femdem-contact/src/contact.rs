//! What the batch stage reports: contacts and loads.

use crate::damping::Damped;
use crate::friction::Friction;
use crate::generalized::{Generalized, largest_step};
use crate::kernel::Overlap;
use crate::motion::Motion;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

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
    /// Shares of A and B in the stability bound; see [`Load::largest_step`].
    pub(crate) shares: [f64; 2],
    pub(crate) dashpots: Dashpots,
}

/// Viscosities of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Dashpots {
    /// Along the elastic wrench, N s/m.
    normal: f64,
    /// In the contact plane, N s/m.
    tangential: f64,
    /// Turning about an axis in the contact plane, N m s.
    rocking: f64,
    /// Turning about the normal, N m s.
    torsion: f64,
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
        dashpots: Dashpots {
            normal: damped.viscosity,
            tangential: friction.viscosity,
            rocking: damped.rocking_viscosity,
            torsion: friction.torsion_viscosity,
        },
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

impl AddAssign<&Self> for Wrench {
    fn add_assign(&mut self, other: &Self) {
        self.force += other.force;
        self.torque += other.torque;
    }
}

/// The loads of two sets of contacts together.
impl AddAssign<&Self> for Load {
    fn add_assign(&mut self, other: &Self) {
        self.total += &other.total;
        self.damping += &other.damping;
        self.friction += &other.friction;
        self.normal_sum += other.normal_sum;
        self.contacts += other.contacts;
        self.stiffness += &other.stiffness;
        self.viscosity += &other.viscosity;
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
    /// Stiffness of the contacts, weighted by the body's shares in them.
    pub stiffness: Generalized,
    /// Viscosity of their dashpots, weighted alike.
    pub viscosity: Generalized,
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
        self.add_viscosity(contact, arm, contact.shares[side]);
    }

    fn add_stiffness(&mut self, contact: &Contact, arm: &Vector3, share: f64) {
        let n = &contact.normal;
        let (kn, kt) = (
            contact.stiffness * share,
            contact.tangential_stiffness * share,
        );
        // Springs along and across the normal, at the contact point.
        self.stiffness.add_along(n, &arm.cross(n), kn - kt);
        self.stiffness.add_everywhere(arm, kt);
        // The foundation spread over the patch: rocking by at most its polar second moment (all
        // of it where the patch is long and narrow), torsion by the tangential share of it.
        let second = contact.stiffness_second * share;
        let torsion = if kn > 0.0 { second * kt / kn } else { 0.0 };
        self.stiffness.add_turning(n, torsion, second);
    }

    fn add_viscosity(&mut self, contact: &Contact, arm: &Vector3, share: f64) {
        let n = &contact.normal;
        let dashpots = &contact.dashpots;
        let tangential = dashpots.tangential * share;
        if contact.elastic_force > 0.0 {
            let lever = arm.cross(n) + contact.moment / contact.elastic_force;
            self.viscosity.add_along(n, &lever, dashpots.normal * share);
        }
        self.viscosity.add_along(n, &arm.cross(n), -tangential);
        self.viscosity.add_everywhere(arm, tangential);
        self.viscosity
            .add_turning(n, dashpots.torsion * share, dashpots.rocking * share);
    }

    /// Adds what a body that deforms does to this one: elastic, damping and friction wrenches.
    pub(crate) fn add_wrenches(&mut self, elastic: &Wrench, damping: &Wrench, friction: &Wrench) {
        for part in [elastic, damping, friction] {
            self.total += part;
        }
        self.damping += damping;
        self.friction += friction;
    }

    /// The largest step for which the contacts of a body are stable, at most `most`, s.
    ///
    /// The matrix of a pair is at most its own diagonal blocks times 1 + sqrt(w_j/w_i) and
    /// 1 + sqrt(w_i/w_j), w the inverse masses at the contact: the shares. A step that each
    /// body's block allows is therefore allowed by the whole.
    pub fn largest_step(&self, motion: &Motion, most: f64) -> f64 {
        largest_step(&self.stiffness, &self.viscosity, motion, most)
    }
}
