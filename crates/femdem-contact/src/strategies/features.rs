//! Vertices, edges and faces of a mesh's skin, as points with directions.

use femdem_mesh::{Matrix3, TetMesh, Vector3};

/// A point of the skin with the outward direction there and a direction along the skin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Feature {
    pub point: Vector3,
    pub outward: Vector3,
    pub along: Vector3,
}

impl Feature {
    /// Right-handed axes: outward, along, and across both.
    pub fn axes(&self) -> Matrix3 {
        let across = self.outward.cross(&self.along);
        Matrix3::from_columns(&[self.outward, self.along, across])
    }

    /// A feature with the directions made unit and at right angles.
    fn new(point: Vector3, outward: Vector3, along: Vector3) -> Self {
        let unit = |v: Vector3, other: Vector3| v.try_normalize(0.0).unwrap_or(other);
        let outward = unit(outward, Vector3::z());
        let along = along - outward * outward.dot(&along);
        let some = crate::axes::complete(&outward)[1];
        let along = unit(along, some);
        Self {
            point,
            outward,
            along,
        }
    }
}

/// The skin of a mesh.
pub(super) struct Skin<'a>(pub &'a TetMesh);

impl Skin<'_> {
    fn triangle(&self, pick: f64) -> [u32; 3] {
        let skin = self.0.skin();
        skin[((pick * skin.len() as f64) as usize).min(skin.len() - 1)]
    }

    fn point(&self, i: u32) -> Vector3 {
        self.0.points()[i as usize].coords
    }

    fn normal(&self, triangle: &[u32; 3]) -> Vector3 {
        let [a, b, c] = triangle.map(|i| self.point(i));
        let n = (b - a).cross(&(c - a));
        n.try_normalize(0.0).unwrap_or_default()
    }

    /// Sum of the normals of the triangles that contain all the given points.
    fn outward(&self, points: &[u32]) -> Vector3 {
        let triangles = self.0.skin().iter();
        triangles
            .filter(|t| points.iter().all(|p| t.contains(p)))
            .map(|t| self.normal(t))
            .sum()
    }

    /// A triangle of a face, at its middle; along one of its sides.
    pub fn face(&self, pick: f64) -> Feature {
        let t = self.triangle(pick);
        let [a, b, c] = t.map(|i| self.point(i));
        Feature::new((a + b + c) / 3.0, self.normal(&t), b - a)
    }

    /// An edge of a triangle, at its middle.
    pub fn edge(&self, pick: f64) -> Feature {
        let t = self.triangle(pick);
        let (a, b) = (self.point(t[0]), self.point(t[1]));
        Feature::new((a + b) * 0.5, self.outward(&t[..2]), b - a)
    }

    /// A vertex.
    pub fn vertex(&self, pick: f64) -> Feature {
        let t = self.triangle(pick);
        let (a, b) = (self.point(t[0]), self.point(t[1]));
        Feature::new(a, self.outward(&t[..1]), b - a)
    }
}
