//! Whether all bodies have come to rest, as a run looks for it.

use serde::{Deserialize, Serialize};

use super::settings::RestEntry;

/// Steps between looks.
pub(super) const STEPS_BETWEEN_LOOKS: u64 = 64;

/// What is known of the rest of all bodies so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Stillness {
    /// When the kinetic energy last fell below that of rest, as far as it was checked \[s\].
    since: Option<f64>,
    /// Whether the bodies have come to rest, and are awake to show that they stay there.
    pub verifying: bool,
}

impl Stillness {
    /// Looks at the kinetic energy \[J\], and at whether motions or changes of loads are to come. Returns whether the bodies have
    /// been still for so long, twice, that it is worth to look at their forces.
    pub fn look(&mut self, rest: &RestEntry, now: f64, energy: f64, more_to_come: bool) -> bool {
        if energy >= rest.energy || more_to_come {
            *self = Self::default();
            return false;
        }
        if now - *self.since.get_or_insert(now) < rest.time {
            return false;
        }
        if !self.verifying {
            self.verifying = true;
            self.since = Some(now);
            return false;
        }
        true
    }
}
