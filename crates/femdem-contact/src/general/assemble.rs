//! Conversion of the sums of a patch to its contact.

use super::sums::Sums;
use crate::foundation::{Foundation, FoundationSums};
use crate::kernel::Overlap;
use femdem_mesh::{Matrix3, Vector3};

/// Volumes below this times the cube of the body's size may be of faces that coincide.
const ROUND_OFF: f64 = 1e-11;

/// The energy as a function U(I, V) of I, the integral of the fields, and the overlap volume V: its value and
/// derivatives at the totals of a pair.
pub(crate) struct Energy {
    /// dU/dI and dU/dV.
    by_integral: f64,
    by_volume: f64,
    /// U of a patch per its part of I.
    share: f64,
    curvature: Option<Curvature>,
}

/// Second derivatives, and the gradients of the totals by which they are multiplied.
struct Curvature {
    integral2: f64,
    mixed: f64,
    volume2: f64,
    force: Vector3,
    area: Vector3,
}

impl Energy {
    /// U = p I.
    pub fn linear(penalty: f64) -> Self {
        Self {
            by_integral: penalty,
            by_volume: 0.0,
            share: penalty,
            curvature: None,
        }
    }

    /// U = E (factor I)^1.5 / V, with I the integral of h phi over the whole overlap.
    pub fn shaped(modulus: f64, factor: f64, total: &Sums) -> Self {
        let (i, v) = (total.energy, total.volume);
        let u = modulus * (factor * i).powf(1.5) / v;
        Self {
            by_integral: 1.5 * u / i,
            by_volume: -u / v,
            share: u / i,
            curvature: Some(Curvature {
                integral2: 0.75 * u / (i * i),
                mixed: -1.5 * u / (i * v),
                volume2: 2.0 * u / (v * v),
                force: total.force,
                area: total.area * 0.5,
            }),
        }
    }

    /// Contribution of the curvature of U(I, V) to the stiffness of the pair.
    fn stiffness(&self) -> f64 {
        self.curvature.as_ref().map_or(0.0, |c| {
            c.integral2 * c.force.norm_squared()
                + 2.0 * c.mixed * c.force.dot(&c.area)
                + c.volume2 * c.area.norm_squared()
        })
    }
}

/// The contact of a patch in world axes; `None` if there is no net force. The sums are in A's axes about
/// `origin`, and `between` points from A's origin to B's; `size` is the diameter of B.
pub(crate) fn assemble(
    sums: &Sums,
    energy: &Energy,
    origin: &Vector3,
    to_world: &Matrix3,
    between: &Vector3,
    size: f64,
) -> Option<Overlap> {
    let (di, dv) = (energy.by_integral, energy.by_volume);
    // The vector areas of both skins are equal up to sign and round-off.
    let area = sums.area * 0.5;
    let force = sums.force * di + area * dv;
    let torque = sums.torque * di + sums.area_torque * (0.5 * dv);
    let magnitude = force.norm();
    let pressed = sums.pressure > 0.0 && magnitude > 0.0 && magnitude.is_finite();
    if !pressed {
        return None;
    }
    let normal = force / magnitude;
    // Faces that coincide have a volume of round-off, and no area. (So has a body inside the other, but not such a
    // volume.)
    let area = normal.dot(&area).max(0.0);
    if sums.volume > area * size && sums.volume < ROUND_OFF * size.powi(3) {
        return None;
    }
    let centre = sums.pressure_moment / sums.pressure;
    let spread = sums.pressure_second / sums.pressure - centre.norm_squared();
    let arm_a = to_world * (origin + centre);
    let curved = energy.stiffness();
    let stiffness = (di * sums.stiffness.total + curved).max(0.0);
    // The curvature acts as if it were spread like the rest.
    let share = if sums.stiffness.total > 0.0 {
        stiffness / sums.stiffness.total
    } else {
        0.0
    };
    let foundation = FoundationSums {
        total: stiffness,
        first: sums.stiffness.first * share,
        second: sums.stiffness.second * share,
    };
    let foundation = Foundation::new(&foundation, &normal, &centre);
    Some(Overlap {
        force: to_world * force,
        moment: to_world * (torque - centre.cross(&force)),
        arm_a,
        arm_b: arm_a - between,
        normal: to_world * normal,
        energy: (energy.share * sums.energy).max(0.0),
        volume: sums.volume,
        area,
        torsion_radius: foundation.mean_over_rms() * spread.max(0.0).sqrt(),
        foundation: foundation.rotated(to_world),
    })
}
