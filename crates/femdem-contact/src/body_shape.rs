//! Shapes of rigid bodies, of either kind.

use crate::error::ContactError;
use crate::general::{Field, FieldMesh};
use crate::shape::{ConvexShape, Facet};
use femdem_mesh::{Matrix3, Point3, Polyhedron, TetMesh, Vector3};
use std::sync::Arc;

impl ConvexShape {
    /// The body as tetrahedra about its centroid with the same field, for contact with meshed
    /// bodies.
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if a tetrahedron would be flat.
    pub fn fan(&self) -> Result<FieldMesh, ContactError> {
        let vertices = self.vertices.iter().map(|v| Point3::from(*v)).collect();
        let face = |f: &Facet| {
            let start = f.start as usize;
            let own = &self.loops[start..start + usize::from(f.len)];
            own.iter().map(|&v| u32::from(v)).collect()
        };
        let faces = self.facets.iter().map(face).collect();
        let mesh = TetMesh::centroid_fan(&Polyhedron::new(vertices, faces)?)?;
        FieldMesh::new(&mesh, Vector3::zeros(), Field::Gauge)
    }
}

/// A shape of a batch, of either kind. Pairs of convex bodies take the convex kernel, pairs with
/// a mesh the general one.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyShape {
    /// A convex body with its gauge field.
    Convex(Arc<ConvexShape>),
    /// Any body, as tetrahedra with a field.
    Mesh(Arc<FieldMesh>),
}

impl BodyShape {
    /// The convex body, if it is one.
    pub fn convex(&self) -> Option<&ConvexShape> {
        match self {
            Self::Convex(shape) => Some(shape),
            Self::Mesh(_) => None,
        }
    }

    /// Whether it is a mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self, Self::Mesh(_))
    }

    /// Largest distance of a vertex from the centroid, m.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Convex(shape) => shape.radius(),
            Self::Mesh(mesh) => mesh.radius(),
        }
    }

    /// The length scale of the field, m: see [`ConvexShape::inradius`] and
    /// [`FieldMesh::inradius`].
    pub fn inradius(&self) -> f64 {
        match self {
            Self::Convex(shape) => shape.inradius(),
            Self::Mesh(mesh) => mesh.inradius(),
        }
    }

    /// Stiffness per unit penalty of a contact over the whole of the largest side against an
    /// equal body, m.
    pub fn face_stiffness(&self) -> f64 {
        match self {
            Self::Convex(shape) => shape.face_stiffness(),
            Self::Mesh(mesh) => mesh.face_stiffness(),
        }
    }

    /// Vertices about the centroid, m.
    pub fn vertices(&self) -> &[Vector3] {
        match self {
            Self::Convex(shape) => shape.vertices(),
            Self::Mesh(mesh) => mesh.vertices(),
        }
    }

    /// The axis-aligned box about the origin under a rotation, as (lowest, highest) corner
    /// relative to the centroid, m.
    pub fn bounds(&self, rotation: &Matrix3) -> (Vector3, Vector3) {
        match self {
            Self::Convex(shape) => shape.bounds(rotation),
            Self::Mesh(mesh) => mesh.bounds(rotation),
        }
    }
}

impl From<Arc<ConvexShape>> for BodyShape {
    fn from(shape: Arc<ConvexShape>) -> Self {
        Self::Convex(shape)
    }
}

impl From<ConvexShape> for BodyShape {
    fn from(shape: ConvexShape) -> Self {
        Self::Convex(Arc::new(shape))
    }
}

impl From<Arc<FieldMesh>> for BodyShape {
    fn from(mesh: Arc<FieldMesh>) -> Self {
        Self::Mesh(mesh)
    }
}

impl From<FieldMesh> for BodyShape {
    fn from(mesh: FieldMesh) -> Self {
        Self::Mesh(Arc::new(mesh))
    }
}
