//! The kernel of spheres.

use super::patch::Patch;
use super::shape::Sphere;
use super::{convex, pair, wall};
use crate::adhesion::VectorArea;
use crate::error::{ContactError, check_pressure};
use crate::kernel::{Overlap, WALL_FACTOR};
use crate::shape::{ConvexShape, Frame};
use crate::walls::Wall;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// The penalty law of exact balls: U = p int (phi_A + phi_B) dV over the overlap, and 2 p int phi_B dV against a wall.
///
/// Forces are those of the [`PairKernel`](crate::PairKernel) for ever finer polyhedra. None of them turns a ball about
/// its centre. Nothing is cached: a pair of spheres, or a sphere and a plane, costs less than looking up what would be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SphereKernel {
    #[serde(deserialize_with = "crate::error::read_penalty")]
    penalty: f64,
}

impl SphereKernel {
    /// A kernel with penalty `p` in Pa.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] unless the penalty is between 1e-100 and 1e100 Pa.
    pub fn new(penalty: f64) -> Result<Self, ContactError> {
        check_pressure("penalty", penalty)?;
        Ok(Self::of(penalty))
    }

    /// With a penalty that was checked.
    pub(crate) fn of(penalty: f64) -> Self {
        Self { penalty }
    }

    /// The contact of two spheres, with the centre of B at `between` (m) from that of A. `None` if they do not overlap,
    /// or if there is no net force (one centred in the other).
    pub fn evaluate(&self, a: &Sphere, b: &Sphere, between: &Vector3) -> Option<Overlap> {
        pair::overlap(self.penalty, a.radius(), b.radius(), between)
    }

    /// The contact of a wall (A) with a sphere (B) centred at `centre`, m. `None` if they do not overlap, or if there is
    /// no net force (the sphere wholly inside the wall).
    pub fn evaluate_wall(
        &self,
        wall: &Wall,
        frame: &Frame,
        sphere: &Sphere,
        centre: &Vector3,
    ) -> Option<Overlap> {
        let (between, local) = place(frame, centre);
        let penalty = WALL_FACTOR * self.penalty;
        wall::patch(wall, &local, sphere.radius())?.overlap(penalty, &frame.rotation, &between)
    }

    /// The contact of a convex polyhedron (A) with a sphere (B) centred at `centre`, m. `None` as for two spheres.
    pub fn evaluate_convex(
        &self,
        body: &ConvexShape,
        frame: &Frame,
        sphere: &Sphere,
        centre: &Vector3,
    ) -> Option<Overlap> {
        let (between, local) = place(frame, centre);
        if convex::gap(body, &local, sphere.radius()).0 >= 0.0 {
            return None;
        }
        convex::patch(body, &local, sphere.radius()).overlap(
            self.penalty,
            &frame.rotation,
            &between,
        )
    }
}

/// The vector area of the sphere's skin in a wall or a convex polyhedron: no rotation of a ball changes the overlap.
pub(super) fn area_in(patch: &Patch, rotation: &Matrix3) -> VectorArea {
    VectorArea {
        area: -(rotation * patch.vector_area),
        moment: Vector3::zeros(),
    }
}

/// A point seen from a frame: in world axes and in its own.
pub(super) fn place(frame: &Frame, point: &Vector3) -> (Vector3, Vector3) {
    let between = point - frame.position;
    (between, frame.rotation.tr_mul(&between))
}
