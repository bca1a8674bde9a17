//! What can go wrong when a pack is specified or made.

use femdem_contact::{BodyId, ContactError};
use femdem_mesh::MeshError;
use femdem_solve::SolveError;
use thiserror::Error;

/// Errors of this crate.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PackError {
    /// A parameter is out of its range.
    #[error("{name} = {value} is not allowed: it must be {allowed}")]
    Parameter {
        /// The parameter's name.
        name: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range in words.
        allowed: &'static str,
    },
    /// A pack needs something to pack.
    #[error("no shape was given: name at least one shape to pack")]
    NoShapes,
    /// A body that is not convex needs tetrahedra for its contacts.
    #[error("the shape {name} is not convex and has no mesh: make it with PackShape::of_surface")]
    NotConvex {
        /// The shape.
        name: String,
    },
    /// A body fits into the container only in some orientations, or not at all.
    #[error(
        "the container's {side} is {} m, but a body of circumscribed diameter {1} m \
         must fit in any orientation: give at least {1} m, or make the bodies smaller",
        short(*size),
        short(*diameter)
    )]
    ContainerTooNarrow {
        /// Which inner dimension: width, depth or diameter.
        side: &'static str,
        /// The dimension given, m.
        size: f64,
        /// Largest circumscribed diameter of a body, m.
        diameter: f64,
    },
    /// A layer of the release lattice is wider than the container.
    #[error(
        "{given} bodies at a spacing of {} m do not fit along the container's {axis} axis: \
         at most {most} do; lower per_layer, the spacing or the size of the bodies",
        short(*spacing)
    )]
    LayerTooWide {
        /// The axis, x or y.
        axis: &'static str,
        /// Bodies specified.
        given: u32,
        /// Bodies that fit.
        most: u32,
        /// Lattice spacing, m.
        spacing: f64,
    },
    /// No site of the specified rows lies inside a round container.
    #[error(
        "of {} by {} bodies in a layer at a spacing of {} m none lies inside the container, {} m wide: \
         rows of an even number have no site in the middle; change per_layer, or leave it out",
        per_layer[0], per_layer[1], short(*spacing), short(*diameter)
    )]
    LayerOutside {
        /// Bodies specified along x and y.
        per_layer: [u32; 2],
        /// Lattice spacing, m.
        spacing: f64,
        /// Inner diameter of the container, m.
        diameter: f64,
    },
    /// A layer of the release lattice has too many sites.
    #[error(
        "a layer of {} by {} bodies is above the limit of {most} sites: give a smaller per_layer",
        sites[0], sites[1]
    )]
    LayerTooLarge {
        /// Sites along x and y.
        sites: [u32; 2],
        /// Largest number of sites of a layer.
        most: u64,
    },
    /// A body has left the container.
    #[error(
        "body {body} has left the container through {through} (centroid at {position:.4?} m): \
         the penalty of {penalty:.3e} Pa is probably too low for the speed of impact or the load; \
         raise the penalty or lower the drop height"
    )]
    Escaped {
        /// The body.
        body: BodyId,
        /// The wall that it went through.
        through: String,
        /// Its centroid, m.
        position: [f64; 3],
        /// The penalty in use, Pa.
        penalty: f64,
    },
    /// A body flies far above the highest start.
    #[error(
        "body {body} was thrown to a height of {height:.4} m, though nothing was released above \
         {released:.4} m: the time step is probably too long for the contacts; lower \
         time_step.safety"
    )]
    Thrown {
        /// The body.
        body: BodyId,
        /// Height of its centroid, m.
        height: f64,
        /// Highest point of any start, m.
        released: f64,
    },
    /// A rank has only a part of the bodies.
    #[error("a report of a job that is shared out is not possible: gather it first")]
    Shared,
    /// The record of a pack does not fit its world: the checkpoint was altered.
    #[error("the state of the pack is inconsistent: {what}; start from an unaltered checkpoint")]
    Inconsistent {
        /// What does not fit.
        what: &'static str,
    },
    /// A shape's surface cannot be used.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A wall or the contact law was refused.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// The simulation failed.
    #[error(transparent)]
    Solve(#[from] SolveError),
}

/// A number to five digits, without trailing zeros.
fn short(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

/// Returns an error unless `value` is finite and `ok`.
pub(crate) fn check(
    name: &'static str,
    value: f64,
    ok: bool,
    allowed: &'static str,
) -> Result<(), PackError> {
    if value.is_finite() && ok {
        Ok(())
    } else {
        Err(PackError::Parameter {
            name,
            value,
            allowed,
        })
    }
}

/// Returns an error unless `value` is positive and finite.
pub(crate) fn check_positive(name: &'static str, value: f64) -> Result<(), PackError> {
    check(name, value, value > 0.0, "above 0 and finite")
}
