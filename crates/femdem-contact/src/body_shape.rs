//! Shapes of rigid bodies, of either kind.

use crate::error::ContactError;
use crate::general::{Field, FieldMesh};
use crate::shape::{ConvexShape, Facet};
use crate::sphere::Sphere;
use femdem_mesh::{Matrix3, Point3, Polyhedron, TetMesh, Vector3};
use serde::{Deserialize, Serialize};
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

/// A shape of a batch. Pairs of convex polyhedra take the kernel of these, pairs with a mesh the general one, and
/// others with a sphere that of spheres.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyShape {
    /// A convex body with its gauge field.
    Convex(Arc<ConvexShape>),
    /// A ball with its gauge field.
    Sphere(Sphere),
    /// Any body, as tetrahedra with a field.
    Mesh(Arc<FieldMesh>),
}

/// Which of the kinds a shape is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Kind {
    Convex,
    Sphere,
    Mesh,
}

impl BodyShape {
    pub(crate) fn kind(&self) -> Kind {
        match self {
            Self::Convex(_) => Kind::Convex,
            Self::Sphere(_) => Kind::Sphere,
            Self::Mesh(_) => Kind::Mesh,
        }
    }

    /// The convex polyhedron, if it is one.
    pub fn convex(&self) -> Option<&ConvexShape> {
        match self {
            Self::Convex(shape) => Some(shape),
            Self::Sphere(_) | Self::Mesh(_) => None,
        }
    }

    /// The sphere, if it is one.
    pub fn sphere(&self) -> Option<&Sphere> {
        match self {
            Self::Sphere(shape) => Some(shape),
            Self::Convex(_) | Self::Mesh(_) => None,
        }
    }

    /// Its tetrahedra, made of a shape that has none.
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if a tetrahedron would be flat.
    pub(crate) fn tetrahedra(&self) -> Result<Arc<FieldMesh>, ContactError> {
        Ok(match self {
            Self::Convex(shape) => Arc::new(shape.fan()?),
            Self::Sphere(sphere) => Arc::new(sphere.stand_in()?),
            Self::Mesh(mesh) => Arc::clone(mesh),
        })
    }

    /// Whether it is a mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self, Self::Mesh(_))
    }

    /// Largest distance of a point from the centroid, m.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Convex(shape) => shape.radius(),
            Self::Sphere(sphere) => sphere.radius(),
            Self::Mesh(mesh) => mesh.radius(),
        }
    }

    /// The length scale of the field, m: see [`ConvexShape::inradius`] and
    /// [`FieldMesh::inradius`]; the radius of a sphere.
    pub fn inradius(&self) -> f64 {
        match self {
            Self::Convex(shape) => shape.inradius(),
            Self::Sphere(sphere) => sphere.radius(),
            Self::Mesh(mesh) => mesh.inradius(),
        }
    }

    /// Stiffness per unit penalty of a contact over the whole of the largest side against an
    /// equal body, m.
    pub fn face_stiffness(&self) -> f64 {
        match self {
            Self::Convex(shape) => shape.face_stiffness(),
            Self::Sphere(sphere) => sphere.face_stiffness(),
            Self::Mesh(mesh) => mesh.face_stiffness(),
        }
    }

    /// Vertices about the centroid, m; a sphere has none.
    pub fn vertices(&self) -> &[Vector3] {
        match self {
            Self::Convex(shape) => shape.vertices(),
            Self::Sphere(_) => &[],
            Self::Mesh(mesh) => mesh.vertices(),
        }
    }

    /// Largest n.x over the body, for a unit vector n in body axes, m.
    pub fn support(&self, direction: &Vector3) -> f64 {
        match self {
            Self::Convex(shape) => shape.support(direction),
            Self::Sphere(sphere) => sphere.radius(),
            Self::Mesh(mesh) => mesh.support(direction),
        }
    }

    /// The axis-aligned box about the origin under a rotation, as (lowest, highest) corner
    /// relative to the centroid, m.
    pub fn bounds(&self, rotation: &Matrix3) -> (Vector3, Vector3) {
        match self {
            Self::Convex(shape) => shape.bounds(rotation),
            Self::Sphere(sphere) => {
                let corner = Vector3::repeat(sphere.radius());
                (-corner, corner)
            }
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

impl From<Sphere> for BodyShape {
    fn from(sphere: Sphere) -> Self {
        Self::Sphere(sphere)
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
