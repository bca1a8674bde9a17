//! A settled pack and its measures.

use super::run::{Analysis, Run};

/// A settled pack.
#[derive(Debug, Clone)]
pub(super) struct Pack {
    pub(super) run: Run,
    pub(super) analysis: Analysis,
}
