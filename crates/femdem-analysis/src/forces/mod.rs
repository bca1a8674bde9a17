//! The forces: their distribution and the largest on each body.

mod distribution;
mod maxima;
mod tail;
mod walls;

pub use distribution::{ForceBin, ForceDistribution, ForceDistributionOptions, force_distribution};
pub use maxima::{ForceMaxima, force_maxima};
pub use tail::{TailFit, TailLaw, TailOptions, fit_tail};
pub use walls::{WallForce, WallForces, wall_forces};
