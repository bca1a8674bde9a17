//! A batch in periodic space.

use super::{ContactBatch, Snapshot};
use crate::body_shape::BodyShape;
use crate::contact::RigidContact;
use crate::error::{ContactError, check};
use crate::exact::ExactSum;
use crate::periodic::{EdgeLoad, Space};
use femdem_mesh::{Matrix3, PeriodicCell, Vector3};

/// Sine of the largest angle between a wall and an edge.
const ALONG: f64 = 1e-9;

impl ContactBatch {
    /// Makes space periodic, or changes the edges and their velocities, at any time between updates. Bodies keep their
    /// places: to deform what lies in the cell, a host moves them, too.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] if there are bodies and space does not repeat itself along the same axes already.
    pub fn set_cell(&mut self, cell: PeriodicCell) -> Result<(), ContactError> {
        match &mut self.space {
            Some(space) if (0..3).all(|k| space.cell.repeats(k) == cell.repeats(k)) => {
                space.change(cell);
            }
            _ => {
                let bodies = self.len() as f64;
                check(
                    "number of bodies for which space begins to repeat itself",
                    bodies,
                    bodies == 0.0,
                    "0: give the periodic axes before the bodies",
                )?;
                self.space = Some(Space::new(cell));
            }
        }
        Ok(())
    }

    /// The periodic cell, if there is one.
    pub fn cell(&self) -> Option<&PeriodicCell> {
        self.space.as_ref().map(|space| &space.cell)
    }

    /// Length of the path of each edge of the periodic cell so far, m.
    pub fn edge_paths(&self) -> [f64; 3] {
        self.space.as_ref().map_or([0.0; 3], |space| space.paths)
    }

    /// Forces over the edges of the periodic cell, from the contacts of the last update.
    pub fn edge_loads(&self) -> [EdgeLoad; 3] {
        let mut edges = self.sums.edges;
        if let Some(part) = &self.deformable {
            for (edge, load) in edges.iter_mut().zip(part.edges()) {
                edge.total += load.total;
                edge.damping += load.damping;
                edge.friction += load.friction;
            }
        }
        edges
    }

    /// Σ f lᵀ over the contacts of two bodies, J, with the force f on B without dashpots and the vector l from the centroid of A
    /// to that of B (of a deformable body the mean of its nodes). Over the volume of a periodic cell this is the mean stress, positive in compression (Love 1927, Weber 1966).
    pub fn virial(&self) -> Matrix3 {
        Matrix3::from_iterator(self.exact_virial().iter().map(ExactSum::value))
    }

    /// Refuses a cell too small for its bodies, and walls that do not repeat themselves.
    pub(super) fn check_space(&self, view: &Snapshot) -> Result<(), ContactError> {
        let Some(space @ Space { cell, .. }) = &self.space else {
            return Ok(());
        };
        let reach = |shape: &BodyShape| shape.radius() + self.broadphase.margin(shape);
        let radii = self.shapes.iter().map(reach);
        let largest = 2.0 * radii.fold(0.0, f64::max);
        let edges = cell.edges();
        space.check_fits(
            "side of a periodic cell over the diameter of the largest body, liquid bridge included",
            largest,
        )?;
        for (w, wall) in self.walls() {
            let repeats = |planes: &crate::walls::Wall| {
                planes.planes().iter().all(|plane| {
                    let normal = view.walls[w as usize].frame.rotation * plane.normal;
                    let along = |edge: Vector3| normal.dot(&edge).abs() <= ALONG * edge.norm();
                    edges.column_iter().all(|edge| along(edge.into_owned()))
                })
            };
            if !wall.planes().is_some_and(repeats) {
                return Err(ContactError::Wall {
                    name: wall.name().to_owned(),
                    why: "it does not repeat itself along the edges of the periodic cell: give planes along them, or \
                          another axis that is not periodic"
                        .to_owned(),
                });
            }
        }
        Ok(())
    }
}

impl RigidContact {
    /// From the centroid of A to that of B, m.
    fn branch(&self) -> Vector3 {
        self.arm_a - self.arm_b
    }

    /// f lᵀ with the force f on B without dashpots and the branch l, J.
    pub(super) fn moment_of_force(&self) -> Matrix3 {
        let elastic = self.normal * self.elastic_force + self.adhesion.force;
        (elastic + self.friction - self.drag) * self.branch().transpose()
    }

    /// Stiffness against a strain along an axis, J.
    pub(super) fn stiffness_along(&self, axis: usize) -> f64 {
        let along = self.normal[axis].powi(2);
        let stiffness =
            self.foundation.stiffness * along + self.tangential_stiffness * (1.0 - along);
        stiffness * self.branch()[axis].powi(2)
    }
}
