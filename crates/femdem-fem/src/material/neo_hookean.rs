//! The compressible neo-Hookean solid.

use super::moduli::ElasticRecord;
use super::{Deformation, Material, Moduli, Response, Tangent};
use crate::error::FemError;
use femdem_mesh::Matrix3;
use serde::{Deserialize, Serialize};

/// W = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J, so P = mu (F - F^-T) + lambda ln J F^-T and
/// tau = mu (b - I) + lambda ln J I (Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element
/// Analysis, 2nd ed., eqs. 6.27-6.29).
///
/// ```
/// use femdem_fem::material::{Deformation, Material, NeoHookean};
/// use femdem_mesh::Matrix3;
///
/// let rubber = NeoHookean::new(1e6, 0.3)?;
/// // In shear by gamma the shear stress is mu gamma at any strain.
/// let mut gradient = Matrix3::identity();
/// gradient[(0, 1)] = 0.5;
/// let response = rubber.respond(&Deformation::at_rest(gradient), &[], &mut []).ok_or("inverted")?;
/// assert!((response.piola[(0, 1)] / (0.5 * rubber.moduli().shear) - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ElasticRecord", into = "ElasticRecord")]
pub struct NeoHookean {
    moduli: Moduli,
}

impl NeoHookean {
    /// The solid with Young's modulus `young` in Pa and Poisson's ratio `poisson` at small strain.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0 and -1 < poisson < 0.5.
    pub fn new(young: f64, poisson: f64) -> Result<Self, FemError> {
        Ok(Self {
            moduli: Moduli::new(young, poisson)?,
        })
    }

    /// The moduli at small strain.
    #[inline]
    #[must_use]
    pub fn moduli(&self) -> &Moduli {
        &self.moduli
    }
}

/// Strains up to which the bound from the magnitude of strain is used. There ln J < 1, and the bound holds
/// for swelling too.
const WITHIN: f64 = 0.2;

impl Material for NeoHookean {
    fn name(&self) -> &str {
        "neo-Hookean"
    }

    #[inline]
    fn respond(&self, d: &Deformation, _old: &[f64], _new: &mut [f64]) -> Option<Response> {
        let Moduli { lambda, shear, .. } = self.moduli;
        let f = &d.gradient;
        let (cofactor, j) = cofactor(f);
        if j.is_nan() || j <= 0.0 {
            return None;
        }
        let strain = Strain::of(f);
        let log_j = strain.log_volume(j);
        let energy = shear * (strain.trace - log_j) + 0.5 * lambda * log_j * log_j;
        Response::elastic(
            energy,
            f * shear + cofactor * ((lambda * log_j - shear) / j),
        )
    }

    fn tangent(&self, d: &Deformation, _old: &[f64]) -> Option<Tangent> {
        let Moduli { lambda, shear, .. } = self.moduli;
        let j = d.volume_ratio()?;
        let g = cofactor(&d.gradient).0 / j; // F^-T
        let pressure_like = shear - lambda * j.ln();
        let mut tangent = Tangent::identity() * shear;
        for (row, (i, jj)) in entries().enumerate() {
            for (column, (k, l)) in entries().enumerate() {
                tangent[(row, column)] +=
                    lambda * g[(i, jj)] * g[(k, l)] + pressure_like * g[(k, jj)] * g[(i, l)];
            }
        }
        tangent.iter().all(|t| t.is_finite()).then_some(tangent)
    }

    fn wave_modulus(&self) -> f64 {
        self.moduli.wave()
    }

    /// With H = F^-1 G and q = mu - lambda ln J the tangent is mu |G|^2 + lambda (tr H)^2 + q tr(H H), and
    /// |H| <= |G|/s with the smallest stretch s. Where q < 0 (strongly swollen bodies) tr(H H) is (tr H)^2
    /// minus twice the second invariant of H, which is at most a third of the square of its nuclear norm.
    fn stiffness_bound(&self, d: &Deformation, _old: &[f64]) -> f64 {
        let Moduli { lambda, shear, .. } = self.moduli;
        let s2 = d.smallest_stretch2_bound();
        let q = shear - lambda * d.gradient.determinant().ln();
        let volumetric = if q < 0.0 {
            (lambda + q).max(0.0) - q / 1.5
        } else {
            lambda.max(0.0) + q
        };
        shear + volumetric / s2
    }
}

impl NeoHookean {
    /// The stiffness bound of any F with |F^T F - I| = `strain`; `None` where that is too large for a useful
    /// bound. The squares s^2 of the stretches are not less than 1 - strain, and -ln J is at most 3/2 (1 -
    /// s^2)/s^2 with the smallest of them.
    pub(crate) fn stiffness_bound_within(&self, strain: f64) -> Option<f64> {
        let Moduli { lambda, shear, .. } = self.moduli;
        let usable = strain < WITHIN && lambda >= 0.0;
        usable.then(|| {
            let s2 = 1.0 - strain;
            shear + (lambda + shear + 1.5 * lambda * strain / s2) / s2
        })
    }
}

impl From<NeoHookean> for ElasticRecord {
    fn from(law: NeoHookean) -> Self {
        law.moduli.into()
    }
}

impl TryFrom<ElasticRecord> for NeoHookean {
    type Error = FemError;

    fn try_from(record: ElasticRecord) -> Result<Self, FemError> {
        Self::new(record.young, record.poisson)
    }
}

/// Trace of E = (F^T F - I)/2, and J^2 - 1 from its invariants. From F's own invariants the energy of a
/// strain eps would be the difference of numbers near 1, with a relative error of 1e-16/eps^2; so it
/// is 1e-16/eps.
struct Strain {
    trace: f64,
    squared_volume_change: f64,
}

impl Strain {
    #[inline]
    fn of(f: &Matrix3) -> Self {
        let [a, b, c] = [f.column(0), f.column(1), f.column(2)];
        let [x, y, z] = [a.dot(&a), b.dot(&b), c.dot(&c)].map(|square| square - 1.0);
        let (yz, xz, xy) = (b.dot(&c), a.dot(&c), a.dot(&b));
        let minors = x * y + y * z + z * x - (yz * yz + xz * xz + xy * xy);
        let determinant = x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz);
        Self {
            trace: 0.5 * (x + y + z),
            squared_volume_change: x + y + z + minors + determinant,
        }
    }

    /// ln J.
    #[inline]
    fn log_volume(&self, j: f64) -> f64 {
        // With a trace below 1 no stretch is large, so that the terms of the invariants do not cancel.
        if self.squared_volume_change.abs() < 0.5 && self.trace < 1.0 {
            0.5 * self.squared_volume_change.ln_1p()
        } else {
            j.ln()
        }
    }
}

/// J F^-T and J = det F.
#[inline]
fn cofactor(f: &Matrix3) -> (Matrix3, f64) {
    let [a, b, c] = [f.column(0), f.column(1), f.column(2)];
    let first = b.cross(&c);
    let determinant = a.dot(&first);
    let cofactor = Matrix3::from_columns(&[first, c.cross(&a), a.cross(&b)]);
    (cofactor, determinant)
}

/// The pairs (i, J) in the order of a [`Tangent`]'s rows.
fn entries() -> impl Iterator<Item = (usize, usize)> {
    (0..9).map(|n| (n / 3, n % 3))
}
