//! Exact spheres: contact with each other, with walls of planes, with convex polyhedra and with rigid solids of tetrahedra.

mod convex;
mod disc;
mod field;
mod kernel;
mod meeting;
mod pair;
mod patch;
mod rule;
mod shape;
mod sums;
mod tets;
mod wall;

pub use kernel::SphereKernel;
pub(crate) use meeting::{Meeting, SolidMeeting};
pub use shape::Sphere;
