//! Tetrahedra in their current shape, with shape functions, about the origin of a contact.

use super::shape::DeformableShape;
use crate::error::ContactError;
use crate::general::posed::{Posed, bounds, extent};
use crate::general::{FieldMesh, SolidWall};
use crate::shape::Frame;
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

/// A tetrahedron posed about the origin of a pair.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Current {
    pub corners: [Vector3; 4],
    /// The field at the corners, Pa: scaled by the pressure of the pair's law.
    pub values: [f64; 4],
    /// Its gradient, Pa/m.
    pub gradient: Vector3,
    /// Shape functions of the corners, `levels[k]` + `slopes[k]`.x.
    pub levels: [f64; 4],
    pub slopes: [Vector3; 4],
    /// m^3.
    pub six_volumes: f64,
    pub low: Vector3,
    pub high: Vector3,
    /// Largest extent of the box, m.
    pub size: f64,
    /// Bit k: the face opposite corner k lies on the skin.
    pub skin: u8,
}

/// Errors of posing a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Inverted {
    pub tet: u32,
}

/// Values of a rigid body's field at a corner below this fraction of its change across the tetrahedron are
/// set to zero.
const NO_FIELD: f64 = 1e-12;

impl Current {
    /// Sets this to the tetrahedron of `corners` with the given field; `false` if its volume is not positive.
    #[must_use]
    #[inline(always)]
    fn deform(
        &mut self,
        corners: [Vector3; 4],
        values: &[f64; 4],
        pressure: f64,
        skin: u8,
    ) -> bool {
        let [a, b, c, d] = &corners;
        let (ab, ac, ad) = (b - a, c - a, d - a);
        // Twice the area vectors, outwards; their sum is zero.
        let (of_b, of_c, of_d) = (ad.cross(&ac), ab.cross(&ad), ac.cross(&ab));
        let of_a = -(of_b + of_c + of_d);
        let six_volumes = -of_d.dot(&ad);
        if six_volumes.is_nan() || six_volumes <= 0.0 {
            return false;
        }
        let scale = -1.0 / six_volumes;
        self.slopes = [of_a * scale, of_b * scale, of_c * scale, of_d * scale];
        self.levels = [
            -self.slopes[0].dot(b),
            -self.slopes[1].dot(c),
            -self.slopes[2].dot(d),
            -self.slopes[3].dot(a),
        ];
        // The slopes add up to zero, so only differences of values enter.
        self.gradient = (self.slopes[1] * (values[1] - values[0])
            + self.slopes[2] * (values[2] - values[0])
            + self.slopes[3] * (values[3] - values[0]))
            * pressure;
        self.values = values.map(|v| v * pressure);
        self.six_volumes = six_volumes;
        [self.low, self.high] = bounds(&corners);
        self.size = extent(&self.low, &self.high);
        self.skin = skin;
        self.corners = corners;
        true
    }

    /// The corner with the largest value, which lies inside the body.
    #[inline(always)]
    pub fn pole(&self) -> usize {
        let larger = |i: usize, k: usize| {
            if self.values[k] > self.values[i] {
                k
            } else {
                i
            }
        };
        larger(larger(0, 1), larger(2, 3))
    }

    fn rigid(posed: &Posed, pressure: f64) -> Self {
        let [a, b, c, d] = &posed.corners;
        let mut current = Self {
            corners: posed.corners,
            gradient: posed.gradient * pressure,
            six_volumes: (b - a).cross(&(c - a)).dot(&(d - a)),
            low: posed.low,
            high: posed.high,
            size: posed.size,
            skin: posed.skin,
            ..Self::default()
        };
        let least = NO_FIELD * posed.gradient.norm() * posed.size;
        for (k, corner) in posed.corners.iter().enumerate() {
            // Such a remainder is round-off.
            let value = posed.level + posed.gradient.dot(corner);
            current.values[k] = if value > least { value * pressure } else { 0.0 };
            let inverse_height = 1.0 / posed.depth(k, corner);
            current.levels[k] = posed.offsets[k] * inverse_height;
            current.slopes[k] = posed.normals[k] * -inverse_height;
        }
        current
    }

    /// The same, with the planes of its faces.
    pub fn planes(&self) -> Posed {
        let normals = [0, 1, 2, 3].map(|k| self.normal(k));
        let [a, b, c, d] = &self.corners;
        Posed {
            corners: self.corners,
            offsets: [
                normals[0].dot(b),
                normals[1].dot(c),
                normals[2].dot(d),
                normals[3].dot(a),
            ],
            normals,
            gradient: self.gradient,
            level: self.values[0] - self.gradient.dot(a),
            low: self.low,
            high: self.high,
            size: self.size,
            skin: self.skin,
        }
    }

    /// The outward normal of a face.
    #[inline(always)]
    pub fn normal(&self, face: usize) -> Vector3 {
        self.slopes[face] * (-1.0 / self.slopes[face].norm())
    }

    /// Whether the boxes overlap.
    #[inline(always)]
    pub fn is_near(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
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
                *room = Current::rigid(&Posed::new(cell, &frame.rotation, &offset), pressure);
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
