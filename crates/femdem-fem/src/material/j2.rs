//! J2 (von Mises) plasticity with isotropic hardening.

use super::log_strain::{self, HISTORY, LogStrain, Returned, isotropic, split};
use super::{Deformation, Material, Moduli, Response, Tangent};
use crate::error::{FemError, check};
use serde::{Deserialize, Serialize};

/// Hencky elasticity with the yield function sqrt(3/2) |dev tau| - sigma_y(alpha) and the hardening
/// sigma_y = s0 + H alpha + (s_inf - s0)(1 - exp(-delta alpha)) in the equivalent plastic strain alpha
/// (linear, with an optional Voce term). Multiplicative, associated, isochoric flow; the return map is
/// radial and exact (Simo and Hughes, Computational Inelasticity, boxes 3.1 and 9.1).
///
/// Stresses are Kirchhoff stresses, which differ from true ones by J, close to 1 for metals.
/// `energy` is the elastic energy alone; all plastic work, the integral of sigma_y d alpha, is dissipated.
/// History: C_p^-1 - I (xx, yy, zz, yz, xz, xy) and alpha, seven numbers.
///
/// ```
/// use femdem_fem::material::{J2, Voce};
///
/// // Copper: yields at 90 MPa, hardens towards 290 MPa, then linearly.
/// let copper = J2::new(117e9, 0.35, 90e6, 100e6)?.with_saturation(Voce { stress: 290e6, rate: 10.0 })?;
/// assert_eq!(copper.yield_stress(0.0), 90e6);
/// assert!((copper.yield_stress(1.0) / 390e6 - 1.0).abs() < 1e-3);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct J2 {
    moduli: Moduli,
    yield_stress: f64,
    hardening: f64,
    saturation: Option<Voce>,
}

/// The saturating part of hardening.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Voce {
    /// s_inf, Pa: the limit of the yield stress at large strain without linear hardening.
    pub stress: f64,
    /// delta, per unit of plastic strain: the rate at which it is approached.
    pub rate: f64,
}

impl J2 {
    /// Linear hardening: yield stress s0 = `yield_stress` in Pa and modulus H = `hardening` in Pa.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0, -1 < poisson < 0.5, yield_stress > 0 and hardening >= 0
    /// (softening without a length scale has no mesh-independent solution).
    pub fn new(
        young: f64,
        poisson: f64,
        yield_stress: f64,
        hardening: f64,
    ) -> Result<Self, FemError> {
        let moduli = Moduli::new(young, poisson)?;
        check(
            "yield_stress",
            yield_stress,
            yield_stress > 0.0,
            "finite and > 0 Pa",
        )?;
        check(
            "hardening",
            hardening,
            hardening >= 0.0,
            "finite and >= 0 Pa",
        )?;
        Ok(Self {
            moduli,
            yield_stress,
            hardening,
            saturation: None,
        })
    }

    /// The same with a Voce term.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless voce.stress is not below the yield stress and voce.rate > 0.
    pub fn with_saturation(mut self, voce: Voce) -> Result<Self, FemError> {
        let rises = voce.stress >= self.yield_stress;
        check(
            "saturation stress",
            voce.stress,
            rises,
            "at least the yield stress, in Pa",
        )?;
        check(
            "saturation rate",
            voce.rate,
            voce.rate > 0.0,
            "finite and > 0",
        )?;
        self.saturation = Some(voce);
        Ok(self)
    }

    /// The elastic moduli.
    #[must_use]
    pub fn moduli(&self) -> &Moduli {
        &self.moduli
    }

    /// sigma_y, Pa, at the equivalent plastic strain `alpha`.
    #[must_use]
    pub fn yield_stress(&self, alpha: f64) -> f64 {
        let voce = self.saturation.map_or(0.0, |voce| {
            (self.yield_stress - voce.stress) * (-voce.rate * alpha).exp_m1()
        });
        self.yield_stress + self.hardening * alpha + voce
    }

    /// d sigma_y / d alpha, Pa.
    fn slope(&self, alpha: f64) -> f64 {
        let voce = self.saturation.map_or(0.0, |voce| {
            (voce.stress - self.yield_stress) * voce.rate * (-voce.rate * alpha).exp()
        });
        self.hardening + voce
    }

    /// The integral of sigma_y from `alpha` over `increment`, J/m^3.
    fn work(&self, alpha: f64, increment: f64) -> f64 {
        let linear = self.yield_stress + self.hardening * (alpha + 0.5 * increment);
        let voce = self.saturation.map_or(0.0, |voce| {
            let decay = (-voce.rate * alpha).exp() * (-voce.rate * increment).exp_m1();
            (voce.stress - self.yield_stress) * (increment + decay / voce.rate)
        });
        linear * increment + voce
    }

    /// The root x of q - 3 mu x - sigma_y(alpha + x) = 0 for a trial stress q beyond yield. The left side
    /// decreases and is convex, so Newton iterates from 0 increase towards the root and never pass it. Linear
    /// hardening takes one iteration, Voce hardening about ten, and 40 if the exponential has vanished at the
    /// root.
    fn plastic_increment(&self, q: f64, alpha: f64) -> f64 {
        const STEPS: usize = 100;
        let three_mu = 3.0 * self.moduli.shear;
        let mut x = 0.0;
        for _ in 0..STEPS {
            let residual = q - three_mu * x - self.yield_stress(alpha + x);
            let step = residual / (three_mu + self.slope(alpha + x));
            x += step;
            if self.saturation.is_none() || step <= f64::EPSILON * x {
                break;
            }
        }
        x
    }
}

impl LogStrain for J2 {
    fn moduli(&self, _hardening: f64) -> Moduli {
        self.moduli
    }

    /// Radial return: dev tau = (1 - 3 mu x/q) times its trial value.
    fn return_map(&self, trial: &[f64; 3], alpha: f64) -> Returned {
        let elastic = Returned::elastic(&self.moduli, trial, alpha);
        let Moduli { bulk, shear, .. } = self.moduli;
        let (dilation, deviator) = split(trial);
        let size = deviator.iter().map(|e| e * e).sum::<f64>().sqrt();
        let q = 6.0_f64.sqrt() * shear * size;
        if q <= self.yield_stress(alpha) {
            return elastic;
        }
        let x = self.plastic_increment(q, alpha);
        let shrink = 1.0 - 3.0 * shear * x / q;
        let normal = deviator.map(|e| e / size);
        let mut moduli = isotropic(bulk, 2.0 * shear * shrink);
        let along = x / q - 1.0 / (3.0 * shear + self.slope(alpha + x));
        for (row, n) in moduli.iter_mut().zip(normal) {
            for (entry, m) in row.iter_mut().zip(normal) {
                *entry += 6.0 * shear * shear * along * n * m;
            }
        }
        Returned {
            stress: deviator.map(|e| 2.0 * shear * shrink * e + bulk * dilation),
            moduli,
            shear_secant: 2.0 * shear * shrink,
            elastic: deviator.map(|e| shrink * e + dilation / 3.0),
            hardening: alpha + x,
            plastic_work: self.work(alpha, x),
            flows: true,
        }
    }
}

impl Material for J2 {
    fn name(&self) -> &str {
        "J2 plasticity"
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
#[serde(rename = "J2", deny_unknown_fields)]
struct Record {
    young: f64,
    poisson: f64,
    yield_stress: f64,
    #[serde(default)]
    hardening: f64,
    #[serde(default)]
    saturation: Option<Voce>,
}

impl From<J2> for Record {
    fn from(law: J2) -> Self {
        Self {
            young: law.moduli.young,
            poisson: law.moduli.poisson,
            yield_stress: law.yield_stress,
            hardening: law.hardening,
            saturation: law.saturation,
        }
    }
}

impl TryFrom<Record> for J2 {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        let law = Self::new(
            record.young,
            record.poisson,
            record.yield_stress,
            record.hardening,
        )?;
        match record.saturation {
            Some(voce) => law.with_saturation(voce),
            None => Ok(law),
        }
    }
}
