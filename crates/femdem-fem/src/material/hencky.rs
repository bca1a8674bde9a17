//! The Hencky solid.

use super::log_strain::{Returned, stored};
use super::moduli::ElasticRecord;
use super::principal::Frame;
use super::{Deformation, Material, Moduli, Response, Tangent};
use crate::error::FemError;
use femdem_mesh::Matrix3;
use serde::{Deserialize, Serialize};

/// Hooke's law in logarithmic strain eps = ln(b)/2: W = mu dev(eps) : dev(eps) + K/2 tr(eps)^2,
/// tau = lambda tr(eps) I + 2 mu eps (Hencky 1928; Anand, J. Appl. Mech. 46, 78 (1979)).
///
/// Suitable for metals and rock, whose elastic strains are small; not for rubber: in tension the stress P has
/// a maximum at a stretch of e (uniaxial strain).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ElasticRecord", into = "ElasticRecord")]
pub struct Hencky {
    moduli: Moduli,
}

impl Hencky {
    /// The solid with Young's modulus `young` in Pa and Poisson's ratio `poisson`.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0 and -1 < poisson < 0.5.
    pub fn new(young: f64, poisson: f64) -> Result<Self, FemError> {
        Ok(Self {
            moduli: Moduli::new(young, poisson)?,
        })
    }

    /// The moduli at small strain.
    #[must_use]
    pub fn moduli(&self) -> &Moduli {
        &self.moduli
    }

    fn at(&self, d: &Deformation) -> Option<(Frame, Returned)> {
        let frame = Frame::new(&d.gradient, &Matrix3::identity())?;
        let strain = frame.b.values.map(|value| 0.5 * value.ln());
        Some((frame, Returned::elastic(&self.moduli, &strain, 0.0)))
    }
}

impl Material for Hencky {
    fn name(&self) -> &str {
        "Hencky"
    }

    fn respond(&self, d: &Deformation, _old: &[f64], _new: &mut [f64]) -> Option<Response> {
        let (frame, state) = self.at(d)?;
        let energy = stored(&self.moduli, &state.elastic);
        Response::elastic(energy, frame.piola(&state.stress))
    }

    fn tangent(&self, d: &Deformation, _old: &[f64]) -> Option<Tangent> {
        let (frame, state) = self.at(d)?;
        frame.tangent(&state.principal(&frame.b.values))
    }

    fn wave_modulus(&self) -> f64 {
        self.moduli.wave()
    }

    fn stiffness_bound(&self, d: &Deformation, _old: &[f64]) -> f64 {
        self.at(d).map_or(f64::NAN, |(frame, state)| {
            let principal = state.principal(&frame.b.values);
            frame.stiffness_bound(&principal, &frame.inverse_stretches())
        })
    }
}

impl From<Hencky> for ElasticRecord {
    fn from(law: Hencky) -> Self {
        law.moduli.into()
    }
}

impl TryFrom<ElasticRecord> for Hencky {
    type Error = FemError;

    fn try_from(record: ElasticRecord) -> Result<Self, FemError> {
        Self::new(record.young, record.poisson)
    }
}
