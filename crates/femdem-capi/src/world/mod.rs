//! Layer 3: bodies that femdem moves.

mod bonds;
mod build;
mod cell;
mod cracks;
mod deformable;
mod drive;
mod files;
mod hand;
mod nodes;
mod parameters;
mod query;
mod step;

pub use bonds::*;
pub use build::*;
pub use cell::*;
pub use cracks::*;
pub use deformable::*;
pub use drive::*;
pub use files::*;
pub use hand::*;
pub use nodes::*;
pub use parameters::*;
pub use query::*;
pub use step::*;

use std::collections::BTreeMap;
use std::sync::Arc;

use femdem_solve::contact::BodyId;
use femdem_solve::{BodySpec, ShapeId, World, WorldParameters};

use crate::border::Failure;
use crate::form::Form;
use crate::threads::Threads;

/// A world with the shapes that came from here.
pub(crate) struct Hosted {
    world: World,
    threads: Threads,
    /// By their addresses, which stay their own as long as they are kept here.
    shapes: BTreeMap<usize, (Arc<Form>, ShapeId)>,
    /// What the last call made that makes bodies of fragments.
    fragments: Vec<FemdemFragment>,
}

impl From<World> for Hosted {
    fn from(world: World) -> Self {
        Self {
            world,
            threads: Threads::default(),
            shapes: BTreeMap::new(),
            fragments: Vec::new(),
        }
    }
}

impl Hosted {
    /// Adds a body, whose shape in `spec` is yet to be set, and its shape if that is new.
    fn add_body(&mut self, form: &Arc<Form>, spec: BodySpec) -> Result<BodyId, Failure> {
        let address = Arc::as_ptr(form).addr();
        let shape = match self.shapes.get(&address) {
            Some((_, shape)) => *shape,
            None => {
                // A world keeps its shapes: another one tells first whether it would take the body.
                let mut trial = World::new(WorldParameters::default())?;
                let shape = form.add_to(&mut trial)?;
                trial.add_body(BodySpec { shape, ..spec })?;
                let shape = form.add_to(&mut self.world)?;
                self.shapes.insert(address, (Arc::clone(form), shape));
                shape
            }
        };
        Ok(self.world.add_body(BodySpec { shape, ..spec })?)
    }
}
