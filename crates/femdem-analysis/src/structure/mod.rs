//! The structure of the contacts: classes, rattlers, constraints.

mod classes;
mod coordination;
mod rattlers;

pub use classes::{ClassCount, ContactClasses, contact_classes};
pub use coordination::mean_coordination;
pub use rattlers::{Rattlers, SupportRule, rattlers};
