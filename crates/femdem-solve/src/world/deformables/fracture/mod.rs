//! Deformable bodies that break.
//!
//! Every few steps the stresses are looked at; where a node fails it is split, as are its mass and its velocity, so that nothing
//! jumps ([birth]). Facets that are cut become [joints]: glue, pressure and friction of their sides, born with the traction
//! that the facet carried. When nothing holds any more and the sides have gone apart, or have slid far, they are
//! [released](release) and become skin.
//!
//! Two meshes have the tetrahedra of such a body. In one all facets that are cut are so: it numbers the nodes of the elements, and
//! gives the places of the contacts. In the other only those that are released are cut: it says what is skin, where the
//! contact field is zero, and which tetrahedra belong together and so cannot touch each other. A joint that has not been
//! released is not a contact, and a crack that opens changes nothing in the contacts.
//!
//! Looking at stresses costs nothing where the largest strain, known from the bound of the step, is too small to harm.

mod birth;
mod breakable;
mod cracks;
mod facet;
mod joints;
mod query;
mod release;
mod stored;

pub use facet::CrackFacet;
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
