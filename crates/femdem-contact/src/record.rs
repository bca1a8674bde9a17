//! What every contact is, whatever touches.

use crate::adhesion::Adhesion;
use crate::contact::{BodyId, Partner, RigidContact};
use crate::kernel::mean_penetration;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// One contact patch of a touching pair: a body or wall A, and a body B, rigid or deformable. Convex bodies touch in one patch;
/// others may touch in several, each of which is a contact. Vectors are in world axes.
///
/// Where a deformable body touches itself, A and B are the parts of it on both sides. The forces of a contact that goes round,
/// such as that of a coil of several turns, cancel in the sum, so that `normal` and the forces of its record say little.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Side A: a wall, a rigid body that meets a deformable one, the body of the lower number, or B itself.
    pub a: Partner,
    /// Side B.
    pub b: BodyId,
    /// Number of the patch within its pair, from 0.
    pub patch: u32,
    /// Centre of pressure, m.
    pub point: Vector3,
    /// Direction of the elastic force on B: from A to B.
    pub normal: Vector3,
    /// Elastic force, N.
    pub elastic_force: f64,
    /// Normal force on B along `normal`, damping included, N.
    pub normal_force: f64,
    /// What all parts of the patch press, each along its own normal, N: more than `normal_force` where the patch is curved, as
    /// of a body in a tube, all around which forces cancel.
    pub pressing: f64,
    /// Moment on B of the dashpot against rocking, N m.
    pub rocking: Vector3,
    /// Moment of rolling friction on B, N m.
    pub rolling: Vector3,
    /// Friction force on B, N.
    pub friction: Vector3,
    /// Whether the contact slides; one of deformable bodies, whether every part of it does.
    pub slides: bool,
    /// Contact area, m^2.
    pub area: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Contact energy U, J.
    pub energy: f64,
    /// The attraction by cohesion, adhesion and a liquid bridge: all that there is where a bridge joins two that are apart.
    pub adhesion: Adhesion,
    /// Energy in the springs of friction and against rolling, J.
    pub spring_energy: f64,
    /// Normal stiffness, N/m.
    pub stiffness: f64,
    /// Stiffness of the friction springs, N/m.
    pub tangential_stiffness: f64,
}

impl Contact {
    /// Total force on B, N.
    pub fn force_on_b(&self) -> Vector3 {
        self.normal * self.normal_force + self.friction + self.adhesion.force
    }

    /// The force on B across and in the contact plane, with attraction: along `normal` (negative where it pulls) and the rest, N.
    pub fn parts(&self) -> (f64, Vector3) {
        let pull = self.adhesion.force;
        let along = self.normal.dot(&pull);
        let across = pull - self.normal * along;
        (self.normal_force + along, self.friction + across)
    }

    /// Elastic energy and that of the attraction, J.
    pub fn potential(&self) -> f64 {
        self.energy + self.adhesion.energy
    }

    /// Penetration estimate, m: overlap volume over contact area.
    pub fn penetration(&self) -> f64 {
        mean_penetration(self.volume, self.area)
    }

    /// Whether something is a side of the contact.
    pub fn has_side(&self, thing: Partner) -> bool {
        self.a == thing || Partner::Body(self.b) == thing
    }
}

impl From<&RigidContact> for Contact {
    fn from(rigid: &RigidContact) -> Self {
        Self {
            a: rigid.a,
            b: rigid.b,
            patch: rigid.patch,
            point: rigid.point,
            normal: rigid.normal,
            elastic_force: rigid.elastic_force,
            normal_force: rigid.normal_force,
            pressing: rigid.normal_force,
            rocking: rigid.rocking,
            rolling: rigid.rolling,
            friction: rigid.friction,
            slides: rigid.slides,
            area: rigid.area,
            volume: rigid.volume,
            energy: rigid.energy,
            adhesion: rigid.adhesion,
            spring_energy: rigid.spring_energy,
            stiffness: rigid.foundation.stiffness,
            tangential_stiffness: rigid.tangential_stiffness,
        }
    }
}
