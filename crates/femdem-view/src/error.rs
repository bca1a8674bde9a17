//! The crate's error type.

use std::io;
use std::path::PathBuf;

use femdem_analysis::AnalysisError;
use femdem_mesh::MeshError;

/// Why something could not be read, measured, drawn or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// A file could not be written.
    #[error("cannot write {}: {source}; check that the folder exists, may be written to, and has room", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A body names a shape that does not exist.
    #[error("body {body} has shape {shape}, but there are {shapes} shapes")]
    ShapeIndex {
        /// The body.
        body: usize,
        /// Its shape.
        shape: u32,
        /// Number of shapes.
        shapes: usize,
    },
    /// A contact names a body that does not exist.
    #[error("contact {contact} names body {body}, but there are {bodies} bodies")]
    BodyIndex {
        /// Index of the contact.
        contact: usize,
        /// The body that it names.
        body: u32,
        /// Number of bodies.
        bodies: usize,
    },
    /// Some bodies have masses, but not all.
    #[error("{masses} masses for {bodies} bodies; give one for each, or none")]
    Masses {
        /// Number of masses.
        masses: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// Some bodies have velocities, but not all.
    #[error("{velocities} velocities for {bodies} bodies; give one for each, or none")]
    Velocities {
        /// Number of velocities.
        velocities: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// A pose, a mass or a force is NaN or infinite.
    #[error("{what} {index} holds a number that is not finite")]
    NotFinite {
        /// "body", "the mass of body", "the velocity of body" or "contact".
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// A crack facet, an event or a fragment with a number out of its range.
    #[error("{what} {index}: its {name} = {value} is not allowed; it must be {allowed}")]
    Quantity {
        /// "crack facet", "event" or "fragment".
        what: &'static str,
        /// Its index.
        index: usize,
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// There is no body to draw.
    #[error("there is no body to draw")]
    NothingToDraw,
    /// An option is out of its range.
    #[error("{name} = {value} is not allowed: {allowed}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// The value given.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A table from elsewhere has a fault.
    #[error("{}, line {line}: {message}", path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A surface file of a shape was refused.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A pack could not be measured.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
}
