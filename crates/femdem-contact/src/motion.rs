//! The state of a body as the contact stage sees it.

use crate::error::{ContactError, check};
use crate::shape::Frame;
use femdem_mesh::{Matrix3, Pose, Vector3, unit_pose};
use serde::{Deserialize, Serialize};

/// Mass and inertia of a rigid body, from which a host makes its motions update by update.
///
/// ```
/// use femdem_contact::{Inertia, Motion};
/// use femdem_mesh::{Matrix3, Pose, Vector3};
///
/// let inertia = Inertia::new(2.0, &Matrix3::from_diagonal_element(0.003))?;
/// let mut motion = inertia.motion(&Pose::identity(), Vector3::x(), Vector3::zeros())?;
/// // A step later it is 1 mm farther, and so are its points, the farthest of which is 0.09 m from the centroid.
/// let next = inertia.motion(&Pose::translation(1e-3, 0.0, 0.0), Vector3::x(), Vector3::zeros())?;
/// let travelled = motion.travelled + next.way_from(&motion, 0.09);
/// motion = Motion { travelled, ..next };
/// assert_eq!(motion.travelled, 1e-3);
/// # Ok::<(), femdem_contact::ContactError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Inertia {
    inverse_mass: f64,
    /// Principal axes in those of the body.
    axes: Matrix3,
    /// 1/I about them, 1/(kg m^2).
    inverse: Vector3,
}

impl Inertia {
    /// A mass (kg), and the inertia about the centroid in the body's axes (kg m^2).
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the mass is positive, the inertia symmetric (to 1e-9) and positive definite, and
    /// every number and the inverses finite.
    pub fn new(mass: f64, inertia: &Matrix3) -> Result<Self, ContactError> {
        let inverse_mass = 1.0 / mass;
        let allowed = "positive, and finite as 1/mass is, in kg";
        check(
            "mass",
            mass,
            mass > 0.0 && inverse_mass.is_finite(),
            allowed,
        )?;
        let skew = (inertia - inertia.transpose()).norm();
        let allowed = "the size of the difference to its transpose, at most 1e-9 of it";
        check("inertia", skew, skew <= 1e-9 * inertia.norm(), allowed)?;
        let principal = inertia.symmetric_eigen();
        let inverse = principal.eigenvalues.map(|moment| 1.0 / moment);
        let least = principal.eigenvalues.min();
        let allowed = "positive in its least moment, and finite as its inverse is, in kg m^2";
        check(
            "inertia",
            least,
            least > 0.0 && inverse.max().is_finite(),
            allowed,
        )?;
        Ok(Self {
            inverse_mass,
            axes: principal.eigenvectors,
            inverse,
        })
    }

    /// The body where `pose` maps its axes, about its centroid, to the world; `velocity` (m/s) and `angular_velocity` (rad/s)
    /// are in world axes. It has not travelled yet.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the quaternion is of unit length (to 1e-6) and every number finite.
    pub fn motion(
        &self,
        pose: &Pose,
        velocity: Vector3,
        angular_velocity: Vector3,
    ) -> Result<Motion, ContactError> {
        let pose = unit_pose(pose).ok_or(ContactError::Parameter {
            name: "pose",
            value: pose.rotation.coords.norm() + pose.translation.vector.norm(),
            allowed: "finite, with a quaternion of length 1 to 1e-6",
        })?;
        let speed = velocity.norm() + angular_velocity.norm();
        check("velocity", speed, true, "finite in every component")?;
        let frame = Frame::from(&pose);
        let axes = frame.rotation * self.axes;
        Ok(Motion {
            frame,
            velocity,
            angular_velocity,
            inverse_mass: self.inverse_mass,
            inverse_inertia: axes * Matrix3::from_diagonal(&self.inverse) * axes.transpose(),
            inverse_inertia_max: self.inverse.max(),
            travelled: 0.0,
        })
    }
}

/// Frame, velocities and inertia of one body. Walls and driven bodies have zero inverse
/// mass and inertia.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Body to world; the origin is the centroid.
    pub frame: Frame,
    /// Velocity of the origin, m/s.
    pub velocity: Vector3,
    /// Angular velocity, world axes, rad/s.
    pub angular_velocity: Vector3,
    /// 1/m, 1/kg.
    pub inverse_mass: f64,
    /// Inverse inertia tensor in world axes, 1/(kg m^2).
    pub inverse_inertia: Matrix3,
    /// Largest eigenvalue of `inverse_inertia`, 1/(kg m^2).
    pub inverse_inertia_max: f64,
    /// Upper bound of the path length of any point of the body so far, m.
    pub travelled: f64,
}

impl Motion {
    /// A body at rest with zero inverse mass and inertia.
    pub fn fixed(frame: Frame) -> Self {
        Self {
            frame,
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            inverse_mass: 0.0,
            inverse_inertia: Matrix3::zeros(),
            inverse_inertia_max: 0.0,
            travelled: 0.0,
        }
    }

    /// A body that contacts move: `pose` maps its axes, about its centroid, to the world; `velocity` (m/s) and
    /// `angular_velocity` (rad/s) are in world axes, `mass` in kg, and `inertia` (kg m^2) about the centroid in the
    /// body's axes. It has not travelled yet: a host adds the path of its farthest point to [`travelled`](Self::travelled).
    ///
    /// ```
    /// use femdem_contact::Motion;
    /// use femdem_mesh::{Matrix3, Pose, Vector3, unit_pose};
    ///
    /// // A cube of 2 kg and side 0.1 m, half a metre up.
    /// let inertia = Matrix3::identity() * (2.0 * 0.1 * 0.1 / 6.0);
    /// let at = Pose::translation(0.0, 0.0, 0.5);
    /// let motion = Motion::rigid(&at, Vector3::zeros(), Vector3::x(), 2.0, &inertia)?;
    /// assert!((motion.inverse_inertia_max - 300.0).abs() < 1e-9);
    /// # Ok::<(), femdem_contact::ContactError>(())
    /// ```
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the mass is positive, the inertia symmetric (to 1e-9) and positive
    /// definite, the quaternion of unit length (to 1e-6), and every number and the inverses finite.
    pub fn rigid(
        pose: &Pose,
        velocity: Vector3,
        angular_velocity: Vector3,
        mass: f64,
        inertia: &Matrix3,
    ) -> Result<Self, ContactError> {
        Inertia::new(mass, inertia)?.motion(pose, velocity, angular_velocity)
    }

    /// How far a point of the body, at most `radius` (m) from its origin, can be from where it was in an earlier motion, m.
    pub fn way_from(&self, earlier: &Self, radius: f64) -> f64 {
        let (now, then) = (&self.frame, &earlier.frame);
        // The chord of a turn is the norm of the difference of the matrices over the square root of 2.
        let turn = (now.rotation - then.rotation).norm() * std::f64::consts::FRAC_1_SQRT_2;
        (now.position - then.position).norm() + turn * radius
    }

    /// Velocity of the body's point at `arm` from its origin, m/s.
    #[inline]
    pub fn velocity_at(&self, arm: &Vector3) -> Vector3 {
        self.velocity + self.angular_velocity.cross(arm)
    }

    /// Largest inverse mass against a unit force in any direction at `arm`, 1/kg.
    #[inline]
    pub fn inverse_mass_at(&self, arm: &Vector3) -> f64 {
        self.inverse_mass + self.inverse_inertia_max * arm.norm_squared()
    }

    /// Whether every number is finite, and none of the inverse masses negative.
    pub(crate) fn is_sound(&self) -> bool {
        let all = |v: &Vector3| v.iter().all(|x| x.is_finite());
        let inverse = |x: f64| x >= 0.0 && x.is_finite();
        all(&self.frame.position)
            && all(&self.velocity)
            && all(&self.angular_velocity)
            && self.frame.rotation.iter().all(|x| x.is_finite())
            && inverse(self.inverse_mass)
            && inverse(self.inverse_inertia_max)
            && self.inverse_inertia.iter().all(|x| x.is_finite())
            && self.travelled.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::Rotation;
    use femdem_mesh::nalgebra::Translation3;

    fn inertia() -> Matrix3 {
        Matrix3::new(3.0, 0.2, 0.1, 0.2, 2.0, 0.3, 0.1, 0.3, 4.0)
    }

    fn pose() -> Pose {
        let turn = Rotation::from_scaled_axis(Vector3::new(0.3, -1.1, 0.6));
        Pose::from_parts(Translation3::new(1.0, 2.0, 3.0), turn)
    }

    /// A torque turns the body as Newton's second law in its own axes says.
    #[test]
    fn a_rigid_body_has_its_inertia_in_its_axes() {
        let zero = Vector3::zeros();
        let motion = Motion::rigid(&pose(), zero, zero, 2.0, &inertia()).unwrap();
        let torque = Vector3::new(0.7, -0.4, 1.9);
        let in_body = pose().inverse_transform_vector(&torque);
        let turning = pose() * (inertia().try_inverse().unwrap() * in_body);
        assert!((motion.inverse_inertia * torque - turning).norm() < 1e-14);
        assert_eq!(motion.inverse_mass, 0.5);
        let most = (0..500).map(|k| {
            let t = f64::from(k);
            let axis = Vector3::new((1.3 * t).sin(), (2.1 * t).cos(), (0.7 * t).sin()).normalize();
            axis.dot(&(motion.inverse_inertia * axis))
        });
        let most = most.fold(0.0, f64::max);
        assert!((0.98..=1.0).contains(&(most / motion.inverse_inertia_max)));
    }

    /// The bound holds for points of a ball, and one of them reaches it: that which moves and turns the same way.
    #[test]
    fn the_way_is_that_of_the_farthest_point() {
        let (zero, radius) = (Vector3::zeros(), 0.7);
        let of = Inertia::new(2.0, &inertia()).unwrap();
        let before = of.motion(&pose(), zero, zero).unwrap();
        for angle in [1e-9, 1e-3, 2.0, 3.1] {
            let turn = Rotation::from_scaled_axis(Vector3::z() * angle);
            let turned = Pose::from_parts(pose().translation, turn * pose().rotation);
            let moved = Pose::translation(0.0, 0.04, 0.0) * turned;
            let after = of.motion(&moved, zero, zero).unwrap();
            let way = after.way_from(&before, radius);
            let moves = |t: f64| {
                let x = Vector3::new(t.cos(), t.sin(), 0.0) * radius;
                let own = before.frame.rotation.tr_mul(&x);
                (after.frame.point(&own) - before.frame.point(&own)).norm()
            };
            let most = (0..1000).map(|k| moves(f64::from(k) * 2e-3 * std::f64::consts::PI));
            let most = most.fold(0.0, f64::max);
            assert!((0.9999..=1.0 + 1e-12).contains(&(most / way)), "{angle}");
        }
    }

    #[test]
    fn bodies_that_cannot_be_are_refused_by_name() {
        let zero = Vector3::zeros();
        let refused = |mass: f64, inertia: Matrix3, velocity: Vector3, pose: Pose| {
            let result = Motion::rigid(&pose, velocity, zero, mass, &inertia);
            result.unwrap_err().to_string()
        };
        let mut skew = inertia();
        skew.m12 += 0.1;
        let far = Pose::translation(f64::NAN, 0.0, 0.0);
        for (message, name) in [
            (refused(0.0, inertia(), zero, pose()), "mass"),
            (refused(f64::INFINITY, inertia(), zero, pose()), "mass"),
            (refused(1e-310, inertia(), zero, pose()), "mass"),
            (refused(1.0, inertia() * 1e-310, zero, pose()), "inertia"),
            (refused(1.0, skew, zero, pose()), "inertia"),
            (refused(1.0, Matrix3::zeros(), zero, pose()), "inertia"),
            (refused(1.0, inertia() * f64::NAN, zero, pose()), "inertia"),
            (refused(1.0, -inertia(), zero, pose()), "inertia"),
            (
                refused(1.0, inertia(), zero.add_scalar(f64::NAN), pose()),
                "velocity",
            ),
            (refused(1.0, inertia(), zero, far), "pose"),
        ] {
            assert!(message.contains(name), "{message}");
        }
    }
}
