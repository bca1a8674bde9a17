//! Mass, momentum and angular momentum of a body, whatever it is.

use super::super::{centroid, inertia};
use crate::body::Body;
use femdem_mesh::{Matrix3, Vector3};

/// What a body keeps when it becomes another kind.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept {
    /// kg.
    pub mass: f64,
    /// kg m/s.
    pub momentum: Vector3,
    /// About the origin, kg m^2/s.
    pub angular_momentum: Vector3,
}

impl Kept {
    pub fn of_body(body: &Body) -> Self {
        let momentum = body.velocity * body.mass;
        Self {
            mass: body.mass,
            momentum,
            angular_momentum: body.orientation * body.momentum + body.position.cross(&momentum),
        }
    }

    /// Velocities of the rigid motion of nodes with these masses (kg), which together are the mass, at these positions (m).
    /// `None` for nodes on a line.
    pub fn velocities(&self, positions: &[Vector3], masses: &[f64]) -> Option<Vec<Vector3>> {
        let Nodes { centre, inertia } = Nodes::of(positions, masses);
        let about = self.angular_momentum - centre.cross(&self.momentum);
        let turning = inertia.try_inverse()? * about;
        let velocity = self.momentum / self.mass;
        let of = |x: &Vector3| velocity + turning.cross(&(x - centre));
        Some(positions.iter().map(of).collect())
    }

    /// Kinetic energy of that motion, J: P²/(2 m) + L·J⁻¹ L/2.
    pub fn rigid_energy(&self, positions: &[Vector3], masses: &[f64]) -> Option<f64> {
        let Nodes { centre, inertia } = Nodes::of(positions, masses);
        let about = self.angular_momentum - centre.cross(&self.momentum);
        let turning = inertia.try_inverse()? * about;
        Some(0.5 * self.momentum.norm_squared() / self.mass + 0.5 * about.dot(&turning))
    }
}

/// Centre of mass (m) and moment of inertia about it (kg m^2) of masses at points.
struct Nodes {
    centre: Vector3,
    inertia: Matrix3,
}

impl Nodes {
    fn of(positions: &[Vector3], masses: &[f64]) -> Self {
        let centre = centroid(positions, masses);
        let inertia = inertia(positions, masses, &centre);
        Self { centre, inertia }
    }
}
