//! Scatter of strength.

use crate::error::{FemError, check};
use serde::{Deserialize, Serialize};

/// The law of the weakest link: of pieces of volume V the part exp(−(V/V_0) (σ/σ_0)^m) survives a stress σ, where σ_0 is the
/// given strength (Weibull 1939). So σ_0 is that stress at which 63 % of pieces of volume V_0 fail; their mean strength is
/// Γ(1 + 1/m) σ_0.
///
/// The factor of a place depends on the seed, the body and the number of the place in its mesh alone, so that fragments keep
/// theirs.
///
/// ```
/// use femdem_fem::fracture::Weibull;
///
/// let scatter = Weibull::new(3.0, 1e-9, 7)?;
/// // Of places of 1 mm³, 63 % are weaker than the given strength.
/// let weak = (0..10_000).filter(|node| scatter.factor(0, *node, 1e-9) < 1.0).count();
/// assert!((weak as f64 / 1e4 - 0.632).abs() < 0.01);
/// // Smaller places are stronger.
/// assert!((scatter.factor(0, 5, 1e-12) / scatter.factor(0, 5, 1e-9) - 10.0).abs() < 1e-12);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Weibull {
    modulus: f64,
    volume: f64,
    seed: u64,
}

/// A scatter as read, before its numbers are checked.
#[derive(Deserialize)]
#[serde(rename = "Weibull", deny_unknown_fields)]
struct Stored {
    modulus: f64,
    volume: f64,
    seed: u64,
}

impl TryFrom<Stored> for Weibull {
    type Error = FemError;

    fn try_from(stored: Stored) -> Result<Self, FemError> {
        Self::new(stored.modulus, stored.volume, stored.seed)
    }
}

impl Weibull {
    /// A modulus m, the volume V_0 for which the strength is given (m³), and a seed.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] unless the modulus is at least 1 and the volume positive, both finite.
    pub fn new(modulus: f64, volume: f64, seed: u64) -> Result<Self, FemError> {
        let allowed = "at least 1 and finite";
        check("Weibull modulus", modulus, modulus >= 1.0, allowed)?;
        let allowed = "above 0 and finite, in m^3";
        check("volume of the strength", volume, volume > 0.0, allowed)?;
        Ok(Self {
            modulus,
            volume,
            seed,
        })
    }

    /// Modulus m.
    #[must_use]
    pub fn modulus(&self) -> f64 {
        self.modulus
    }

    /// The strength over the given one at place `node` of a body, whose volume is `volume` (m³).
    #[must_use]
    pub fn factor(&self, body: u64, node: u32, volume: f64) -> f64 {
        let key = mixed(self.seed ^ mixed(body ^ mixed(u64::from(node))));
        // Within (0, 1).
        let uniform = ((key >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
        (-(1.0 - uniform).ln() * self.volume / volume).powf(1.0 / self.modulus)
    }
}

/// Spreads the bits of a counter (the finaliser of SplitMix64: Steele, Lea and Flood 2014).
fn mixed(key: u64) -> u64 {
    let z = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
