//! Explicit or implicit time steps.

use femdem_solve::ImplicitStep;
use serde::{Deserialize, Serialize};

/// How time steps are taken while a pack is made; in a scene file `implicit = false`, `true`, or the length of the
/// steps over the explicit limit of one contact over a full face.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub enum StepKind {
    /// Explicit steps.
    Explicit,
    /// Implicit steps, of this [multiple](ImplicitStep::multiple) of the explicit limit.
    Implicit(f64),
}

/// How a scene file has it.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected false, true, or the length of the steps over the explicit limit, such as 9.0"
)]
enum Written {
    Switch(bool),
    Multiple(f64),
}

impl StepKind {
    /// Implicit steps of the usual length.
    #[must_use]
    pub fn implicit() -> Self {
        Self::Implicit(ImplicitStep::default().multiple)
    }

    /// The steps of a world.
    pub(super) fn step(self) -> Option<ImplicitStep> {
        match self {
            Self::Explicit => None,
            Self::Implicit(multiple) => Some(ImplicitStep {
                multiple,
                ..ImplicitStep::default()
            }),
        }
    }
}

impl From<Written> for StepKind {
    fn from(written: Written) -> Self {
        match written {
            Written::Switch(false) => Self::Explicit,
            Written::Switch(true) => Self::implicit(),
            Written::Multiple(multiple) => Self::Implicit(multiple),
        }
    }
}

impl From<StepKind> for Written {
    fn from(kind: StepKind) -> Self {
        match kind {
            StepKind::Explicit => Self::Switch(false),
            StepKind::Implicit(multiple) => Self::Multiple(multiple),
        }
    }
}
