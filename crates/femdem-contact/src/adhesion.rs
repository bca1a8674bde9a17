//! Attraction in a contact: the cohesion of a patch, and the adhesion and the [liquid bridges](crate::bridge) of round bodies.
//!
//! The cohesion c (Pa) has the energy -c V, V the volume of the overlap. The gradient of V is the vector area of the skin of one
//! body in the other ([`VectorArea`]), so that the attraction is the stress c over the area of the contact, exactly and with its
//! moment, for bodies of any shape; V and the area are continuous in the pose, and so is the energy where a contact begins or ends.
//!
//! The adhesion w (J/m^2) of a ball with a ball or a plane is the force 3/2 pi w R, R the reduced radius, as long as they
//! touch: the pull-off force of Johnson, Kendall and Roberts (1971), Proc. R. Soc. Lond. A 324, 301-313. Its energy is minus
//! the force times the depth.
//!
//! Both forces begin and end with a jump, a cohesive face with c A. One evaluation stands for a whole step, so the force of
//! the first one is weighted with the time since the touch, and that of the last one with the time that is left: the error
//! of the energy is of second order in the step. An evaluation outside of a step, as where a law changes, is at the end of the
//! last one, and its weights are those of that.

use crate::bridge::LiquidBridge;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// The vector area of the skin of a body B inside a body or wall A. With the volume V of their overlap it is dV/dx_B, and its
/// moment is the derivative by a rotation of B.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VectorArea {
    /// Integral of the outward normal of B, m^2: from B to A.
    pub area: Vector3,
    /// Integral of x cross n about the origin of B, m^3.
    pub moment: Vector3,
}

impl VectorArea {
    /// From sums about a point `arm` from B's origin in axes that `rotation` takes to the world's.
    pub(crate) fn of_sums(rotation: &Matrix3, arm: &Vector3, [area, moment]: [Vector3; 2]) -> Self {
        let area = rotation * area;
        Self {
            area,
            moment: rotation * moment + arm.cross(&area),
        }
    }
}

/// Attraction in a contact, of its side B.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Adhesion {
    /// Force on B, N.
    pub force: Vector3,
    /// Moment on B about the contact point, N m.
    pub moment: Vector3,
    /// Energy, J: 0 where the two begin to touch, negative where they overlap, positive where a liquid bridge is stretched.
    pub energy: f64,
}

impl Adhesion {
    /// The attraction of a force and a torque on B about its origin, for a contact point at `arm` from there (m).
    fn new(force: Vector3, torque: Vector3, arm: &Vector3, energy: f64) -> Self {
        Self {
            force,
            moment: torque - arm.cross(&force),
            energy,
        }
    }

    /// Of a cohesion (Pa) over an overlap of a volume (m^3), for a contact point at `arm` from B's origin (m).
    pub(crate) fn of_area(cohesion: f64, area: &VectorArea, volume: f64, arm: &Vector3) -> Self {
        let (force, torque) = (area.area * cohesion, area.moment * cohesion);
        Self::new(force, torque, arm, -cohesion * volume)
    }

    /// Of the adhesion (J/m^2) of two round sides, for a contact point at `arm` from B's origin (m).
    pub(crate) fn of_round(adhesion: f64, round: &Round, arm: &Vector3) -> Self {
        let pull = 1.5 * PI * adhesion * round.radius;
        let force = round.direction * -pull;
        Self::new(force, Vector3::zeros(), arm, -pull * round.depth)
    }

    /// Of a liquid bridge.
    pub(crate) fn of_bridge(bridge: &LiquidBridge, round: &Round, arm: &Vector3) -> Self {
        let (radius, gap) = (round.radius, -round.depth);
        let force = round.direction * -bridge.force(radius, gap);
        Self::new(force, Vector3::zeros(), arm, bridge.energy(radius, gap))
    }

    /// Whether there is none.
    pub(crate) fn is_none(&self) -> bool {
        self.force == Vector3::zeros()
    }

    /// The two together.
    pub(crate) fn and(&self, other: &Self) -> Self {
        Self {
            force: self.force + other.force,
            moment: self.moment + other.moment,
            energy: self.energy + other.energy,
        }
    }

    /// With a factor of its force.
    pub(crate) fn weighted(&self, by: f64) -> Self {
        Self {
            force: self.force * by,
            moment: self.moment * by,
            ..*self
        }
    }
}

/// Two balls, or a ball and a plane, that overlap or have a liquid bridge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Round {
    /// Reduced radius R_A R_B/(R_A + R_B), m; that of the ball at a plane.
    pub radius: f64,
    /// m; negative where they are apart.
    pub depth: f64,
    /// Unit vector from A to B; the line through both centres is along it.
    pub direction: Vector3,
}

/// Factor of a force that ends with a jump within the step (s) to come, where the contact has the depth `depth` (m) and opens
/// at `opening` (m/s); 1 if it does not end.
pub(crate) fn before_end(depth: f64, opening: f64, step: f64) -> f64 {
    let way = opening * step;
    if depth < way { 0.5 + depth / way } else { 1.0 }
}
