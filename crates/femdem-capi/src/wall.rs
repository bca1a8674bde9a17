//! Walls, as batches and worlds take them.

use femdem_solve::contact::{MeshWall, Wall};
use femdem_solve::mesh::Vector3;

use crate::border::{Failure, list, points};
use crate::plain::{FemdemBox, FemdemPlane};

/// The numbers of the six walls of a box.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FemdemSides {
    /// The walls that bodies meet towards lower x, y and z.
    pub low: [u32; 3],
    /// Those towards higher x, y and z.
    pub high: [u32; 3],
}

impl FemdemSides {
    /// From the order in which a box has its walls: x-, x+, y-, y+, z-, z+.
    pub(crate) fn of(walls: &[u32]) -> Self {
        let side =
            |first: usize| [0, 2, 4].map(|k| walls.get(first + k).copied().unwrap_or_default());
        Self {
            low: side(0),
            high: side(1),
        }
    }
}

impl FemdemPlane {
    pub(crate) fn wall(&self) -> Result<Wall, Failure> {
        Ok(Wall::half_space("plane", self.normal.into(), self.offset)?)
    }
}

impl FemdemBox {
    pub(crate) fn walls(&self) -> Result<Vec<Wall>, Failure> {
        let [low, high] = [self.low, self.high].map(Vector3::from);
        Ok(Wall::closed_box(low, high)?)
    }
}

/// The triangles of a sheet, as the caller has them.
pub(crate) struct Sheet {
    pub vertices: *const f64,
    pub vertex_count: usize,
    pub triangles: *const u32,
    pub triangle_count: usize,
    pub thickness: f64,
}

impl Sheet {
    /// # Safety
    /// The pointers are as those of a function of the interface.
    pub unsafe fn wall(self) -> Result<MeshWall, Failure> {
        // SAFETY: as the caller promises.
        let vertices = unsafe { points("vertices", self.vertices, self.vertex_count)? };
        // SAFETY: rows of three numbers have the layout of the numbers; the rest the caller promises.
        let triangles = unsafe {
            let start = self.triangles.cast::<[u32; 3]>();
            list("triangles", start, self.triangle_count)?
        };
        let triangles = triangles.to_vec();
        Ok(MeshWall::sheet(
            "sheet",
            vertices,
            triangles,
            self.thickness,
        )?)
    }
}
