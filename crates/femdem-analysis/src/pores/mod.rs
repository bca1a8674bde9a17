//! The void space of a pack: voxel image, distances, pore sizes, paths, and closed surfaces for flow codes.

mod distance;
mod facets;
mod grid;
mod image;
mod isosurface;
mod paths;
mod separation;
mod solids;
mod surface;
mod tetrahedra;
mod thickness;
mod tube;

pub use distance::signed_distance;
pub use facets::{FacetSurface, Treatment, facet_surface};
pub use grid::VoxelGrid;
pub use image::{OUTSIDE, VOID, VoxelCounts, VoxelImage, voxel_image};
pub use isosurface::{Bridge, void_surface};
pub use paths::{Paths, Tortuosity, paths};
pub use solids::{Sides, Solids};
pub use surface::{Surface, SurfaceCheck, SurfacePatch};
pub use thickness::{PoreBin, PoreSizes, local_thickness};
pub use tube::tube_surface;
