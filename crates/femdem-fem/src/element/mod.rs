//! Solid finite elements: tetrahedra of four and ten nodes, total Lagrangian.
//!
//! | element | nodes | points | for |
//! |---|---|---|---|
//! | [`Element::T4`] | 4 | 1 | impact and contact of compressible bodies: cheapest by far, stiff in bending, locks as nu approaches 1/2 |
//! | [`Element::T4NodalPressure`] | 4 | 1 | the same without volumetric locking, at about twice the cost |
//! | [`Element::T10`] | 10 | 4 | bending and stresses; locks mildly as nu approaches 1/2 |
//! | [`Element::T10Fbar`] | 10 | 4 | the same without volumetric locking; not for bodies one element thick |
//!
//! T10Fbar replaces the volume change at every point of an element by the mean, and so loses a part of its
//! bending stiffness: a cantilever of 20 elements by one across bends 1.8 times as much as it should, one of
//! 20 by two by two 5 % too much (nu 0.3, test `fbar_wants_more_than_one_element_across`).
//!
//! All four have an energy, and their forces are minus its exact gradient. Energy conservation of the
//! integrators, the line search of the static solvers, and the tests rely on this.

mod batch;
mod failure;
mod fbar;
mod lanes;
mod log;
mod mass;
mod table;

pub(crate) use batch::{Batch, BatchElement, Node};
pub use failure::ElementFailure;
pub(crate) use fbar::{Bar, BarChange};
pub(crate) use mass::lumped;
pub(crate) use table::{T4, T10, Table};

use serde::{Deserialize, Serialize};

/// A kind of solid element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// Linear tetrahedron: constant strain, one point.
    #[default]
    T4,
    /// Linear tetrahedron whose volume change is averaged to its nodes and back over the tetrahedra around
    /// them (J. Bonet and A. J. Burton, Commun. Numer. Meth. Engng 14 (1998) 437-449), in energy form: the
    /// energy is W(Fbar) with Fbar = (Jbar/J)^(1/3) F. There is no averaging across regions of different
    /// material.
    T4NodalPressure,
    /// Quadratic tetrahedron with straight edges in the reference state, four points.
    T10,
    /// Quadratic tetrahedron with F-bar (E. A. de Souza Neto et al., Int. J. Solids Struct. 33
    /// (1996) 3277-3296) in energy form: Fbar = (Jbar/J)^(1/3) F at each point, Jbar the element's
    /// volume ratio.
    T10Fbar,
}

impl Element {
    /// Nodes per element.
    #[must_use]
    pub fn node_count(self) -> usize {
        if self.is_quadratic() { 10 } else { 4 }
    }

    /// Integration points per element.
    #[must_use]
    pub fn point_count(self) -> usize {
        if self.is_quadratic() { 4 } else { 1 }
    }

    /// Whether it has nodes in the middles of its edges.
    #[must_use]
    pub fn is_quadratic(self) -> bool {
        matches!(self, Self::T10 | Self::T10Fbar)
    }
}
