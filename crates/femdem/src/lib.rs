//! femdem.

mod error;
pub mod output;
pub mod picture;
mod snapshot;
#[cfg(test)]
mod testing;

pub use femdem_analysis as analysis;
pub use femdem_contact as contact;
pub use femdem_mesh as mesh;
pub use femdem_pack as pack;
pub use femdem_solve as solve;

pub use error::Error;
pub use snapshot::{Body, BodyLoad, ContactClass, ContactRow, NamedShape, Partner, Snapshot};
