//! The general pair kernel: bodies of any shape, as tetrahedral meshes with a nodal field.

mod assemble;
mod cache;
mod cells;
mod kernel;
mod mesh;
mod patch;
mod piece;
mod pieces;
mod posed;
mod skin_path;
mod sums;
mod wall;

pub use cache::GeneralCache;
pub use kernel::{Form, GeneralKernel, GeneralScratch};
pub use mesh::{Field, FieldMesh};
pub use patch::Patch;
pub use skin_path::{SkinPath, SkinWrench};
pub use wall::SolidWall;
