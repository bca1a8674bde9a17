//! The structure of the contacts: classes, rattlers, constraints.

mod classes;
mod rattlers;

pub use classes::{ClassCount, ContactClasses, contact_classes};
pub use rattlers::{Rattlers, SupportRule, rattlers};
