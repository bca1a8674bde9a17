//! Free rotation of a rigid body by the DLM splitting.
//!
//! Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107, 5840 (1997): the drift is
//! five plane rotations about the principal axes 1, 2, 3, 2, 1. Each turns the body-frame
//! angular momentum and the orientation by the same rational angle, so no trigonometric
//! function is called, |L| is kept to round-off and the energy error does not drift.

use femdem_mesh::nalgebra::{Quaternion, Unit};
use femdem_mesh::{Rotation, Vector3};

/// Turns a free body by `dt`: `orientation` maps principal axes to the world, `momentum`
/// is the angular momentum in principal axes, `moments` the principal moments of inertia.
pub(crate) fn drift(
    orientation: &mut Rotation,
    momentum: &mut Vector3,
    moments: &Vector3,
    dt: f64,
) {
    if *momentum == Vector3::zeros() {
        return;
    }
    let mut q = orientation.into_inner();
    // A quarter of the angle per unit of momentum, over the whole of dt.
    let [x, y, z] = (*moments * 4.0).map(|m| dt / m).into();
    turn::<0>(&mut q, momentum, 0.5 * x);
    turn::<1>(&mut q, momentum, 0.5 * y);
    turn::<2>(&mut q, momentum, z);
    turn::<1>(&mut q, momentum, 0.5 * y);
    turn::<0>(&mut q, momentum, 0.5 * x);
    // One Newton step towards unit length.
    let norm2 = q.norm_squared();
    *orientation = Unit::new_unchecked(q * (0.5 * (3.0 - norm2)));
}

/// The plane rotation about one axis. `rate` is a quarter of the angle per unit of momentum about it. The
/// axis is a compile-time constant, so that all numbers stay in registers.
#[inline(always)]
fn turn<const AXIS: usize>(q: &mut Quaternion<f64>, momentum: &mut Vector3, rate: f64) {
    let (j, k) = ((AXIS + 1) % 3, (AXIS + 2) % 3);
    let t = rate * momentum[AXIS];
    let scale = 1.0 / (1.0 + t * t);
    // Cosine and sine of half the angle.
    let (c, s) = ((1.0 - t * t) * scale, 2.0 * t * scale);
    let [qi, qj, qk, w] = [q.coords[AXIS], q.coords[j], q.coords[k], q.coords.w];
    q.coords[AXIS] = c * qi + s * w;
    q.coords[j] = c * qj + s * qk;
    q.coords[k] = c * qk - s * qj;
    q.coords.w = c * w - s * qi;
    // The momentum, fixed in the world, rotates backwards in the body.
    let (cos, sin) = (c * c - s * s, 2.0 * c * s);
    let (lj, lk) = (momentum[j], momentum[k]);
    momentum[j] = cos * lj + sin * lk;
    momentum[k] = cos * lk - sin * lj;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn energy(l: &Vector3, moments: &Vector3) -> f64 {
        0.5 * l.component_div(moments).dot(l)
    }

    /// A box tumbling about its intermediate axis, the hard case: momentum in the world is conserved, energy
    /// has no trend.
    #[test]
    fn a_tumbling_box_keeps_momentum_and_energy() {
        let moments = Vector3::new(1.0, 2.0, 2.5);
        let mut l = Vector3::new(0.01, 2.0, 0.02);
        let mut q = Rotation::from_euler_angles(0.3, -0.2, 1.0);
        let world = q * l;
        let start = energy(&l, &moments);
        let mut worst: [f64; 2] = [0.0; 2];
        for worst in &mut worst {
            for _ in 0..20_000 {
                drift(&mut q, &mut l, &moments, 0.01);
                let off = (energy(&l, &moments) / start - 1.0).abs();
                *worst = worst.max(off);
            }
        }
        assert!((q * l - world).norm() < 1e-11 * world.norm());
        assert!((q.norm() - 1.0).abs() < 1e-14);
        assert!(worst[0] < 1e-5, "energy error {:e}", worst[0]);
        assert!(
            worst[1] < 1.05 * worst[0],
            "the energy error grows: {worst:?}"
        );
    }

    /// Symmetric top: the body's axis precesses about L with |L|/I_1, exactly.
    #[test]
    fn a_symmetric_top_precesses_at_the_known_rate() {
        let moments = Vector3::new(1.0, 1.0, 0.4);
        let tilt: f64 = 0.5;
        let size = 3.0;
        let mut l = Vector3::new(size * tilt.sin(), 0.0, size * tilt.cos());
        let mut q = Rotation::identity();
        let world = l / size;
        let axis_start = Vector3::z();
        let (steps, dt) = (4_000, 1e-3);
        for _ in 0..steps {
            drift(&mut q, &mut l, &moments, dt);
        }
        let angle = size / moments[0] * dt * f64::from(steps);
        let expected = Rotation::from_scaled_axis(world * angle) * axis_start;
        assert!((q * Vector3::z() - expected).norm() < 2e-5);
    }
}
