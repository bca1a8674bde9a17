//! Scatter of strength.

use crate::error::{FemError, check};
use femdem_mesh::TetMesh;
use serde::{Deserialize, Serialize};

/// Scatter of strength after W. Weibull, J. Appl. Mech. 18 (1951) 293-297: the probability that the volume V bears the multiple f of
/// the strength is exp(-(V/V0) f^m). So the given strength is the *characteristic* one of the volume V0, reached by a part
/// 1/e of such volumes; their mean is Gamma(1 + 1/m) times it.
///
/// The factor of a node is a function of the seed, the body's key and the node's number, whatever else is drawn. A body whose
/// nodes hold shares of its volume is as strong under uniform stress as its weakest node, which follows the same law with
/// the whole volume, however fine the mesh.
///
/// ```
/// use femdem_fem::fracture::Weibull;
///
/// let scatter = Weibull::new(10.0, 1e-6, 1)?;
/// let small = scatter.factor(5, 17, 1e-9);
/// assert_eq!(small, scatter.factor(5, 17, 1e-9));
/// // A thousandth of the volume is stronger by 1000^(1/10).
/// assert!((small / scatter.factor(5, 17, 1e-6) - 1000_f64.powf(0.1)).abs() < 1e-12);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct Weibull {
    modulus: f64,
    volume: f64,
    seed: u64,
}

/// The stored form.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Weibull", deny_unknown_fields)]
struct Record {
    modulus: f64,
    volume: f64,
    seed: u64,
}

impl TryFrom<Record> for Weibull {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        Self::new(record.modulus, record.volume, record.seed)
    }
}

impl From<Weibull> for Record {
    fn from(scatter: Weibull) -> Self {
        Self {
            modulus: scatter.modulus,
            volume: scatter.volume,
            seed: scatter.seed,
        }
    }
}

impl Weibull {
    /// Scatter of the modulus m (the larger, the less scatter; 5 to 20 for rocks and ceramics) about the strength of the
    /// volume V0 in m^3.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] unless the modulus is at least 1 and the volume is positive.
    pub fn new(modulus: f64, volume: f64, seed: u64) -> Result<Self, FemError> {
        check("Weibull modulus", modulus, modulus >= 1.0, "at least 1")?;
        check("Weibull volume", volume, volume > 0.0, "positive (m^3)")?;
        Ok(Self {
            modulus,
            volume,
            seed,
        })
    }

    /// The modulus m.
    #[must_use]
    pub fn modulus(&self) -> f64 {
        self.modulus
    }

    /// The volume V0 to which the strength belongs, m^3.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The seed.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// By what the strength is multiplied at a node of the reference mesh with a share `volume` (m^3) of the body:
    /// (E V0/V)^(1/m) with an exponential variable E of mean 1. Infinite for a share of nothing.
    #[must_use]
    pub fn factor(&self, body: u64, node: u32, volume: f64) -> f64 {
        (exponential([self.seed, body, u64::from(node)]) * (self.volume / volume))
            .powf(1.0 / self.modulus)
    }

    /// The factor of every point of a mesh, whose shares are quarters of the tetrahedra around it.
    #[must_use]
    pub fn factors(&self, body: u64, mesh: &TetMesh) -> Vec<f64> {
        let mut shares = vec![0.0; mesh.points().len()];
        for tet in mesh.tets() {
            let [a, b, c, d] = tet.map(|i| mesh.points()[i as usize]);
            let volume = (b - a).dot(&(c - a).cross(&(d - a))) / 6.0;
            for &i in tet {
                shares[i as usize] += 0.25 * volume;
            }
        }
        let shares = (0..).zip(shares);
        shares
            .map(|(node, share)| self.factor(body, node, share))
            .collect()
    }
}

/// An exponential variable of mean 1, positive, from a key.
fn exponential(key: [u64; 3]) -> f64 {
    let bits = key.into_iter().fold(0, |state, word| mix(state ^ word));
    // The middle of one of 2^53 intervals of (0, 1).
    let uniform = ((bits >> 11) as f64 + 0.5) / (1_u64 << 53) as f64;
    -uniform.ln()
}

/// A step of SplitMix64 (G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014, 453-472): a bijection that mixes all bits.
fn mix(state: u64) -> u64 {
    let z = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
