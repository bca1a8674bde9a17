//! Whether a body may move.

use serde::{Deserialize, Serialize};

/// Whether a body may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Sleep {
    Awake,
    /// Stopped since the last evaluation of its contacts.
    Stopped,
    /// Its contacts were evaluated with it at rest.
    Frozen,
}

impl Sleep {
    pub fn set(&mut self, awake: bool) {
        *self = match (awake, *self) {
            (true, _) => Self::Awake,
            (false, Self::Awake) => Self::Stopped,
            (false, asleep) => asleep,
        };
    }

    /// Makes the next update evaluate all its pairs once more.
    pub fn stir(&mut self) {
        if *self == Self::Frozen {
            *self = Self::Stopped;
        }
    }

    /// Ends an update.
    pub fn settle(&mut self) {
        if *self == Self::Stopped {
            *self = Self::Frozen;
        }
    }
}
