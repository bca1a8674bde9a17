//! Errors of building and updating shapes, laws and batches.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use thiserror::Error;

/// Errors of this crate. Kernels never fail on finite input; constructors and
/// the batch validate what they are given.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ContactError {
    /// The gauge field exists for convex bodies only.
    #[error(
        "the body is not convex: the gauge field needs a convex polyhedron; \
         take its convex hull or split it into convex parts"
    )]
    NotConvex,
    /// The centroid has to lie strictly inside every face plane.
    #[error(
        "face {face} lies {distance:e} m from the centroid, but every face must be farther than \
         {least:e} m (1e-6 of the bounding radius): the body is too thin for the gauge field"
    )]
    TooThin {
        /// Index of the offending face.
        face: usize,
        /// Distance from the centroid to the face plane, m.
        distance: f64,
        /// Smallest allowed distance, m.
        least: f64,
    },
    /// A shape has more faces or vertices than the 16-bit indices of the kernel can hold.
    #[error("the body has {count} {what}, but at most {most} are supported: simplify the surface")]
    TooLarge {
        /// What is counted: faces, vertices or edges.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// The largest supported number.
        most: usize,
    },
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
    /// An index refers to something that was never added, or has been removed.
    #[error("there is no {what} {index} (never added, or removed): there are {count}")]
    NoSuch {
        /// What the index refers to: shape, body or wall.
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many exist.
        count: usize,
    },
    /// A batch that was read is inconsistent, or its shapes differ from those it was stored with.
    #[error(
        "{what} does not fit the stored contacts: start from an unaltered file, with the shapes of then"
    )]
    Stored {
        /// What does not fit.
        what: String,
    },
    /// A slice of states does not match the number of bodies or walls in the batch.
    #[error(
        "{given} {what} states were given, but {expected} were added: pass one for each {what}"
    )]
    StateCount {
        /// Body or wall.
        what: &'static str,
        /// States given.
        given: usize,
        /// Bodies or walls in the batch.
        expected: usize,
    },
    /// A body's state is not finite, or one of its inverse masses is negative.
    #[error(
        "the state of body {body} is not finite, or has a negative inverse mass (position \
         {position:?}): the host's integration has blown up, so reduce the time step, or its masses \
         are not set"
    )]
    NotFinite {
        /// The body.
        body: usize,
        /// Its position, m.
        position: [f64; 3],
    },
    /// What the contacts do to a body is not finite, though its state and those of its partners are.
    #[error(
        "the contact load on body {body} is not finite (position {position:?} m, velocity \
         {velocity:?} m/s): its motion or that of a partner is out of the range of the numbers, so \
         the host's integration has blown up: reduce the time step"
    )]
    LoadNotFinite {
        /// The body, the one of the lowest index if there are several.
        body: usize,
        /// Its position, m.
        position: [f64; 3],
        /// Its velocity, m/s.
        velocity: [f64; 3],
    },
    /// A slice of nodal values does not match the nodes of its body.
    #[error(
        "{given} nodal values were given for the {expected} nodes of deformable body {body}: pass \
         one position, velocity and inverse mass per node"
    )]
    NodeCount {
        /// The deformable body.
        body: usize,
        /// Values given.
        given: usize,
        /// Nodes of the body.
        expected: usize,
    },
    /// A node's position or velocity is not finite, or its inverse mass is negative or not finite.
    #[error(
        "the state of node {node} of deformable body {body} is not usable (positions and \
         velocities must be finite, inverse masses finite and at least 0): if the integration has \
         blown up, reduce the time step"
    )]
    NodeState {
        /// The deformable body.
        body: usize,
        /// The node.
        node: usize,
    },
    /// A tetrahedron in contact has been turned inside out.
    #[error(
        "tetrahedron {tet} of the contact mesh of deformable body {body} has no positive volume \
         any more: reduce the time step, or take a stiffer material or a finer mesh"
    )]
    InvertedTet {
        /// The deformable body.
        body: usize,
        /// The tetrahedron of its contact mesh.
        tet: usize,
    },
    /// A mesh cannot be prepared for the general kernel.
    #[error("the mesh cannot be prepared: {why}")]
    Mesh {
        /// What is wrong.
        why: String,
    },
    /// A wall description is inconsistent.
    #[error("the wall \"{name}\" cannot be built: {why}")]
    Wall {
        /// The wall's name.
        name: String,
        /// What is wrong and what to do.
        why: String,
    },
}

impl ContactError {
    /// The same error with other numbers of the bodies that it names.
    #[must_use]
    pub fn with_bodies(mut self, number: impl FnOnce(usize) -> usize) -> Self {
        if let Self::NotFinite { body, .. }
        | Self::LoadNotFinite { body, .. }
        | Self::NodeCount { body, .. }
        | Self::NodeState { body, .. }
        | Self::InvertedTet { body, .. } = &mut self
        {
            *body = number(*body);
        }
        self
    }
}

impl From<femdem_mesh::MeshError> for ContactError {
    fn from(error: femdem_mesh::MeshError) -> Self {
        Self::Mesh {
            why: error.to_string(),
        }
    }
}

/// Returns an error unless `value` is finite and satisfies `ok`.
pub(crate) fn check(
    name: &'static str,
    value: f64,
    ok: bool,
    allowed: &'static str,
) -> Result<(), ContactError> {
    if value.is_finite() && ok {
        Ok(())
    } else {
        Err(ContactError::Parameter {
            name,
            value,
            allowed,
        })
    }
}

/// Range of stiffnesses, in SI units, whose products with lengths and volumes neither overflow nor underflow.
pub(crate) const STIFFNESSES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// Returns an error unless `value` is a usable pressure, Pa.
pub(crate) fn check_pressure(name: &'static str, value: f64) -> Result<(), ContactError> {
    let allowed = "between 1e-100 and 1e100 Pa";
    check(name, value, STIFFNESSES.contains(&value), allowed)
}

/// Reads a penalty and refuses one that is not usable.
pub(crate) fn read_penalty<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    let value = f64::deserialize(from)?;
    check_pressure("penalty", value).map_err(D::Error::custom)?;
    Ok(value)
}
