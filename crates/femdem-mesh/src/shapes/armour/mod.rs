//! Concrete armour units of breakwaters: Antifer cube, dolos, tetrapod.

mod antifer;
mod dolos;
mod tetrapod;

pub use antifer::Antifer;
pub use dolos::Dolos;
pub use tetrapod::Tetrapod;
