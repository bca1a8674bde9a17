//! All tests of the public interface in one program: each by itself takes longer to link than to run.

mod analyse;
mod balance;
mod chain;
mod common;
mod contact_class;
mod pack_ranks;
mod part_files;
mod periodic_packs;
mod pores;
mod program;
mod refusals;
mod report;
mod resolve;
mod resume;
mod run;
mod run_ranks;
mod scene_adaptive;
mod scene_bonds;
mod scene_cases;
mod scene_cell;
mod scene_control;
mod scene_flow;
mod scene_fracture;
mod scene_keys;
mod scene_loads;
mod scene_pairs;
mod scene_physics;
mod scene_powder;
mod scene_rest;
mod scene_stages;
mod scene_statics;
mod scene_walls;
mod shapes;
mod sizes;
mod stresses;
mod surfaces;
#[path = "../../femdem-solve/tests/common/ranks.rs"]
#[expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]
mod threads;
