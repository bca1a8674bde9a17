//! Drucker-Prager plasticity.

use super::log_strain::{self, HISTORY, LogStrain, Returned, isotropic, split};
use super::{Deformation, Material, Moduli, Response, Tangent};
use crate::error::{FemError, check};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Hencky elasticity with the yield function sqrt(J2) + eta p - xi c, p = tr(tau)/3 positive in tension,
/// on the cone through the compression meridian of Mohr-Coulomb's hexagon: eta = 6 sin(phi) / (sqrt(3)
/// (3 - sin(phi))), xi = 6 cos(phi) / (sqrt(3) (3 - sin(phi))), flow along eta-bar p with eta-bar from the
/// dilatancy angle; perfectly plastic (Drucker and Prager, Q. Appl. Math. 10, 157 (1952); de Souza Neto,
/// Peric and Owen, Computational Methods for Plasticity, section 8.3).
///
/// If the return to the cone would pass the apex p = c / tan(phi), the stress returns to the apex, for any
/// dilatancy angle (a tension cut-off where it is 0). A gap opened there is plastic dilation: it does not
/// close again without stress. The tangent is not symmetric unless the dilatancy angle equals the friction
/// angle.
///
/// Without associated flow the work dissipated in a step, the stress at its end times the plastic strain, is
/// accurate to first order in the step.
///
/// History: C_p^-1 - I (xx, yy, zz, yz, xz, xy) and the equivalent plastic strain, the sum of
/// sqrt(2/3) |dev of the plastic strain increment|; seven numbers.
///
/// ```
/// use femdem_fem::material::DruckerPrager;
///
/// // A sandstone: E = 15 GPa, cohesion 10 MPa, friction angle 40 degrees, dilatancy 10 degrees.
/// let rock = DruckerPrager::new(15e9, 0.25, 10e6, 40_f64.to_radians(), 10_f64.to_radians())?;
/// assert_eq!(rock.moduli().young, 15e9);
/// // More dilatancy than friction would create energy.
/// assert!(DruckerPrager::new(15e9, 0.25, 10e6, 0.1, 0.2).is_err());
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct DruckerPrager {
    moduli: Moduli,
    cohesion: f64,
    friction_angle: f64,
    dilatancy_angle: f64,
}

impl DruckerPrager {
    /// The solid with `cohesion` in Pa and both angles in rad.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0, -1 < poisson < 0.5, cohesion >= 0,
    /// 0 <= dilatancy <= friction < pi/2, and cohesion or friction is not 0.
    pub fn new(
        young: f64,
        poisson: f64,
        cohesion: f64,
        friction_angle: f64,
        dilatancy_angle: f64,
    ) -> Result<Self, FemError> {
        let moduli = Moduli::new(young, poisson)?;
        check("cohesion", cohesion, cohesion >= 0.0, "finite and >= 0 Pa")?;
        let acute = (0.0..FRAC_PI_2).contains(&friction_angle);
        check(
            "friction_angle",
            friction_angle,
            acute,
            "from 0 to below pi/2, in rad",
        )?;
        let below = (0.0..=friction_angle).contains(&dilatancy_angle);
        let allowed = "from 0 to the friction angle, in rad (more would create energy)";
        check("dilatancy_angle", dilatancy_angle, below, allowed)?;
        let strong = cohesion > 0.0 || friction_angle > 0.0;
        let allowed = "> 0 Pa where the friction angle is 0 (the solid would have no strength)";
        check("cohesion", cohesion, strong, allowed)?;
        Ok(Self {
            moduli,
            cohesion,
            friction_angle,
            dilatancy_angle,
        })
    }

    /// The elastic moduli.
    #[must_use]
    pub fn moduli(&self) -> &Moduli {
        &self.moduli
    }

    /// eta, eta-bar and xi c.
    fn cone(&self) -> [f64; 3] {
        let scale = |angle: f64| 6.0 / (3.0_f64.sqrt() * (3.0 - angle.sin()));
        let (phi, psi) = (self.friction_angle, self.dilatancy_angle);
        let cohesive = scale(phi) * phi.cos() * self.cohesion;
        [scale(phi) * phi.sin(), scale(psi) * psi.sin(), cohesive]
    }

    /// The return to the apex: no shear stress, p = xi c / eta.
    fn apex(&self, trial: &[f64; 3], pressure: f64, hardening: f64) -> Returned {
        let (dilation, deviator) = split(trial);
        let elastic = pressure / self.moduli.bulk;
        let size = deviator.iter().map(|e| e * e).sum::<f64>().sqrt();
        Returned {
            stress: [pressure; 3],
            moduli: [[0.0; 3]; 3],
            shear_secant: 0.0,
            elastic: [elastic / 3.0; 3],
            hardening: hardening + (2.0_f64 / 3.0).sqrt() * size,
            plastic_work: pressure * (dilation - elastic),
            flows: true,
        }
    }
}

impl LogStrain for DruckerPrager {
    fn moduli(&self, _hardening: f64) -> Moduli {
        self.moduli
    }

    fn return_map(&self, trial: &[f64; 3], hardening: f64) -> Returned {
        let Moduli { bulk, shear, .. } = self.moduli;
        let [eta, eta_bar, cohesive] = self.cone();
        let (dilation, deviator) = split(trial);
        let size = deviator.iter().map(|e| e * e).sum::<f64>().sqrt();
        // sqrt(J2) = |dev tau|/sqrt(2) of the trial stress.
        let root = SQRT_2 * shear * size;
        let excess = root + eta * bulk * dilation - cohesive;
        if excess <= 0.0 {
            return Returned::elastic(&self.moduli, trial, hardening);
        }
        let stiffness = shear + bulk * eta * eta_bar;
        let x = excess / stiffness;
        if eta > 0.0 && shear * x >= root {
            return self.apex(trial, cohesive / eta, hardening);
        }
        let shrink = 1.0 - shear * x / root;
        let pressure = bulk * (dilation - eta_bar * x);
        let normal = deviator.map(|e| e / size);
        let mut moduli = isotropic(
            bulk * (1.0 - bulk * eta * eta_bar / stiffness),
            2.0 * shear * shrink,
        );
        let along = 2.0 * shear * shear * (x / root - 1.0 / stiffness);
        let across = SQRT_2 * shear * bulk / stiffness;
        for (row, n) in moduli.iter_mut().zip(normal) {
            for (entry, m) in row.iter_mut().zip(normal) {
                *entry += along * n * m - across * (eta * n + eta_bar * m);
            }
        }
        Returned {
            stress: deviator.map(|e| 2.0 * shear * shrink * e + pressure),
            moduli,
            shear_secant: 2.0 * shear * shrink,
            elastic: deviator.map(|e| shrink * e + pressure / (3.0 * bulk)),
            hardening: hardening + x / 3.0_f64.sqrt(),
            // tau : d eps_p = x (sqrt(J2) + eta-bar p), on the cone.
            plastic_work: x * (cohesive + (eta_bar - eta) * pressure),
            flows: true,
        }
    }
}

impl Material for DruckerPrager {
    fn name(&self) -> &str {
        "Drucker-Prager"
    }

    fn history_len(&self) -> usize {
        HISTORY
    }

    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        log_strain::respond(self, d, old, new)
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        log_strain::tangent(self, d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.moduli.wave()
    }

    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        log_strain::stiffness_bound(self, d, old)
    }
}

/// How the law is written in files.
#[derive(Serialize, Deserialize)]
#[serde(rename = "DruckerPrager", deny_unknown_fields)]
struct Record {
    young: f64,
    poisson: f64,
    cohesion: f64,
    friction_angle: f64,
    #[serde(default)]
    dilatancy_angle: f64,
}

impl From<DruckerPrager> for Record {
    fn from(law: DruckerPrager) -> Self {
        Self {
            young: law.moduli.young,
            poisson: law.moduli.poisson,
            cohesion: law.cohesion,
            friction_angle: law.friction_angle,
            dilatancy_angle: law.dilatancy_angle,
        }
    }
}

impl TryFrom<Record> for DruckerPrager {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        Self::new(
            record.young,
            record.poisson,
            record.cohesion,
            record.friction_angle,
            record.dilatancy_angle,
        )
    }
}
