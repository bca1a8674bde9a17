//! Walls of any shape.

use crate::error::ContactError;
use crate::general::SolidWall;
use femdem_mesh::{Point3, TetMesh, Vector3};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A rigid wall that fills the space of a mesh. Cheap to clone.
///
/// The wall has no field: a body that overlaps it is pushed along the gradient of the body's own field. So
/// the wall must be thicker than the deepest overlap; a body that passes through it ends up outside.
///
/// ```
/// use femdem_contact::MeshWall;
/// use femdem_mesh::{TetMesh, Vector3};
///
/// // A step of stairs as a wall; bodies stay outside.
/// let step = MeshWall::solid("step", &TetMesh::block([1, 1, 1], &Vector3::new(0.3, 1.0, 0.2))?);
/// let (low, high) = step.bounds();
/// assert_eq!((low, high), (Vector3::zeros(), Vector3::new(0.3, 1.0, 0.2)));
/// assert_eq!(step.name(), "step");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "Source", into = "Source")]
pub struct MeshWall {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    source: Source,
    solid: SolidWall,
}

/// The data that a wall is built from and stored as.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Source {
    name: String,
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Kind {
    Solid(TetMesh),
    Sheet {
        points: Vec<Point3>,
        triangles: Vec<[u32; 3]>,
        thickness: f64,
    },
}

impl TryFrom<Source> for MeshWall {
    type Error = ContactError;

    fn try_from(source: Source) -> Result<Self, ContactError> {
        let solid = match &source.kind {
            Kind::Solid(mesh) => SolidWall::solid(mesh),
            Kind::Sheet {
                points,
                triangles,
                thickness,
            } => SolidWall::sheet(points, triangles, *thickness)?,
        };
        let inner = Arc::new(Inner { source, solid });
        Ok(Self { inner })
    }
}

impl From<MeshWall> for Source {
    fn from(wall: MeshWall) -> Self {
        wall.inner.source.clone()
    }
}

impl PartialEq for MeshWall {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.inner, &other.inner) || self.inner.source == other.inner.source
    }
}

impl MeshWall {
    /// A wall that fills the volume of a mesh, in the mesh's coordinates.
    pub fn solid(name: &str, mesh: &TetMesh) -> Self {
        let inner = Arc::new(Inner {
            solid: SolidWall::solid(mesh),
            source: Source {
                name: name.to_owned(),
                kind: Kind::Solid(mesh.clone()),
            },
        });
        Self { inner }
    }

    /// A wall of a given thickness (m) behind a sheet of triangles: bodies are on the side that
    /// the triangles' normals point to, and touch the sheet's own surface.
    ///
    /// # Errors
    /// [`ContactError::Wall`] if the sheet cannot be thickened.
    pub fn sheet(
        name: &str,
        points: Vec<Point3>,
        triangles: Vec<[u32; 3]>,
        thickness: f64,
    ) -> Result<Self, ContactError> {
        Self::try_from(Source {
            name: name.to_owned(),
            kind: Kind::Sheet {
                points,
                triangles,
                thickness,
            },
        })
    }

    /// The wall's name, as it appears in results.
    pub fn name(&self) -> &str {
        &self.inner.source.name
    }

    /// Its thickness, m: that of a sheet as given, and twice the volume over the surface of a solid.
    pub fn thickness(&self) -> f64 {
        match &self.inner.source.kind {
            Kind::Sheet { thickness, .. } => *thickness,
            Kind::Solid(mesh) => {
                let (points, skin) = self.surface();
                let area = |corners: &[u32; 3]| {
                    let [a, b, c] = corners.map(|i| points[i as usize]);
                    0.5 * (b - a).cross(&(c - a)).norm()
                };
                2.0 * mesh.volume() / skin.iter().map(area).sum::<f64>()
            }
        }
    }

    /// Its surface in its own axes: points \[m\], and triangles of their numbers; of a sheet the sheet alone.
    pub fn surface(&self) -> (&[Point3], &[[u32; 3]]) {
        match &self.inner.source.kind {
            Kind::Sheet {
                points, triangles, ..
            } => (points, triangles),
            Kind::Solid(mesh) => (mesh.points(), mesh.skin()),
        }
    }

    /// The axis-aligned box around the wall in its own axes, as (lowest, highest) corner, m.
    pub fn bounds(&self) -> (Vector3, Vector3) {
        self.inner.solid.bounds()
    }

    /// The wall as input of the general kernel.
    pub fn solid_wall(&self) -> &SolidWall {
        &self.inner.solid
    }

    /// Distance of a point in the wall's axes from the wall, m.
    pub(super) fn clearance(&self, x: &Vector3) -> f64 {
        self.inner.solid.cells.distance(x)
    }
}
