//! What the batch stage reports: contacts and loads.

use crate::adhesion::Adhesion;
use crate::axes::complete;
use crate::damping::Damped;
use crate::foundation::Foundation;
use crate::friction::Friction;
use crate::generalized::{Resistance, stable_step};
use crate::kernel::{Overlap, mean_penetration};
use crate::motion::Motion;
use crate::rocking::Rocking;
use crate::rolling::Rolling;
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

/// A [`Contact`](crate::Contact) of rigid bodies or of one and a wall, with all that the law and an implicit step need to know
/// of it. Vectors are in world axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RigidContact {
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
    /// Moment on B of the elastic force about the contact point, N m.
    pub moment: Vector3,
    /// Moment on B of the dashpot against rocking, N m.
    pub rocking: Vector3,
    /// Friction force on B, N.
    pub friction: Vector3,
    /// Friction moment on B about the normal, N m.
    pub torsion: f64,
    /// The part of friction and of its moment that is due to the dashpots beside the springs, N and N m.
    pub drag: Vector3,
    /// See `drag`.
    pub drag_torsion: f64,
    /// Moment of rolling friction on B, and the part of it that is due to the dashpot, N m.
    pub rolling: Vector3,
    /// See `rolling`.
    pub drag_rolling: Vector3,
    /// Stiffness of the spring against rolling, N m.
    pub rolling_stiffness: f64,
    /// Whether the patch slides.
    pub slides: bool,
    /// True if the contact was evaluated at the poses predicted for the end of the step, because the pair
    /// does not touch yet or its force grows much faster than its stiffness says. Only set by
    /// [`ContactBatch::update_springs`](crate::ContactBatch::update_springs).
    pub foreseen: bool,
    /// Contact area, m^2.
    pub area: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Contact energy U, J.
    pub energy: f64,
    /// Energy in the friction springs, J.
    pub spring_energy: f64,
    /// The stiffness of the patch along its normal.
    pub foundation: Foundation,
    /// Stiffness of the tangential spring, N/m.
    pub tangential_stiffness: f64,
    /// The attraction by cohesion, adhesion and a liquid bridge.
    pub adhesion: Adhesion,
    /// Mean distance of the pressure from the contact point, m. The friction moment of a spinning patch is mu
    /// F times this radius.
    pub torsion_radius: f64,
    /// Shares of A and B in the stability bound; see [`Resistance::largest_step`].
    pub(crate) shares: [f64; 2],
    pub(crate) dashpots: Dashpots,
}

/// Stiffnesses of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Springs {
    /// Along the normal, N/m.
    pub normal: f64,
    /// In the contact plane, N/m.
    pub tangential: f64,
    /// Turning about the two principal axes in the contact plane (see [`Foundation`]), N m.
    pub rocking: [f64; 2],
    /// Turning about the normal, N m.
    pub torsion: f64,
    /// Rolling about any axis in the contact plane, N m.
    pub rolling: f64,
}

/// Viscosities of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Dashpots {
    /// Along the elastic wrench, N s/m.
    pub normal: f64,
    /// In the contact plane, N s/m.
    pub tangential: f64,
    /// Turning about the two principal axes in the contact plane (see [`Foundation`]), N m s.
    pub rocking: [f64; 2],
    /// Turning about the normal, N m s.
    pub torsion: f64,
    /// Rolling about any axis in the contact plane, N m s.
    pub rolling: f64,
}

/// Forces and moments of a contact on its side B, as an implicit step finds them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Along the normal, N. The moment of the elastic wrench scales with it.
    pub normal: f64,
    /// Friction, N.
    pub friction: Vector3,
    /// Friction moment about the normal, N m.
    pub torsion: f64,
    /// Moment against rocking, N m.
    pub rocking: Vector3,
    /// Whether the patch slides.
    pub slides: bool,
}

impl Springs {
    fn scaled(&self, share: f64) -> Self {
        Self {
            normal: self.normal * share,
            tangential: self.tangential * share,
            rocking: self.rocking.map(|x| x * share),
            torsion: self.torsion * share,
            rolling: self.rolling * share,
        }
    }
}

impl Dashpots {
    fn scaled(&self, share: f64) -> Self {
        Self {
            normal: self.normal * share,
            tangential: self.tangential * share,
            rocking: self.rocking.map(|x| x * share),
            torsion: self.torsion * share,
            rolling: self.rolling * share,
        }
    }
}

/// The radius on which two sides roll on each other, m, of the distances of both centroids from the contact point, m;
/// infinite for a wall.
pub(crate) fn rolling_radius(of_a: f64, of_b: f64) -> f64 {
    // Not the quotient of product and sum, which is none where a distance is infinite or both are zero.
    let [small, large] = if of_a < of_b {
        [of_a, of_b]
    } else {
        [of_b, of_a]
    };
    if small > 0.0 {
        small / (1.0 + small / large)
    } else {
        0.0
    }
}

/// The same from the arms of a contact with a unit normal, m.
pub(crate) fn rolling_radius_at(a: Partner, normal: &Vector3, arms: [&Vector3; 2]) -> f64 {
    let [of_a, of_b] = arms.map(|arm| normal.dot(arm).abs());
    match a {
        Partner::Body(_) => rolling_radius(of_a, of_b),
        Partner::Wall(_) => rolling_radius(f64::INFINITY, of_b),
    }
}

/// Assembles the contact record of one patch.
pub(crate) fn assemble(
    (a, b, patch): (Partner, BodyId, u32),
    overlap: &Overlap,
    damped: &Damped,
    (rocking, rolling): (&Rocking, &Rolling),
    friction: &Friction,
    motions: [&Motion; 2],
) -> RigidContact {
    let elastic_force = overlap.force_magnitude();
    let w = friction.inverse_mass;
    let shares = [0, 1].map(|i| {
        if w[i] > 0.0 {
            1.0 + (w[1 - i] / w[i]).sqrt()
        } else {
            0.0
        }
    });
    RigidContact {
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
        rocking: rocking.moment,
        friction: friction.force,
        torsion: friction.torsion,
        drag: friction.drag,
        drag_torsion: friction.drag_torsion,
        rolling: rolling.moment,
        drag_rolling: rolling.drag,
        rolling_stiffness: rolling.stiffness,
        slides: friction.slides,
        foreseen: false,
        area: overlap.area,
        volume: overlap.volume,
        energy: overlap.energy,
        spring_energy: friction.energy + rolling.energy,
        foundation: overlap.foundation,
        tangential_stiffness: friction.stiffness,
        adhesion: Adhesion::default(),
        torsion_radius: overlap.torsion_radius,
        shares,
        dashpots: Dashpots {
            normal: damped.viscosity,
            tangential: friction.viscosity,
            rocking: rocking.viscosity,
            torsion: friction.torsion_viscosity,
            rolling: rolling.viscosity,
        },
    }
}

impl RigidContact {
    /// Two that are apart, joined by a liquid bridge along the unit vector `normal` from A to B. `arms` lead from their origins
    /// to the middle of the gap, `point`.
    pub(crate) fn across_gap(
        (a, b): (Partner, BodyId),
        point: Vector3,
        [arm_a, arm_b]: [Vector3; 2],
        normal: Vector3,
        adhesion: Adhesion,
    ) -> Self {
        let [_, axis, _] = complete(&normal);
        let zero = Vector3::zeros();
        Self {
            a,
            b,
            patch: 0,
            point,
            arm_a,
            arm_b,
            normal,
            elastic_force: 0.0,
            normal_force: 0.0,
            moment: zero,
            rocking: zero,
            friction: zero,
            torsion: 0.0,
            drag: zero,
            drag_torsion: 0.0,
            rolling: zero,
            drag_rolling: zero,
            rolling_stiffness: 0.0,
            slides: false,
            foreseen: false,
            area: 0.0,
            volume: 0.0,
            energy: 0.0,
            spring_energy: 0.0,
            foundation: Foundation::round(zero, axis, 0.0, 0.0),
            tangential_stiffness: 0.0,
            adhesion,
            torsion_radius: 0.0,
            shares: [0.0; 2],
            dashpots: Dashpots {
                normal: 0.0,
                tangential: 0.0,
                rocking: [0.0; 2],
                torsion: 0.0,
                rolling: 0.0,
            },
        }
    }

    /// Whether it resists a motion: a liquid bridge over a gap does not.
    pub(crate) fn resists(&self) -> bool {
        let springs = self.springs();
        springs.normal.max(springs.tangential) > 0.0
    }

    /// Stiffnesses of the springs: those of the foundation, integrated over the patch, and of the bristles in its
    /// plane.
    pub fn springs(&self) -> Springs {
        let normal = self.foundation.stiffness;
        Springs {
            normal,
            tangential: self.tangential_stiffness,
            rocking: self.foundation.rocking,
            torsion: if normal > 0.0 {
                self.foundation.polar() * self.tangential_stiffness / normal
            } else {
                0.0
            },
            rolling: self.rolling_stiffness,
        }
    }

    /// Viscosities of the dashpots.
    pub fn dashpots(&self) -> &Dashpots {
        &self.dashpots
    }

    pub(crate) fn set_force(&mut self, force: &ContactForce) {
        self.normal_force = force.normal;
        self.friction = force.friction;
        self.torsion = force.torsion;
        (self.drag, self.drag_torsion) = (Vector3::zeros(), 0.0);
        self.rocking = force.rocking;
        self.slides = force.slides;
    }

    /// Total force on B, N.
    pub fn force_on_b(&self) -> Vector3 {
        self.normal * self.normal_force + self.friction + self.adhesion.force
    }

    /// Elastic energy and that of the attraction, J.
    pub fn potential(&self) -> f64 {
        self.energy + self.adhesion.energy
    }

    /// Penetration estimate, m: overlap volume over contact area.
    pub fn penetration(&self) -> f64 {
        mean_penetration(self.volume, self.area)
    }

    /// The radius on which A and B roll on each other, m: l_A l_B/(l_A + l_B) with the distances l of their centroids
    /// from the contact point along the normal, l_B against a wall. It is the reduced radius of two spheres.
    pub fn rolling_radius(&self) -> f64 {
        rolling_radius_at(self.a, &self.normal, [&self.arm_a, &self.arm_b])
    }

    /// Lever of the elastic wrench about the origin of `arm`, m. The normal dashpot acts along this wrench.
    fn elastic_lever(&self, arm: &Vector3) -> Option<Vector3> {
        (self.elastic_force > 0.0)
            .then(|| arm.cross(&self.normal) + self.moment / self.elastic_force)
    }

    /// Normal force with damping over the elastic normal force.
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
        self.viscous += &other.viscous;
        self.normal_sum += other.normal_sum;
        self.contacts += other.contacts;
        for k in 0..2 {
            self.bounds.stiffness[k] += other.bounds.stiffness[k];
            self.bounds.viscosity[k] += other.bounds.viscosity[k];
        }
    }
}

/// Everything the contacts do to one body.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Load {
    /// Total wrench.
    pub total: Wrench,
    /// The part due to normal damping and to the dashpot against rocking.
    pub damping: Wrench,
    /// The part due to friction and torsion.
    pub friction: Wrench,
    /// The part due to all dashpots: `damping`, and the drag in `friction`. What is left is the load if nothing
    /// moved, by which rest is judged.
    pub viscous: Wrench,
    /// Sum of the normal forces, and of the magnitudes of those in bonds, N.
    pub normal_sum: f64,
    /// Number of bodies and walls in contact, or joined by a liquid bridge, where the patches of a pair count once; and of bonds.
    pub contacts: u32,
    bounds: Bounds,
}

/// Upper bounds of the largest eigenvalues of the body's [`Resistance`], as sums over its contacts. The first
/// number is multiplied by the inverse mass, the second by the largest inverse moment of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
struct Bounds {
    /// N/m and N m.
    stiffness: [f64; 2],
    /// N s/m and N m s.
    viscosity: [f64; 2],
}

/// The bounds are summed separately from the matrices and differ from them by rounding.
const BOUNDS_TO_SPARE: f64 = 1.0 + 1e-9;

impl Load {
    /// Adds a contact; `side` 0 is A, 1 is B.
    pub(crate) fn add(&mut self, contact: &RigidContact, side: usize) {
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
        let (rocking, rolling) = (contact.rocking * sign, contact.rolling * sign);
        self.total.add(
            elastic * scale + friction,
            moment * scale + rocking + rolling + torsion,
            arm,
        );
        let pull = &contact.adhesion;
        if !pull.is_none() {
            self.total.add(pull.force * sign, pull.moment * sign, arm);
        }
        self.friction.add(friction, torsion + rolling, arm);
        let damping = elastic * (scale - 1.0);
        let damping_moment = moment * (scale - 1.0) + rocking;
        self.damping.add(damping, damping_moment, arm);
        let drag = contact.drag * sign;
        let drag_moment = (contact.normal * contact.drag_torsion + contact.drag_rolling) * sign;
        self.viscous
            .add(damping + drag, damping_moment + drag_moment, arm);
        self.normal_sum += contact.normal_force;
        self.contacts += u32::from(contact.patch == 0);
        self.bounds.add(contact, arm, contact.shares[side]);
    }

    /// Adds what a bond does to one side: the wrenches of its springs and its dashpot, its normal force (N), and bounds of its
    /// stiffness and viscosity against translation and against rotation.
    pub(crate) fn add_bond(
        &mut self,
        [elastic, damping]: [&Wrench; 2],
        normal: f64,
        [stiffness, viscosity]: [[f64; 2]; 2],
    ) {
        self.total += elastic;
        for part in [&mut self.total, &mut self.damping, &mut self.viscous] {
            *part += damping;
        }
        self.normal_sum += normal;
        self.contacts += 1;
        for k in 0..2 {
            self.bounds.stiffness[k] += stiffness[k];
            self.bounds.viscosity[k] += viscosity[k];
        }
    }

    /// Adds the wrenches of a deformable body on this one: elastic, damping, friction, and the drag in friction.
    pub(crate) fn add_wrenches(&mut self, [elastic, damping, friction, drag]: [&Wrench; 4]) {
        for part in [elastic, damping, friction] {
            self.total += part;
        }
        self.damping += damping;
        self.friction += friction;
        self.viscous += damping;
        self.viscous += drag;
    }

    /// Whether a contact or a bond resists a motion: a liquid bridge over a gap does not.
    pub(crate) fn resists(&self) -> bool {
        self.bounds.stiffness[0] > 0.0
    }

    /// Whether every number is finite.
    pub(crate) fn is_finite(&self) -> bool {
        let Bounds {
            stiffness,
            viscosity,
        } = self.bounds;
        let wrenches = [&self.total, &self.damping, &self.friction, &self.viscous];
        let of_wrenches = |w: &&Wrench| w.force.iter().chain(&w.torque).all(|x| x.is_finite());
        wrenches.iter().all(of_wrenches)
            && self.normal_sum.is_finite()
            && stiffness.iter().chain(&viscosity).all(|x| x.is_finite())
    }

    /// The load without what dashpots add while the body or its partners move.
    pub fn static_part(&self) -> Wrench {
        Wrench {
            force: self.total.force - self.viscous.force,
            torque: self.total.torque - self.viscous.torque,
        }
    }

    /// A step that is stable even if all contacts of the body resisted the same motion, s. This cheap bound
    /// suffices for most bodies at the step of the most restrictive one.
    pub(crate) fn safe_step(&self, motion: &Motion) -> f64 {
        let weighted = |[translation, turning]: [f64; 2]| {
            motion.inverse_mass * translation + motion.inverse_inertia_max * turning
        };
        let Bounds {
            stiffness,
            viscosity,
        } = self.bounds;
        stable_step(weighted(stiffness), weighted(viscosity)) / BOUNDS_TO_SPARE
    }
}

impl Bounds {
    fn add(&mut self, contact: &RigidContact, arm: &Vector3, share: f64) {
        let square = arm.norm_squared();
        let springs = contact.springs().scaled(share);
        // The stiffness against any motion of the contact point is at most that of the stiffest spring.
        let point = springs.normal.max(springs.tangential);
        self.stiffness[0] += point;
        let [_, rocking] = springs.rocking;
        self.stiffness[1] += point * square + springs.torsion.max(rocking + springs.rolling);
        let dashpots = contact.dashpots.scaled(share);
        // The normal dashpot acts along another line than the spring.
        if let Some(lever) = contact.elastic_lever(arm) {
            self.viscosity[0] += dashpots.normal;
            self.viscosity[1] += dashpots.normal * lever.norm_squared();
        }
        self.viscosity[0] += dashpots.tangential;
        let [about_long, about_short] = dashpots.rocking;
        self.viscosity[1] += dashpots.tangential * square
            + dashpots
                .torsion
                .max(about_long.max(about_short) + dashpots.rolling);
    }
}

impl Resistance {
    /// Adds the springs and dashpots of a contact; `side` 0 is A, 1 is B. `moves` says whether the other side
    /// moves: only then are they weighted by this side's share.
    pub(crate) fn add(&mut self, contact: &RigidContact, side: usize, moves: bool) {
        let arm = [&contact.arm_a, &contact.arm_b][side];
        let share = if moves { contact.shares[side] } else { 1.0 };
        let n = &contact.normal;
        let springs = contact.springs().scaled(share);
        // Springs along and across the normal, at the contact point.
        self.stiffness
            .add_along(n, &arm.cross(n), springs.normal - springs.tangential);
        self.stiffness.add_everywhere(arm, springs.tangential);
        self.stiffness.add_about(n, springs.torsion);
        let axes = contact.foundation.axes(n);
        for (axis, value) in axes.iter().zip(springs.rocking) {
            self.stiffness.add_about(axis, value + springs.rolling);
        }
        let dashpots = contact.dashpots.scaled(share);
        if let Some(lever) = contact.elastic_lever(arm) {
            self.viscosity.add_along(n, &lever, dashpots.normal);
        }
        self.viscosity
            .add_along(n, &arm.cross(n), -dashpots.tangential);
        self.viscosity.add_everywhere(arm, dashpots.tangential);
        self.viscosity.add_about(n, dashpots.torsion);
        for (axis, value) in axes.iter().zip(dashpots.rocking) {
            self.viscosity.add_about(axis, value + dashpots.rolling);
        }
    }
}
