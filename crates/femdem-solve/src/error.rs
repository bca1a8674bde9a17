//! Errors of building, stepping, saving and reading a world.

use femdem_contact::ContactError;
use femdem_fem::FemError;
use femdem_fem::element::ElementFailure;
use femdem_mesh::MeshError;
use std::path::PathBuf;
use thiserror::Error;

/// Errors of this crate.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The contact stage refused its input.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A shape's surface cannot be used.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The model, the material or the boundary conditions of a deformable body, or a prescribed motion.
    #[error(transparent)]
    Fem(#[from] FemError),
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
    /// A world that was read as a part of something else has not got its shapes back.
    #[error("the world has no contact shapes yet: call World::restore after reading it")]
    NotRestored,
    /// The elements of a body are too large for cracks in its material.
    #[error(
        "the elements of a body that may break are {height:.3e} m high in the mean, but the zone in which its cracks open or \
         slide needs {largest:.3e} m or less: use a mesh with edges of about {edge:.2e} m, or a larger energy of fracture or a lower \
         strength, by opening or by sliding, or allow it (coarse), and cracks take more energy than given"
    )]
    TooCoarse {
        /// Mean height of the elements, m.
        height: f64,
        /// The largest one that is right: [`Fracture::largest_height`](crate::Fracture::largest_height), m.
        largest: f64,
        /// Mean edge of a mesh with that height, m.
        edge: f64,
    },
    /// A body that may break must have linear elements, and a contact field that grows with depth.
    #[error("a body that may break needs {needs}, not {found}")]
    CannotBreak {
        /// What it needs.
        needs: &'static str,
        /// What it has.
        found: String,
    },
    /// A body that is to be deformable near its strength only must be able to be either.
    #[error("a body that is deformable near its strength only needs {needs}, not {found}")]
    CannotAdapt {
        /// What it needs.
        needs: &'static str,
        /// What it has.
        found: &'static str,
    },
    /// An index refers to something that was never added, or has been removed.
    #[error("there is no {what} {index} (never added, or removed): there are {count}")]
    NoSuch {
        /// What the index refers to.
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many exist.
        count: usize,
    },
    /// A velocity was given to a body that follows a drive.
    #[error("body {body} follows a drive, which gives its velocity: end the drive first")]
    Driven {
        /// The body.
        body: usize,
    },
    /// The static solvers did not reach equilibrium.
    #[error(
        "{method} stopped after {iterations} iterations at a residual of {residual:.3e} of the \
         force scale, above the {tolerance:.1e} asked for: {advice}"
    )]
    NotConverged {
        /// The solver.
        method: &'static str,
        /// Iterations or steps done.
        iterations: usize,
        /// Residual over force scale at the end.
        residual: f64,
        /// The tolerance: residual over force scale.
        tolerance: f64,
        /// What to do.
        advice: String,
    },
    /// The simulation has left physical bounds.
    #[error(
        "the simulation blew up at step {step} (t = {time:.6} s) with body {body} at \
         {position:?} m moving {speed:.3e} m/s: {cause}"
    )]
    BlowUp {
        /// The body found first.
        body: usize,
        /// Step number.
        step: u64,
        /// Simulated time, s.
        time: f64,
        /// The body's position, m.
        position: [f64; 3],
        /// Its speed, m/s.
        speed: f64,
        /// The likely cause and what to do.
        cause: String,
    },
    /// An element of a deformable body failed in a step.
    #[error("body {body} failed at step {step} (t = {time:e} s): {failure}")]
    BodyFailed {
        /// The body.
        body: usize,
        /// Step number.
        step: u64,
        /// Simulated time, s.
        time: f64,
        /// The element and its failure.
        failure: ElementFailure,
    },
    /// Worlds that share bodies, or the way between them.
    #[error("{why}")]
    Ranks {
        /// What is wrong and what to do.
        why: String,
    },
    /// A file could not be read or written.
    #[error("{action} {path}: {source}", path = path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A file is not a checkpoint, is damaged, or is of another kind or version.
    #[error("{path} cannot be used as a checkpoint: {why}", path = path.display())]
    BadCheckpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        why: String,
    },
    /// The state could not be encoded or decoded.
    #[error("the state could not be {action}: {why}")]
    Encoding {
        /// Encoded or decoded.
        action: &'static str,
        /// The encoder's error.
        why: String,
    },
}

impl From<ElementFailure> for SolveError {
    fn from(failure: ElementFailure) -> Self {
        Self::Fem(failure.into())
    }
}

impl SolveError {
    /// Names the body, the step and the time (s) of a failed element.
    pub(crate) fn in_body(self, body: usize, step: u64, time: f64) -> Self {
        match self {
            Self::Fem(FemError::Element(failure)) => Self::BodyFailed {
                body,
                step,
                time,
                failure,
            },
            other => other,
        }
    }
}

/// Returns an error unless `value` is finite and `ok`.
pub(crate) fn check(
    name: &'static str,
    value: f64,
    ok: bool,
    allowed: &'static str,
) -> Result<(), SolveError> {
    if value.is_finite() && ok {
        Ok(())
    } else {
        Err(SolveError::Parameter {
            name,
            value,
            allowed,
        })
    }
}
