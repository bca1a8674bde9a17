//! Rigid walls given as solids of tetrahedra, without a field.

use super::cells::Cells;
use crate::error::ContactError;
use femdem_mesh::{Point3, TetMesh, Vector3};

/// A rigid wall of any shape: the space that its tetrahedra fill is solid.
#[derive(Debug, Clone, PartialEq)]
pub struct SolidWall {
    pub(crate) cells: Cells,
}

impl SolidWall {
    /// A wall that fills the volume of a mesh, in the mesh's coordinates.
    pub fn solid(mesh: &TetMesh) -> Self {
        let values = vec![0.0; mesh.points().len()];
        Self {
            cells: Cells::new(mesh, &Vector3::zeros(), &values),
        }
    }

    /// A wall of a given thickness (m) behind an open or closed sheet of triangles: bodies are on
    /// the side that the triangles' normals point to, and the sheet's own surface is what they
    /// touch.
    ///
    /// # Errors
    /// [`ContactError::Wall`] if the sheet cannot be thickened.
    pub fn sheet(
        points: &[Point3],
        triangles: &[[u32; 3]],
        thickness: f64,
    ) -> Result<Self, ContactError> {
        let _ = (points, triangles, thickness);
        Err(ContactError::Wall {
            name: "sheet".to_owned(),
            why: "not yet".to_owned(),
        })
    }

    /// The axis-aligned box around the wall in its own axes, as (lowest, highest) corner, m.
    pub fn bounds(&self) -> (Vector3, Vector3) {
        let b = self.cells.tree.bounds();
        (b.low.coords, b.high.coords)
    }
}
