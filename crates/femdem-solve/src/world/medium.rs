//! Resistance of the medium.

use femdem_mesh::Vector3;

/// Cundall's local damping of a force, component by component.
pub(super) fn resist(force: &Vector3, velocity: &Vector3, fraction: f64) -> Vector3 {
    force.zip_map(velocity, |f, v| {
        if v == 0.0 {
            f
        } else {
            f - fraction * f.abs() * v.signum()
        }
    })
}

/// exp(-a h) and (1 - exp(-a h))/a.
pub(super) fn relaxation(rate: f64, h: f64) -> (f64, f64) {
    if rate == 0.0 {
        (1.0, h)
    } else {
        ((-rate * h).exp(), -(-rate * h).exp_m1() / rate)
    }
}
