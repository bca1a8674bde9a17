//! All tests of the public interface in one program: each by itself takes longer to link than to run.

mod bed;
mod common;
mod coordination;
mod core_region;
mod cost;
mod cost_forces;
mod density;
mod density_map;
mod fields;
mod fragments;
mod inputs;
mod lattices;
mod mixing;
mod networks;
mod non_convex;
mod orientation;
mod periodic;
mod periodic_pore_surfaces;
mod periodic_pores;
mod pore_surfaces;
mod pores;
mod profiles;
mod radial;
mod regions;
mod stress;
mod tails;
#[cfg(feature = "parallel")]
mod threads_of_geometry;
mod tilt;
mod volumes;
mod voronoi;
