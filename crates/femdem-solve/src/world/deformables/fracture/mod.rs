//! Deformable bodies that break.
//!
//! Every few steps the stresses are looked at; where a node fails it is split, as are its mass and its velocity, so that nothing
//! jumps ([birth]). Facets that are cut become [joints]: glue, and the pressure of their birth, so that they carry the traction that
//! the facet carried when its first node was split; one that is split later has what the glue has left. Their sides are skin from
//! then on, and meet as any other skin does: they lie on each other at that moment, and so do all tetrahedra around, so the contact
//! begins at no overlap and no energy ([reshape]). A joint is spent when its glue has broken and the pressure of its birth has faded,
//! and is taken off the list.
//!
//! Looking at stresses costs nothing where the largest strain, known from the bound of the step, is too small to harm.

mod birth;
mod breakable;
mod cracks;
mod facet;
mod fragments;
mod joints;
mod query;
mod reshape;
mod stored;

pub use facet::CrackFacet;
pub use fragments::Fragmentation;
pub(in crate::world) use fragments::{Fragment, GuestFragment};
pub use query::Cracks;

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
    /// Lost by the pressure that joints are born with as it fades, and by contacts at births.
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
