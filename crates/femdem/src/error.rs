//! The error type of this crate.

use std::io;
use std::path::PathBuf;

use femdem_contact::ContactError;
use femdem_fem::FemError;
use femdem_pack::PackError;
use femdem_solve::SolveError;
use femdem_view::ViewError;

/// Errors of the scenes and runs of this crate, and of the crates below it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: io::Error,
    },
    /// A body goes through another or through a wall.
    #[error(
        "at {time:.6} s \"{b}\" lies in \"{a}\" by {:.0} % of the smaller one's volume: contact.penalty, or that of their pair, = {penalty:e} Pa \
         cannot hold them apart; {enough:.1e} Pa would, or a lower speed or load",
        100.0 * share
    )]
    Through {
        /// Name of a body or a wall.
        a: String,
        /// Name of a body.
        b: String,
        /// Share of the smaller one's volume.
        share: f64,
        /// Simulated time, s.
        time: f64,
        /// The penalty, Pa.
        penalty: f64,
        /// One that would do, Pa.
        enough: f64,
    },
    /// The energy ledger of a run misses more than its limit.
    #[error(
        "the energy ledger misses {:.1} % of the energy turned over at {time:.6} s, and energy-error-limit = {limit}: \
         try half of time-step.safety, and look for bodies that overlap deeply or move very fast; \
         with a larger energy-error-limit (inf: none) in the scene.toml of its folder `femdem resume` goes on",
        100.0 * missing
    )]
    Books {
        /// Error over the energy turned over.
        missing: f64,
        /// Simulated time, s.
        time: f64,
        /// What the scene allows.
        limit: f64,
    },
    /// A duration that a run has reached already.
    #[error(
        "duration = {duration} is not beyond the present time of the run, {time} s: give a longer one"
    )]
    Over {
        /// s.
        duration: f64,
        /// Simulated time, s.
        time: f64,
    },
    /// A scene has another value than the state with which it is to go on.
    #[error("{scene} changes {key}, which {state} fixes: {advice}")]
    Fixed {
        /// The scene.
        scene: &'static str,
        /// The key.
        key: String,
        /// The state.
        state: String,
        /// What to do.
        advice: &'static str,
    },
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
    /// A name that nothing in a scene has.
    #[error("{name} = \"{value}\" is not known: give one of {known}")]
    Unknown {
        /// The key.
        name: &'static str,
        /// The name given.
        value: String,
        /// What is known.
        known: String,
    },
    /// A pack does not tell what acts on its bodies.
    #[error("the stresses inside bodies follow from the forces on them: {what}")]
    NoForces {
        /// What is missing, and what to do.
        what: &'static str,
    },
    /// A scene file is not TOML, or has a wrong key or value.
    #[error("{}: {message}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// The place and the fault.
        message: String,
    },
    /// An entry of a scenario was refused, or a body of it failed.
    #[error("{entry}: {fault}")]
    Entry {
        /// The entry: a wall, a body or a material, by name.
        entry: String,
        /// What is wrong with it.
        fault: Box<Error>,
    },
    /// A wall was refused.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A shape or a surface file was refused.
    #[error(transparent)]
    Mesh(#[from] femdem_mesh::MeshError),
    /// A packing job was refused or failed.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// A material, a model or a boundary condition was refused.
    #[error(transparent)]
    Fem(#[from] FemError),
    /// A world or a checkpoint was refused.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A pack could not be measured.
    #[error(transparent)]
    Analysis(#[from] femdem_analysis::AnalysisError),
    /// Something could not be written or drawn, or a pack from elsewhere was refused.
    #[error(transparent)]
    View(#[from] ViewError),
}

impl Error {
    /// The same error; if a library refused a number whose name is among `keys`, with the key of the scene that
    /// belongs to it.
    pub(crate) fn by_keys(self, keys: &[(&str, &'static str)]) -> Self {
        let refused = match &self {
            Self::Contact(error) | Self::Pack(PackError::Contact(error)) => by_contact(error),
            Self::Fem(error) => by_fem(error),
            Self::Solve(error) | Self::Pack(PackError::Solve(error)) => by_solve(error),
            Self::Pack(PackError::Parameter {
                name,
                value,
                allowed,
            }) => Some((*name, *value, *allowed)),
            _ => None,
        };
        let Some((name, value, allowed)) = refused else {
            return self;
        };
        match keys.iter().find(|(known, _)| *known == name) {
            Some((_, key)) => Self::Option {
                name: key,
                value: value.to_string(),
                allowed,
            },
            None => self,
        }
    }
}

/// Name and value of a number that was refused, and what is allowed.
type Refused = (&'static str, f64, &'static str);

fn by_contact(error: &ContactError) -> Option<Refused> {
    match error {
        ContactError::Parameter {
            name,
            value,
            allowed,
        } => Some((*name, *value, *allowed)),
        _ => None,
    }
}

fn by_fem(error: &FemError) -> Option<Refused> {
    match error {
        FemError::Parameter {
            name,
            value,
            allowed,
        } => Some((*name, *value, *allowed)),
        _ => None,
    }
}

fn by_solve(error: &SolveError) -> Option<Refused> {
    match error {
        SolveError::Contact(error) => by_contact(error),
        SolveError::Fem(error) => by_fem(error),
        SolveError::Parameter {
            name,
            value,
            allowed,
        } => Some((*name, *value, *allowed)),
        _ => None,
    }
}

/// A key of a scene with a value that is not allowed.
pub(crate) fn wrong(name: &'static str, value: &str, allowed: &'static str) -> Error {
    Error::Option {
        name,
        value: value.to_owned(),
        allowed,
    }
}
