//! femdem-solve.

mod body;
pub mod checkpoint;
mod drive;
mod error;
mod ledger;
mod parameters;
mod rotation;
mod world;

pub use body::{BodySpec, Shape, ShapeId};
pub use drive::Drive;
pub use error::SolveError;
pub use ledger::Ledger;
pub use parameters::{Medium, SleepParameters, TimeStepParameters, WorldParameters};
pub use world::{Counters, Residuals, Stability, World};
