//! All tests of the public interface in one program, since each test file takes longer to link than to run.

mod adhesion;
mod batch;
mod bridges;
mod coincident;
mod common;
mod damping;
mod deform_batch;
mod deform_friction;
mod deform_gradient;
mod deform_itself;
mod deform_skins;
mod deform_walls;
mod densest_lattices;
mod friction;
mod general;
mod general_gradient;
mod general_skins;
mod general_sliding;
mod general_states;
mod general_walls;
mod glue;
mod gradient;
mod materials;
mod pair_properties;
mod patches;
mod periodic;
mod reach;
mod refusals;
mod sphere_batch;
mod sphere_meshes;
mod spheres;
mod springs;
#[cfg(feature = "proptest")]
mod strategies;
mod walls;
mod wild_motions;
