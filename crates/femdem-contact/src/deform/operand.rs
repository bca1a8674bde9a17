//! The sides of a pair, and their tetrahedra in their current shape.

use super::shape::DeformableShape;
use crate::error::ContactError;
use crate::general::{FieldMesh, SolidWall};
use crate::shape::Frame;
use crate::tets::current::Current;
use femdem_mesh::Vector3;

/// One side of a pair, as input of the kernel.
#[derive(Debug, Clone, Copy)]
pub enum Operand<'a> {
    /// A deformable body and the positions of its nodes, m.
    Deformable(&'a DeformableShape, &'a [Vector3]),
    /// A rigid body, as tetrahedra with a field.
    Rigid(&'a FieldMesh, &'a Frame),
    /// A wall.
    Wall(&'a SolidWall, &'a Frame),
}

/// Errors of posing a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Inverted {
    pub tet: u32,
}

impl Operand<'_> {
    /// Poses tetrahedron `i` about `origin`, with its field in units of `pressure`, in `room`; `None` if
    /// there is none, an error if it is inverted.
    #[inline(always)]
    pub(crate) fn pose(
        &self,
        i: u32,
        pressure: f64,
        origin: &Vector3,
        room: &mut Current,
    ) -> Result<Option<()>, Inverted> {
        match self {
            Self::Deformable(shape, x) => {
                let (Some(corners), Some(tet)) =
                    (shape.corners(i, x), shape.tets().get(i as usize))
                else {
                    return Ok(None);
                };
                let [a, b, c, d] = corners;
                let corners = [a - origin, b - origin, c - origin, d - origin];
                if room.deform(corners, &tet.values, pressure, tet.skin) {
                    Ok(Some(()))
                } else {
                    Err(Inverted { tet: i })
                }
            }
            Self::Rigid(FieldMesh { cells, .. }, frame)
            | Self::Wall(SolidWall { cells }, frame) => {
                let Some(cell) = cells.list.get(i as usize) else {
                    return Ok(None);
                };
                let offset = frame.position - origin;
                *room = cell.tet.placed(&frame.rotation, &offset, pressure);
                room.align();
                Ok(Some(()))
            }
        }
    }

    /// Length of the field, m; 0 for walls.
    pub(crate) fn length(&self) -> f64 {
        match self {
            Self::Deformable(shape, _) => shape.inradius(),
            Self::Rigid(mesh, _) => mesh.inradius(),
            Self::Wall(..) => 0.0,
        }
    }

    /// Checks that every node has a finite position.
    pub(crate) fn check(&self, body: usize) -> Result<(), ContactError> {
        let Self::Deformable(shape, x) = self else {
            return Ok(());
        };
        if x.len() != shape.node_count() {
            return Err(ContactError::NodeCount {
                body,
                given: x.len(),
                expected: shape.node_count(),
            });
        }
        match x.iter().position(|x| !x.iter().all(|x| x.is_finite())) {
            Some(node) => Err(ContactError::NodeState { body, node }),
            None => Ok(()),
        }
    }
}
