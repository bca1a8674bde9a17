//! Tetrahedra as they are now, with shape functions, about the middle of a contact.

use super::shape::DeformableShape;
use crate::error::ContactError;
use crate::general::posed::{Posed, bounds, extent};
use crate::general::{FieldMesh, SolidWall};
use crate::shape::Frame;
use femdem_mesh::Vector3;

/// One side of a pair as the kernel takes it.
#[derive(Debug, Clone, Copy)]
pub enum Operand<'a> {
    /// A body that deforms, and where its nodes are, m.
    Deformable(&'a DeformableShape, &'a [Vector3]),
    /// A rigid body, as tetrahedra with a field.
    Rigid(&'a FieldMesh, &'a Frame),
    /// A wall.
    Wall(&'a SolidWall, &'a Frame),
}

/// A tetrahedron posed about the origin of a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Current {
    /// Its field is in Pa: the pressure at which it counts is in it.
    pub posed: Posed,
    /// Shape functions of the corners, `levels[k]` + `slopes[k]`.x; 0 for rigid tetrahedra.
    pub levels: [f64; 4],
    pub slopes: [Vector3; 4],
}

/// What can be wrong with a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Inverted {
    pub tet: u32,
}

impl Current {
    /// Makes this a tetrahedron of `corners` with the given field; `false` if its volume is not positive.
    #[must_use]
    fn deform(
        &mut self,
        corners: [Vector3; 4],
        values: &[f64; 4],
        pressure: f64,
        skin: u8,
    ) -> bool {
        let [a, b, c, d] = &corners;
        let (ab, ac, ad) = (b - a, c - a, d - a);
        // Twice the area vectors, outwards; together they are zero.
        let (of_b, of_c, of_d) = (ad.cross(&ac), ab.cross(&ad), ac.cross(&ab));
        let of_a = -(of_b + of_c + of_d);
        let six_volumes = -of_d.dot(&ad);
        if six_volumes.is_nan() || six_volumes <= 0.0 {
            return false;
        }
        let scale = -1.0 / six_volumes;
        let slopes = [of_a * scale, of_b * scale, of_c * scale, of_d * scale];
        let unit = |s: &Vector3| s * (1.0 / s.norm());
        let normals = [unit(&of_a), unit(&of_b), unit(&of_c), unit(&of_d)];
        // The slopes add up to zero, so that only differences of values count.
        let gradient = (slopes[1] * (values[1] - values[0])
            + slopes[2] * (values[2] - values[0])
            + slopes[3] * (values[3] - values[0]))
            * pressure;
        let posed = &mut self.posed;
        posed.offsets = [
            normals[0].dot(b),
            normals[1].dot(c),
            normals[2].dot(d),
            normals[3].dot(a),
        ];
        posed.level = values[0] * pressure - gradient.dot(a);
        [posed.low, posed.high] = bounds(&corners);
        posed.size = extent(&posed.low, &posed.high);
        posed.gradient = gradient;
        posed.normals = normals;
        posed.skin = skin;
        self.levels = [
            -slopes[0].dot(b),
            -slopes[1].dot(c),
            -slopes[2].dot(d),
            -slopes[3].dot(a),
        ];
        self.slopes = slopes;
        posed.corners = corners;
        true
    }

    fn rigid(mut posed: Posed, pressure: f64) -> Self {
        posed.gradient *= pressure;
        posed.level *= pressure;
        Self {
            posed,
            levels: [0.0; 4],
            slopes: [Vector3::zeros(); 4],
        }
    }

    /// The shape functions at a point.
    #[inline]
    pub fn weights(&self, x: &Vector3) -> [f64; 4] {
        let [a, b, c, d] = &self.slopes;
        let levels = &self.levels;
        [
            levels[0] + a.dot(x),
            levels[1] + b.dot(x),
            levels[2] + c.dot(x),
            levels[3] + d.dot(x),
        ]
    }
}

impl Operand<'_> {
    /// Puts tetrahedron `i` about `origin`, its field in units of `pressure`, into `room`; `None` if there is
    /// none, an error if it is turned inside out.
    #[inline]
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
                *room = Current::rigid(Posed::new(cell, &frame.rotation, &offset), pressure);
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

    /// Checks that there is a finite place for every node.
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
