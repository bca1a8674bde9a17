//! Elastic moduli at small strain.

use crate::error::{FemError, check};

/// The moduli of an isotropic solid at small strain, Pa, from Young's modulus and Poisson's ratio.
///
/// ```
/// use femdem_fem::material::Moduli;
///
/// let steel = Moduli::new(210e9, 0.3)?;
/// assert!((steel.shear / 80.77e9 - 1.0).abs() < 1e-4);
/// assert!((steel.bulk / 175e9 - 1.0).abs() < 1e-12);
/// // Poisson's ratio has to be below 0.5.
/// assert!(Moduli::new(1e6, 0.5).is_err());
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio nu.
    pub poisson: f64,
    /// Lame's first parameter lambda = E nu / ((1 + nu) (1 - 2 nu)), Pa.
    pub lambda: f64,
    /// Shear modulus mu = E / (2 (1 + nu)), Pa.
    pub shear: f64,
    /// Bulk modulus K = E / (3 (1 - 2 nu)), Pa.
    pub bulk: f64,
}

impl Moduli {
    /// The moduli for `young` in Pa and `poisson`.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0 and -1 < poisson < 0.5.
    pub fn new(young: f64, poisson: f64) -> Result<Self, FemError> {
        check("young", young, young > 0.0, "finite and > 0 Pa")?;
        let in_range = poisson > -1.0 && poisson < 0.5;
        let allowed = "between -1 and 0.5, both excluded (for rubber take 0.4999)";
        check("poisson", poisson, in_range, allowed)?;
        let shear = young / (2.0 * (1.0 + poisson));
        Ok(Self {
            young,
            poisson,
            lambda: 2.0 * shear * poisson / (1.0 - 2.0 * poisson),
            shear,
            bulk: young / (3.0 * (1.0 - 2.0 * poisson)),
        })
    }

    /// lambda + 2 mu: the modulus of a plane compression wave, Pa.
    #[must_use]
    pub fn wave(&self) -> f64 {
        self.lambda + 2.0 * self.shear
    }

    /// All moduli times a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            young: factor * self.young,
            poisson: self.poisson,
            lambda: factor * self.lambda,
            shear: factor * self.shear,
            bulk: factor * self.bulk,
        }
    }
}

/// How an elastic law is written in files.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ElasticRecord {
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl From<Moduli> for ElasticRecord {
    fn from(moduli: Moduli) -> Self {
        Self {
            young: moduli.young,
            poisson: moduli.poisson,
        }
    }
}
