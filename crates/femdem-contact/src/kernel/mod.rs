//! Layer 1: the pair kernel. Two shapes, two frames, a penalty in; an [`Overlap`] out.

mod candidates;
mod cavity;
mod cells;
mod clip;
mod deep;
mod fast;
mod field;
#[cfg(test)]
mod oracle;
mod overlap;
mod pair;
mod plan;
mod plane;
mod polygon;
mod region;
mod separation;
mod side;
mod skin;
mod touching;
mod trail;

pub(crate) use cavity::WALL_FACTOR;
pub use cavity::{CavityCache, CavityKernel};
pub use overlap::{Overlap, mean_penetration};
pub use pair::{PairCache, PairKernel, Scratch};

pub(crate) use clip::{Clipper, Cut, Line, Point, Second, integrate};
