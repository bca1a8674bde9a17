//! femdem.

mod error;
pub mod output;
pub mod picture;
pub mod results;
pub mod scene;
mod snapshot;
#[cfg(test)]
mod testing;

pub use femdem_analysis as analysis;
pub use femdem_contact as contact;
pub use femdem_mesh as mesh;
pub use femdem_pack as pack;
pub use femdem_solve as solve;

pub use error::Error;
pub use results::{Summary, Usage};
pub use scene::Scene;
pub use snapshot::{Body, BodyLoad, ContactClass, ContactRow, NamedShape, Partner, Patch, Snapshot};
