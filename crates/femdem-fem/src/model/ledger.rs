//! The energy of one deformable body.

use serde::{Deserialize, Serialize};

/// Energies of a body that is stepped separately, J. Kinetic, stored and dissipated energy equals the initial
/// energy plus all work, up to the integration error.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BodyLedger {
    /// Kinetic and elastic energy at the start.
    pub initial: f64,
    /// Kinetic energy now.
    pub kinetic: f64,
    /// Energy stored in the materials now.
    pub elastic: f64,
    /// Dissipated by viscosity.
    pub viscous: f64,
    /// Dissipated by plastic flow.
    pub plastic: f64,
    /// Work of pressure, traction and gravity.
    pub external_work: f64,
    /// Work of the supports that move nodes.
    pub support_work: f64,
}

impl BodyLedger {
    /// The energy missing in the ledger, J: energy now plus dissipated minus initial energy and work.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.kinetic + self.elastic + self.viscous + self.plastic
            - self.initial
            - self.external_work
            - self.support_work
    }

    /// The error over the largest of the entries; 0 if all are zero.
    #[must_use]
    pub fn error_relative(&self) -> f64 {
        let entries = [
            self.initial,
            self.kinetic,
            self.elastic,
            self.viscous,
            self.plastic,
            self.external_work,
            self.support_work,
        ];
        let largest = entries.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
        if largest > 0.0 {
            self.error() / largest
        } else {
            0.0
        }
    }
}
