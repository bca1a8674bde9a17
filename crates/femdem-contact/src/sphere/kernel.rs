//! The kernel of spheres.

use super::shape::Sphere;
use super::{convex, pair, patch, tets, wall};
use crate::adhesion::VectorArea;
use crate::error::{ContactError, check_pressure};
use crate::general::{FieldMesh, Patch, SolidWall};
use crate::kernel::{Overlap, WALL_FACTOR};
use crate::shape::{ConvexShape, Frame};
use crate::tets::cells::Cells;
use crate::walls::Wall;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// The penalty law of exact balls: U = p int (phi_A + phi_B) dV over the overlap, and 2 p int phi_B dV against a wall.
///
/// Forces are those of the [`PairKernel`](crate::PairKernel) for ever finer polyhedra. None of them turns a ball about
/// its centre. Nothing is cached: a pair of spheres, or a sphere and a plane, costs less than looking up what would be.
/// Solids of tetrahedra ([`SolidWall`], [`FieldMesh`]) may touch a ball in several patches.
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

    /// The contact of a wall of tetrahedra (A) with a sphere (B) centred at `centre`, m: one patch for each connected
    /// part of the overlap that presses.
    pub fn evaluate_solid_wall(
        &self,
        wall: &SolidWall,
        frame: &Frame,
        sphere: &Sphere,
        centre: &Vector3,
    ) -> Vec<Patch> {
        let penalty = WALL_FACTOR * self.penalty;
        evaluate_tets(penalty, (&wall.cells, false), frame, sphere, centre)
    }

    /// The contact of a body of tetrahedra (A) with a sphere (B) centred at `centre`, m: one patch for each connected
    /// part of the overlap that presses.
    pub fn evaluate_mesh(
        &self,
        body: &FieldMesh,
        frame: &Frame,
        sphere: &Sphere,
        centre: &Vector3,
    ) -> Vec<Patch> {
        evaluate_tets(self.penalty, (&body.cells, true), frame, sphere, centre)
    }
}

/// The patches of a ball with a solid, which has a field or none.
fn evaluate_tets(
    penalty: f64,
    (cells, has_field): (&Cells, bool),
    frame: &Frame,
    sphere: &Sphere,
    centre: &Vector3,
) -> Vec<Patch> {
    let (between, local) = place(frame, centre);
    let parts = tets::parts(cells, has_field, &local, sphere.radius());
    let patch = |part: &tets::Part| {
        let overlap = part.patch.overlap(penalty, &frame.rotation, &between)?;
        Some(Patch {
            overlap,
            key: [part.key, 0],
            touching: area_in(&part.patch, &frame.rotation),
        })
    };
    parts.iter().filter_map(patch).collect()
}

/// The vector area of the sphere's skin in a wall or a convex polyhedron: no rotation of a ball changes the overlap.
pub(super) fn area_in(patch: &patch::Patch, rotation: &Matrix3) -> VectorArea {
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
