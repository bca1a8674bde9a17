//! Exact spheres: contact with each other, with walls of planes and with convex polyhedra.

mod convex;
mod disc;
mod kernel;
mod meeting;
mod pair;
mod patch;
mod rule;
mod shape;
mod sums;
mod wall;

pub use kernel::SphereKernel;
pub(crate) use meeting::Meeting;
pub use shape::Sphere;
