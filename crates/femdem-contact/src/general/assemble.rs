//! Conversion of the sums of a patch to its contact.

use super::sums::Sums;
use crate::adhesion::VectorArea;
use crate::foundation::Foundation;
use crate::kernel::Overlap;
use femdem_mesh::{Matrix3, Vector3};

/// Volumes below this times the cube of the body's size may be of faces that coincide.
const ROUND_OFF: f64 = 1e-11;

/// The contact of a patch in world axes; `None` if there is no net force. The sums are in A's axes about
/// `origin`, and `between` points from A's origin to B's; `size` is the diameter of B.
pub(crate) fn assemble(
    sums: &Sums,
    penalty: f64,
    origin: &Vector3,
    to_world: &Matrix3,
    between: &Vector3,
    size: f64,
) -> Option<Overlap> {
    let force = sums.force * penalty;
    let torque = sums.torque * penalty;
    let magnitude = force.norm();
    let pressed = sums.pressure > 0.0 && magnitude > 0.0 && magnitude.is_finite();
    if !pressed {
        return None;
    }
    let normal = force / magnitude;
    // The vector areas of both skins are equal up to sign and round-off.
    // Faces that coincide have a volume of round-off, and no area. (So has a body inside the other, but not such a
    // volume.)
    let area = (0.5 * normal.dot(&(sums.areas[0] - sums.areas[1]))).max(0.0);
    if sums.volume > area * size && sums.volume < ROUND_OFF * size.powi(3) {
        return None;
    }
    let centre = sums.pressure_moment / sums.pressure;
    let spread = sums.pressure_second / sums.pressure - centre.norm_squared();
    let arm_a = to_world * (origin + centre);
    let foundation = Foundation::new(&(sums.stiffness * penalty), &normal, &centre);
    Some(Overlap {
        force: to_world * force,
        moment: to_world * (torque - centre.cross(&force)),
        arm_a,
        arm_b: arm_a - between,
        normal: to_world * normal,
        energy: (penalty * sums.energy).max(0.0),
        volume: sums.volume,
        area,
        torsion_radius: foundation.mean_over_rms() * spread.max(0.0).sqrt(),
        foundation: foundation.rotated(to_world),
    })
}

/// The vector area of B's skin in the same terms.
pub(crate) fn vector_area(
    sums: &Sums,
    origin: &Vector3,
    to_world: &Matrix3,
    between: &Vector3,
) -> VectorArea {
    let area = (sums.areas[1] - sums.areas[0]) * 0.5;
    let arm = to_world * origin - between;
    VectorArea::of_sums(to_world, &arm, [area, sums.area_moment])
}
