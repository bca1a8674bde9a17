//! Kelvin-Voigt viscosity beside any law.

use super::AnyMaterial;
use crate::error::{FemError, check};
use crate::material::{Deformation, Material, Response, Tangent};
use femdem_mesh::Matrix3;
use serde::{Deserialize, Serialize};

/// Largest viscosity, Pa s: that of the Earth's mantle. Far above it the step of explicit integration vanishes beside
/// any time.
const LARGEST_VISCOSITY: f64 = 1e21;

/// A law with a Newtonian viscous stress beside it: sigma_v = 2 eta dev(D) + zeta tr(D) I with
/// D = sym(dF/dt F^-1), P_v = J sigma_v F^-T. Rigid motion, spin included, gives no stress.
///
/// `viscosity_bound` is exact: J (4/3 eta + zeta)/s^2 with the smallest stretch s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct Viscous {
    law: Box<AnyMaterial>,
    shear: f64,
    bulk: f64,
}

impl Viscous {
    /// `law` with the shear viscosity eta = `shear` and the bulk viscosity zeta = `bulk`, Pa s.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless both viscosities are from 0 to 1e21 Pa s.
    pub fn new(law: impl Into<AnyMaterial>, shear: f64, bulk: f64) -> Result<Self, FemError> {
        let range = 0.0..=LARGEST_VISCOSITY;
        let allowed = "from 0 to 1e21 Pa s";
        check("shear viscosity", shear, range.contains(&shear), allowed)?;
        check("bulk viscosity", bulk, range.contains(&bulk), allowed)?;
        Ok(Self {
            law: Box::new(law.into()),
            shear,
            bulk,
        })
    }

    /// The law beside the viscosity.
    #[must_use]
    pub fn law(&self) -> &AnyMaterial {
        &self.law
    }

    /// The law beside the viscosity, to bind it.
    pub(super) fn law_mut(&mut self) -> &mut AnyMaterial {
        &mut self.law
    }

    /// Shear and bulk viscosity, Pa s.
    #[must_use]
    pub fn viscosities(&self) -> [f64; 2] {
        [self.shear, self.bulk]
    }

    /// sigma_v of a velocity gradient L; linear in it.
    fn stress(&self, velocity_gradient: &Matrix3) -> Matrix3 {
        let l = velocity_gradient;
        (l + l.transpose()) * self.shear
            + Matrix3::identity() * ((self.bulk - self.shear / 1.5) * l.trace())
    }

    fn longitudinal(&self) -> f64 {
        self.bulk + self.shear * 4.0 / 3.0
    }
}

impl Material for Viscous {
    fn name(&self) -> &str {
        "Kelvin-Voigt"
    }

    fn history_len(&self) -> usize {
        self.law.history_len()
    }

    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        let mut response = self.law.respond(d, old, new)?;
        let j = d.volume_ratio()?;
        let inverse = d.gradient.try_inverse()?;
        let viscous = self.stress(&(d.rate * inverse)) * inverse.transpose() * j;
        response.piola += viscous;
        response.viscous_power += viscous.dot(&d.rate);
        response.finite()
    }

    /// The law's tangent and d P_v at fixed dF/dt: with H = dF F^-1, L changes by -L H and F^-T by
    /// -H^T F^-T on the left.
    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        let mut tangent = self.law.tangent(d, old)?;
        let j = d.volume_ratio()?;
        let inverse = d.gradient.try_inverse()?;
        let velocity_gradient = d.rate * inverse;
        let stress = self.stress(&velocity_gradient);
        for column in 0..9 {
            let mut change = Matrix3::zeros();
            change[(column / 3, column % 3)] = 1.0;
            let h = change * inverse;
            let kirchhoff =
                stress * h.trace() - self.stress(&(velocity_gradient * h)) - stress * h.transpose();
            let slope = kirchhoff * inverse.transpose() * j;
            for row in 0..9 {
                tangent[(row, column)] += slope[(row / 3, row % 3)];
            }
        }
        tangent.iter().all(|t| t.is_finite()).then_some(tangent)
    }

    fn wave_modulus(&self) -> f64 {
        self.law.wave_modulus()
    }

    /// That of the law: the viscous stress enters the time step by its own bound.
    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        self.law.stiffness_bound(d, old)
    }

    fn viscosity(&self) -> f64 {
        self.law.viscosity() + self.longitudinal()
    }

    fn viscosity_bound(&self, d: &Deformation) -> f64 {
        let own = d.gradient.determinant() * self.longitudinal() / d.smallest_stretch().powi(2);
        self.law.viscosity_bound(d) + own
    }
}

/// How the law is written in files.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Viscous", deny_unknown_fields)]
struct Record {
    law: Box<AnyMaterial>,
    shear_viscosity: f64,
    bulk_viscosity: f64,
}

impl From<Viscous> for Record {
    fn from(viscous: Viscous) -> Self {
        Self {
            law: viscous.law,
            shear_viscosity: viscous.shear,
            bulk_viscosity: viscous.bulk,
        }
    }
}

impl TryFrom<Record> for Viscous {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        Self::new(*record.law, record.shear_viscosity, record.bulk_viscosity)
    }
}
