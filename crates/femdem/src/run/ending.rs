//! Why a run ended.

use serde::{Deserialize, Serialize};

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Its duration was over.
    Time,
    /// All bodies were at rest.
    Rest,
    /// A number of its tables was beyond a limit.
    Until,
}
