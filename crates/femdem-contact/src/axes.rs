//! Right-handed frames.

use femdem_mesh::Vector3;

/// Two unit vectors that complete `axis` to a right-handed frame, without branches on
/// nearly equal components (Duff et al. 2017).
pub(crate) fn complete(axis: &Vector3) -> [Vector3; 3] {
    let sign = 1.0_f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    [
        *axis,
        Vector3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        Vector3::new(b, sign + axis.y * axis.y * a, -axis.y),
    ]
}
