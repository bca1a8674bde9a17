//! External loads of rigid bodies.

use femdem_contact::Wrench;
use femdem_mesh::{Matrix3, Rotation, Vector3};
use serde::{Deserialize, Serialize};

/// The external load of a body: a part that keeps its directions, and parts that follow the body as it turns. A [`Wrench`] is a
/// load that does not follow.
///
/// ```
/// use femdem_contact::Wrench;
/// use femdem_mesh::Vector3;
/// use femdem_solve::AppliedLoad;
///
/// // A thruster of 2 N along the body's x axis, 0.5 m beside its centroid, and a weight of 3 N hung there.
/// let at = Vector3::y() * 0.5;
/// let thrust = AppliedLoad::turning(Vector3::x() * 2.0, at);
/// let weight = AppliedLoad::at_point(Vector3::z() * -3.0, at);
/// assert_eq!(thrust.turning.torque, Vector3::z() * -1.0);
/// let both = thrust + weight + Wrench::default().into();
/// assert_eq!(both.fixed.force, Vector3::z() * -3.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct AppliedLoad {
    /// Force, N, and torque about the centroid, N m, in world axes.
    pub fixed: Wrench,
    /// The same in the axes of the body's shape: they turn with it.
    pub turning: Wrench,
    /// Sum of r F^T over forces F in world axes, N, that act at points of the body; r is the arm from the centroid in the axes
    /// of its shape, m. The forces themselves are in `fixed`: this is their torque.
    pub arms: Matrix3,
}

impl AppliedLoad {
    /// A force in the axes of the shape, N, at a point `arm` from the centroid in the same axes, m. Both turn with the body.
    #[must_use]
    pub fn turning(force: Vector3, arm: Vector3) -> Self {
        Self {
            turning: Wrench {
                force,
                torque: arm.cross(&force),
            },
            ..Self::default()
        }
    }

    /// A force in world axes, N, at a point of the body, `arm` from the centroid in the axes of its shape, m.
    #[must_use]
    pub fn at_point(force: Vector3, arm: Vector3) -> Self {
        Self {
            fixed: Wrench {
                force,
                torque: Vector3::zeros(),
            },
            arms: arm * force.transpose(),
            ..Self::default()
        }
    }

    /// Whether a part of it turns with the body.
    #[must_use]
    pub fn follows(&self) -> bool {
        self.turning != Wrench::default() || self.arms != Matrix3::zeros()
    }

    /// The same with the following parts in other axes of the body, to which `rotation` leads from those of the shape.
    pub(crate) fn seen_from(&self, rotation: &Rotation) -> Self {
        Self {
            fixed: self.fixed,
            turning: Wrench {
                force: rotation * self.turning.force,
                torque: rotation * self.turning.torque,
            },
            arms: rotation.to_rotation_matrix() * self.arms,
        }
    }

    /// The wrench about the centroid in world axes, where `orientation` takes the axes of the following parts to the world's.
    pub(crate) fn wrench(&self, orientation: &Rotation) -> Wrench {
        if !self.follows() {
            return self.fixed;
        }
        let m = orientation.to_rotation_matrix() * self.arms;
        // sum (R r) x F
        let of_arms = Vector3::new(
            m[(1, 2)] - m[(2, 1)],
            m[(2, 0)] - m[(0, 2)],
            m[(0, 1)] - m[(1, 0)],
        );
        Wrench {
            force: self.fixed.force + orientation * self.turning.force,
            torque: self.fixed.torque + orientation * self.turning.torque + of_arms,
        }
    }

    /// Bounds of the force, N, and of the torque, N m, however the body turns.
    pub(crate) fn largest(&self) -> [f64; 2] {
        let Self {
            fixed,
            turning,
            arms,
        } = self;
        [
            fixed.force.norm() + turning.force.norm(),
            // Twice the antisymmetric part of a matrix is at most root 2 times as large as the matrix.
            fixed.torque.norm() + turning.torque.norm() + std::f64::consts::SQRT_2 * arms.norm(),
        ]
    }
}

impl From<Wrench> for AppliedLoad {
    fn from(fixed: Wrench) -> Self {
        Self {
            fixed,
            ..Self::default()
        }
    }
}

impl std::ops::Add for AppliedLoad {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self.fixed += &other.fixed;
        self.turning += &other.turning;
        self.arms += other.arms;
        self
    }
}

impl std::ops::Mul<f64> for AppliedLoad {
    type Output = Self;

    fn mul(self, by: f64) -> Self {
        let scaled = |w: &Wrench| Wrench {
            force: w.force * by,
            torque: w.torque * by,
        };
        Self {
            fixed: scaled(&self.fixed),
            turning: scaled(&self.turning),
            arms: self.arms * by,
        }
    }
}
