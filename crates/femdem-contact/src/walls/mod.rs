//! Rigid walls: half-spaces and convex cavities bounded by planes, and solids of any mesh.

mod cavity;
mod local;
mod mesh;

pub use cavity::{Wall, WallPlane};
pub(crate) use local::LocalSolid;
pub use mesh::MeshWall;

use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A wall of a batch, of either kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum WallShape {
    /// Everything outside the convex space that some planes bound.
    Planes(Wall),
    /// The space that a mesh fills.
    Mesh(MeshWall),
}

impl WallShape {
    /// The wall's name, as it appears in results.
    pub fn name(&self) -> &str {
        match self {
            Self::Planes(wall) => wall.name(),
            Self::Mesh(wall) => wall.name(),
        }
    }

    /// The wall of planes, if it is one.
    pub fn planes(&self) -> Option<&Wall> {
        match self {
            Self::Planes(wall) => Some(wall),
            Self::Mesh(_) => None,
        }
    }

    /// Whether it is a mesh.
    pub fn is_mesh(&self) -> bool {
        matches!(self, Self::Mesh(_))
    }

    /// A lower bound of the distance from a point in the wall's axes to the wall, m.
    pub fn clearance(&self, x: &Vector3) -> f64 {
        match self {
            Self::Planes(wall) => wall.clearance(x),
            Self::Mesh(wall) => wall.clearance(x),
        }
    }
}

impl From<Wall> for WallShape {
    fn from(wall: Wall) -> Self {
        Self::Planes(wall)
    }
}

impl From<MeshWall> for WallShape {
    fn from(wall: MeshWall) -> Self {
        Self::Mesh(wall)
    }
}
