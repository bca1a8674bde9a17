//! Layer 3: bodies that femdem moves.

mod build;
mod drive;
mod files;
mod hand;
mod parameters;
mod query;
mod step;

pub use build::*;
pub use drive::*;
pub use files::*;
pub use hand::*;
pub use parameters::*;
pub use query::*;
pub use step::*;

use std::sync::Arc;

use femdem_solve::{ShapeId, World};

use crate::border::Failure;
use crate::form::Form;
use crate::threads::Threads;

/// A world with the shapes that came from here.
pub(crate) struct Hosted {
    world: World,
    threads: Threads,
    shapes: Vec<(Arc<Form>, ShapeId)>,
}

impl From<World> for Hosted {
    fn from(world: World) -> Self {
        Self {
            world,
            threads: Threads::default(),
            shapes: Vec::new(),
        }
    }
}

impl Hosted {
    fn shape(&mut self, form: &Arc<Form>) -> Result<ShapeId, Failure> {
        let mut known = self.shapes.iter();
        if let Some((_, id)) = known.find(|(own, _)| Arc::ptr_eq(own, form)) {
            return Ok(*id);
        }
        let id = form.add_to(&mut self.world)?;
        self.shapes.push((Arc::clone(form), id));
        Ok(id)
    }
}
