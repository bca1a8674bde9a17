//! The void space of a pack: voxel image, distances, pore sizes, paths, and closed surfaces for flow codes.
//!
//! [`Solids`] are the bodies, exact balls among them. [`voxel_image`] says what every voxel of a box or a cylinder
//! is; [`signed_distance`] measures to the surfaces of the bodies, exactly; [`local_thickness`] and [`PoreSizes`]
//! give pore diameters, [`paths`] the tortuosity. [`facet_surface`] takes bodies that touch apart on their own
//! facets, [`void_surface`] joins them by [`Bridge`]s on the voxels, [`tube_surface`] is the space around them, and
//! [`Surface::check`] shows whether a surface is closed. All of it also in [periodic space](crate::WithImages).

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

pub use distance::{deepest_void, images_reach, signed_distance};
pub use facets::{FacetSurface, Treatment, facet_surface, shrink_factor};
pub use grid::VoxelGrid;
pub use image::{OUTSIDE, VOID, VoxelCounts, VoxelImage, voxel_image};
pub use isosurface::{Bridge, surface_region, void_surface};
pub use paths::{Paths, Tortuosity, paths};
pub use solids::{Sides, Solids};
pub use surface::{Surface, SurfaceCheck, SurfacePatch};
pub use thickness::{PoreBin, PoreSizes, local_thickness};
pub use tube::{flow_region, tube_surface};
