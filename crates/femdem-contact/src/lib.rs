//! femdem-contact.

mod batch;
mod broadphase;
mod contact;
mod damping;
mod error;
mod friction;
pub mod kernel;
mod law;
mod motion;
mod shape;
mod walls;

pub use batch::{BatchTotals, ContactBatch};
pub use contact::{BodyId, Contact, Load, Partner, Wrench};
pub use error::ContactError;
pub use kernel::{Overlap, PairKernel};
pub use law::{ContactLaw, ContactParameters, restitution};
pub use motion::Motion;
pub use shape::{ConvexShape, Frame};
pub use walls::{Wall, WallPlane};
