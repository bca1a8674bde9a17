//! The files that a run writes: tables, ParaView files, surfaces.
//!
//! | file | module | for |
//! |---|---|---|
//! | `bodies.csv`, `contacts.csv` | [`csv`] | spreadsheets and scripts |
//! | `pack.vtu` | [`vtu`] | ParaView: the bodies as polyhedra |
//! | `contacts.vtp` | [`vtp`] | ParaView: the contacts as points with forces |
//! | `cracks.vtp`, `fragments.csv`, `events.csv` | [`cracks`] | cracks and fragments |
//! | `analysis/density-map.vti` | [`vti`] | ParaView: local packing density |
//! | `labels.vti`, `fields.vti` | [`vti`] | ParaView: voxels of the void space |
//! | `labels.mhd`, `phases.mhd` and `.raw` | [`raw`] | Fiji, ITK, lattice Boltzmann codes: the same voxels |
//! | `bodies.stl`, `wall.stl`, ... | [`stl`] | meshers for flow: closed surfaces in named parts |
//! | `snappyHexMeshDict`, ... | [`openfoam`] | OpenFOAM: a mesh of the void, and the flow through it |
//! | `pack.stl`, `shape-<name>.obj` | [`surface`] | CFD meshing; one body alone |
//! | `*.pvd` | [`write_pvd`] | ParaView: files of a time series with their times |
//! | any VTK file | [`vtk`] | ParaView: data of one's own |
//!
//! Functions take a [`Snapshot`](crate::Snapshot) or a table and a writer, so that a host can write anywhere;
//! [`write_file`] writes the output of such a function to a file.

mod base64;
pub mod cracks;
pub mod csv;
mod file;
mod number;
pub mod openfoam;
mod pvd;
pub mod raw;
pub mod stl;
pub mod surface;
pub mod vti;
pub mod vtk;
pub mod vtp;
pub mod vtu;

pub(crate) use base64::base64;
pub use file::write_file;
pub use number::{counted, short_number};
pub use pvd::{write_pvd, write_pvd_parts};
