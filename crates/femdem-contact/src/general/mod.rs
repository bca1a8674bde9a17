//! The general pair kernel: bodies of any shape, as tetrahedral meshes with a nodal field.

mod cache;
mod cells;
mod kernel;
mod mesh;
mod patch;
mod wall;

pub use cache::GeneralCache;
pub use kernel::{Form, GeneralKernel, GeneralScratch};
pub use mesh::{Field, FieldMesh};
pub use patch::Patch;
pub use wall::SolidWall;
