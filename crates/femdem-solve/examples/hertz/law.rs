//! Laws that are the same at small strain.

use femdem_fem::material::{
    AnyMaterial, Deformation, Hencky, Material, NeoHookean, Response, Tangent, difference_tangent,
};
use femdem_mesh::Matrix3;
use femdem_solve::SolveError;
use std::sync::Arc;

#[derive(Debug, Clone, Copy)]
pub enum Law {
    NeoHookean,
    Hencky,
    SmallStrain,
}

impl Law {
    pub fn material(self, young: f64, poisson: f64) -> Result<AnyMaterial, SolveError> {
        Ok(match self {
            Self::NeoHookean => NeoHookean::new(young, poisson)?.into(),
            Self::Hencky => Hencky::new(young, poisson)?.into(),
            Self::SmallStrain => AnyMaterial::custom(Arc::new(SmallStrain {
                lambda: young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
                shear: 0.5 * young / (1.0 + poisson),
            })),
        })
    }
}

/// P = lambda tr(e) I + 2 mu e with e the symmetric part of F - I. Not objective: for bodies that do not
/// rotate.
#[derive(Debug)]
struct SmallStrain {
    lambda: f64,
    shear: f64,
}

impl Material for SmallStrain {
    fn name(&self) -> &str {
        "small strain"
    }

    fn respond(&self, d: &Deformation, _old: &[f64], _new: &mut [f64]) -> Option<Response> {
        let slope = d.gradient - Matrix3::identity();
        let strain = (slope + slope.transpose()) * 0.5;
        let piola = Matrix3::from_diagonal_element(self.lambda * strain.trace())
            + strain * (2.0 * self.shear);
        Response::elastic(0.5 * piola.dot(&strain), piola)
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        difference_tangent(self, d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.lambda + 2.0 * self.shear
    }

    /// The largest stiffness of any strain.
    fn stiffness_bound(&self, _d: &Deformation, _old: &[f64]) -> f64 {
        3.0 * self.lambda + 2.0 * self.shear
    }
}
