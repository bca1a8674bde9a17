//! Errors of materials, models, boundary conditions and static solvers.

use crate::element::ElementFailure;
use femdem_mesh::MeshError;
use thiserror::Error;

/// Errors of this crate.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FemError {
    /// A mesh cannot be used.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Elements cannot compute their forces.
    #[error(transparent)]
    Element(#[from] ElementFailure),
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
    /// A material is known by name only, and no law of that name was given.
    #[error(
        "no law was given for the material '{name}' (given: {given}); pass it to \
         AnyMaterial::bind after reading a checkpoint or a scene that names it"
    )]
    UnboundMaterial {
        /// The name that was looked for.
        name: String,
        /// The names of the laws given.
        given: String,
    },
    /// An index refers to something that was never added.
    #[error("there is no {what} {index}: {count} were added")]
    NoSuch {
        /// What the index refers to.
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many exist.
        count: usize,
    },
    /// A list has the wrong length.
    #[error("{given} {what} were given where {wanted} are wanted")]
    WrongLength {
        /// What is listed.
        what: &'static str,
        /// The length given.
        given: usize,
        /// The length required.
        wanted: usize,
    },
    /// A stress handed over is infinite or no number.
    #[error(
        "the stress of tetrahedron {element} is not finite: the body has blown up, or the stress was not computed"
    )]
    StressNotFinite {
        /// The tetrahedron.
        element: usize,
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
    /// A sparse matrix could not be factorised for lack of memory or of index range.
    #[error(
        "a matrix of {unknowns} unknowns could not be factorised: {why}; use conjugate gradients"
    )]
    Factorisation {
        /// Rows of the matrix.
        unknowns: usize,
        /// The reason.
        why: String,
    },
    /// A feature is missing in this build.
    #[error("{what} is not in this build: build femdem-fem with the feature `{feature}`")]
    FeatureMissing {
        /// What was requested.
        what: &'static str,
        /// The cargo feature that provides it.
        feature: &'static str,
    },
    /// An element failed in a step of a body.
    #[error("the body failed at step {step} (t = {time:e} s): {failure}")]
    StepFailed {
        /// Step number.
        step: u64,
        /// Simulated time, s.
        time: f64,
        /// The element and its failure.
        failure: ElementFailure,
    },
    /// A selection is empty.
    #[error("nothing is selected by {selection}: check its place, size and unit (m)")]
    NothingSelected {
        /// The selection.
        selection: String,
    },
    /// A named set of nodes does not exist.
    #[error("no set of nodes is called \"{name}\": name it first")]
    NoSuchSet {
        /// The name.
        name: String,
    },
}

impl FemError {
    /// Adds the step and the time (s) to the failure of an element.
    pub(crate) fn at_step(self, step: u64, time: f64) -> Self {
        match self {
            Self::Element(failure) => Self::StepFailed {
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
) -> Result<(), FemError> {
    if value.is_finite() && ok {
        Ok(())
    } else {
        Err(FemError::Parameter {
            name,
            value,
            allowed,
        })
    }
}
