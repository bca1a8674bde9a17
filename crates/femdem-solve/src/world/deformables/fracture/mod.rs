//! Deformable bodies that break.
//!
//! Two meshes share the tetrahedra of such a body. In that of the elements every node is split that a crack separates. In that
//! of the contacts nodes are split only where the sides of a crack have been [released](release): up to then a contact node
//! is the mean of the nodes of the elements that it stands for, weighted by their masses, and its forces go to them by the same
//! weights. So a crack that opens changes nothing in the contacts, energies and forces are continuous, and forces of contacts stay
//! the gradients of their energy.
//!
//! Between its birth and its release a facet is a [joint](joints) of glue, pressure and friction.

mod birth;
mod breakable;
mod cracks;
mod joints;
mod query;
mod release;

pub use query::{CrackFacet, Cracks};

pub(crate) use breakable::Breakable;
pub(crate) use cracks::CrackState;
use serde::{Deserialize, Serialize};

/// What cracks exchanged, J.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CrackFlows {
    /// Lent at births.
    pub lent: f64,
    /// Dissipated by glue.
    pub glue: f64,
    /// Dissipated by friction of joints.
    pub friction: f64,
    /// Held by joints when they were released.
    pub released: f64,
}

impl std::ops::AddAssign for CrackFlows {
    fn add_assign(&mut self, other: Self) {
        self.lent += other.lent;
        self.glue += other.glue;
        self.friction += other.friction;
        self.released += other.released;
    }
}
