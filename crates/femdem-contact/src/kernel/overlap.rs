//! What the pair kernel returns.

use crate::foundation::Foundation;
use femdem_mesh::Vector3;

/// The elastic contact of two bodies A and B (or of a wall A and a body B).
///
/// All vectors are in world axes. The wrench on B is `force` at the contact point with
/// the free moment `moment`; the wrench on A is the opposite about the same point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Force on B, N: minus the gradient of `energy` with respect to B's position.
    pub force: Vector3,
    /// Free moment on B about the contact point, N m.
    pub moment: Vector3,
    /// Contact point (centre of pressure) relative to A's origin, m.
    pub arm_a: Vector3,
    /// Contact point relative to B's origin, m.
    pub arm_b: Vector3,
    /// Unit normal, from A to B: the direction of `force`.
    pub normal: Vector3,
    /// Contact energy U, J.
    pub energy: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Contact area, m^2: the vector area of the overlap projected on the normal.
    pub area: f64,
    /// The stiffness of the patch.
    pub foundation: Foundation,
    /// Mean distance of the pressure from the contact point, m: the friction torque of
    /// a patch that spins is mu F times this radius.
    pub torsion_radius: f64,
}

impl Overlap {
    /// The same contact with A and B exchanged.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self {
            force: -self.force,
            moment: -self.moment,
            arm_a: self.arm_b,
            arm_b: self.arm_a,
            normal: -self.normal,
            ..*self
        }
    }

    /// Magnitude of the elastic normal force, N.
    pub fn force_magnitude(&self) -> f64 {
        self.force.dot(&self.normal)
    }

    /// Torque on B about its origin, N m.
    pub fn torque_b(&self) -> Vector3 {
        self.moment + self.arm_b.cross(&self.force)
    }

    /// Torque on A about its origin, N m.
    pub fn torque_a(&self) -> Vector3 {
        -(self.moment + self.arm_a.cross(&self.force))
    }

    /// Penetration estimate, m: overlap volume over contact area.
    pub fn penetration(&self) -> f64 {
        mean_penetration(self.volume, self.area)
    }
}

/// Mean depth of an overlap, m: its volume (m^3) over the area of the contact (m^2), 0 without an area.
pub fn mean_penetration(volume: f64, area: f64) -> f64 {
    if area > 0.0 { volume / area } else { 0.0 }
}
