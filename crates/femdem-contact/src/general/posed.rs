//! Tetrahedra in the axes and about the origin in which a pair is worked out.

use super::cells::{Cell, NONE};
use femdem_mesh::{Matrix3, Vector3};

/// A tetrahedron in local coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Posed {
    pub corners: [Vector3; 4],
    /// Outward unit normals, and n.x on the faces.
    pub normals: [Vector3; 4],
    pub offsets: [f64; 4],
    /// The field: level + gradient.x.
    pub gradient: Vector3,
    pub level: f64,
    pub low: Vector3,
    pub high: Vector3,
    /// Bit k: face k lies on the skin.
    pub skin: u8,
}

impl Posed {
    /// x -> rotation x + offset.
    pub fn new(cell: &Cell, rotation: &Matrix3, offset: &Vector3) -> Self {
        let normals = cell.normals.map(|n| rotation * n);
        let corners = cell.corners.map(|x| rotation * x + offset);
        Self::assemble(cell, corners, normals, rotation * cell.gradient)
    }

    /// x -> x + offset.
    pub fn shifted(cell: &Cell, offset: &Vector3) -> Self {
        let corners = cell.corners.map(|x| x + offset);
        Self::assemble(cell, corners, cell.normals, cell.gradient)
    }

    fn assemble(
        cell: &Cell,
        corners: [Vector3; 4],
        normals: [Vector3; 4],
        gradient: Vector3,
    ) -> Self {
        let [a, b, c, d] = &corners;
        let mut skin = 0;
        for (k, n) in cell.neighbours.iter().enumerate() {
            skin |= u8::from(*n == NONE) << k;
        }
        Self {
            offsets: [
                normals[0].dot(b),
                normals[1].dot(c),
                normals[2].dot(d),
                normals[3].dot(a),
            ],
            level: cell.level - gradient.dot(a),
            low: a.inf(b).inf(&c.inf(d)),
            high: a.sup(b).sup(&c.sup(d)),
            corners,
            normals,
            gradient,
            skin,
        }
    }

    /// Depth of a point under face k, m.
    #[inline]
    pub fn depth(&self, k: usize, x: &Vector3) -> f64 {
        self.offsets[k] - self.normals[k].dot(x)
    }

    /// Whether the boxes come within `margin` of each other.
    #[inline]
    pub fn is_near(&self, other: &Self, margin: f64) -> bool {
        (0..3)
            .all(|k| self.low[k] <= other.high[k] + margin && other.low[k] <= self.high[k] + margin)
    }

    /// Bits of the faces that have a corner of `other` outside; `None` if one of them has all of
    /// them farther outside than `margin`.
    #[inline]
    pub fn faces_across(&self, other: &Self, margin: f64) -> Option<u8> {
        let mut across = 0;
        for k in 0..4 {
            let mut least = f64::INFINITY;
            let mut most = f64::NEG_INFINITY;
            for x in &other.corners {
                let depth = self.depth(k, x);
                least = if depth < least { depth } else { least };
                most = if depth > most { depth } else { most };
            }
            if most <= -margin {
                return None;
            }
            across |= u8::from(least < 0.0) << k;
        }
        Some(across)
    }

    /// Largest extent of the box, m.
    #[inline]
    pub fn size(&self) -> f64 {
        (self.high - self.low).max()
    }
}
