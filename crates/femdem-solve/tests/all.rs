//! All tests of the public interface in one program, since each test file takes longer to link than to run.

mod adaptive;
mod adhesion;
mod any_shape;
mod bond_ranks;
mod bond_worlds;
mod bonds;
mod bridges;
mod by_hand;
mod cell_ranks;
mod changes;
mod common;
mod crack_ranks;
mod deformable_world;
mod energy;
mod folding;
mod fracture;
mod host;
mod impacts;
mod implicit;
mod masonry;
mod materials;
#[path = "../../femdem-contact/tests/common/meshes.rs"]
#[expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
mod meshes;
mod motion;
mod periodic;
mod physics;
mod prescribed;
mod ranks;
mod refusals;
mod relaxation;
mod restart;
mod rolling;
mod sleeping;
mod sliding;
mod soft_cells;
mod soft_ranks;
mod spheres;
mod step_size;
mod turning;
