//! The compressible Mooney-Rivlin solid.

use super::principal::{Frame, Principal};
use super::{Deformation, Material, Moduli, Response, Tangent};
use crate::error::{FemError, check};
use femdem_mesh::Matrix3;
use serde::{Deserialize, Serialize};

/// W = c10 (I1' - 3) + c01 (I2' - 3) + K/4 (J^2 - 1 - 2 ln J) with the invariants I1' = J^(-2/3) tr b and
/// I2' = J^(2/3) tr b^-1 of the isochoric part (Mooney, J. Appl. Phys. 11, 582 (1940); Rivlin 1948). The
/// volumetric term (Simo and Taylor, Comput. Methods Appl. Mech. Engrg. 51, 177 (1985)) grows without
/// bound both for J -> 0 and for J -> infinity and is convex in J: its pressure is K/2 (J - 1/J).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct MooneyRivlin {
    c10: f64,
    c01: f64,
    bulk: f64,
}

impl MooneyRivlin {
    /// The solid with Young's modulus `young` in Pa and Poisson's ratio `poisson` at small strain;
    /// `share` = c01/(c10 + c01) of the shear modulus mu = 2 (c10 + c01) comes from the second
    /// invariant (0 gives the isochoric neo-Hookean solid; rubber has 0.1 to 0.3).
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0, -1 < poisson < 0.5 and 0 <= share <= 1.
    pub fn new(young: f64, poisson: f64, share: f64) -> Result<Self, FemError> {
        let moduli = Moduli::new(young, poisson)?;
        check(
            "share",
            share,
            (0.0..=1.0).contains(&share),
            "between 0 and 1",
        )?;
        let half = 0.5 * moduli.shear;
        Self::from_constants(half * (1.0 - share), half * share, moduli.bulk)
    }

    /// The solid with the constants `c10`, `c01` and the bulk modulus `bulk`, all in Pa.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless c10, c01 >= 0, c10 + c01 > 0 and bulk > 0.
    pub fn from_constants(c10: f64, c01: f64, bulk: f64) -> Result<Self, FemError> {
        check("c10", c10, c10 >= 0.0, "finite and >= 0 Pa")?;
        check("c01", c01, c01 >= 0.0, "finite and >= 0 Pa")?;
        check("c10 + c01", c10 + c01, c10 + c01 > 0.0, "finite and > 0 Pa")?;
        check("bulk", bulk, bulk > 0.0, "finite and > 0 Pa")?;
        Ok(Self { c10, c01, bulk })
    }

    /// c10, c01 and the bulk modulus, Pa.
    #[must_use]
    pub fn constants(&self) -> [f64; 3] {
        [self.c10, self.c01, self.bulk]
    }

    /// In principal values, with the eigenvalues b' = J^(-2/3) b of the isochoric part:
    /// d b'_A / d eps_B = b'_A (2 delta_AB - 2/3).
    fn principal(&self, d: &Deformation) -> Option<(Frame, Principal)> {
        let frame = Frame::new(&d.gradient, &Matrix3::identity())?;
        let j = d.volume_ratio()?;
        let shrink = 1.0 / j.cbrt().powi(2);
        let iso = frame.b.values.map(|value| value * shrink);
        let (first, second) = (
            iso.iter().sum::<f64>(),
            iso.iter().map(|b| 1.0 / b).sum::<f64>(),
        );
        let (c10, c01) = (self.c10, self.c01);
        let pressure = 0.5 * self.bulk * (j * j - 1.0);
        let stress = iso.map(|b| {
            2.0 * c10 * (b - first / 3.0) - 2.0 * c01 * (1.0 / b - second / 3.0) + pressure
        });
        let shared = 4.0 / 9.0 * (c10 * first + c01 * second) + self.bulk * j * j;
        let weights = iso.map(|b| c10 * b + c01 / b);
        let row = |a: usize| {
            [0, 1, 2].map(|c| {
                let own = if a == c { 4.0 * weights[a] } else { 0.0 };
                own - 4.0 / 3.0 * (weights[a] + weights[c]) + shared
            })
        };
        let principal = Principal {
            stress,
            moduli: [row(0), row(1), row(2)],
            secants: iso.map(|b| 2.0 * shrink * (c10 + c01 * b)),
        };
        Some((frame, principal))
    }
}

impl Material for MooneyRivlin {
    fn name(&self) -> &str {
        "Mooney-Rivlin"
    }

    fn respond(&self, d: &Deformation, _old: &[f64], _new: &mut [f64]) -> Option<Response> {
        let f = &d.gradient;
        let j = d.volume_ratio()?;
        let inverse_t = f.try_inverse()?.transpose();
        let grow = j.cbrt().powi(2);
        let first = f.norm_squared() / grow;
        let second = inverse_t.norm_squared() * grow;
        let energy = self.c10 * (first - 3.0)
            + self.c01 * (second - 3.0)
            + 0.25 * self.bulk * (j * j - 1.0 - 2.0 * j.ln());
        let piola = (f / grow - inverse_t * (first / 3.0)) * (2.0 * self.c10)
            - (inverse_t * inverse_t.tr_mul(&inverse_t) * grow - inverse_t * (second / 3.0))
                * (2.0 * self.c01)
            + inverse_t * (0.5 * self.bulk * (j * j - 1.0));
        Response::elastic(energy, piola)
    }

    fn tangent(&self, d: &Deformation, _old: &[f64]) -> Option<Tangent> {
        let (frame, principal) = self.principal(d)?;
        frame.tangent(&principal)
    }

    fn wave_modulus(&self) -> f64 {
        self.bulk + 8.0 / 3.0 * (self.c10 + self.c01)
    }

    fn stiffness_bound(&self, d: &Deformation, _old: &[f64]) -> f64 {
        self.principal(d).map_or(f64::NAN, |(frame, principal)| {
            frame.stiffness_bound(&principal, &frame.inverse_stretches())
        })
    }
}

/// How the law is written in files.
#[derive(Serialize, Deserialize)]
#[serde(rename = "MooneyRivlin", deny_unknown_fields)]
struct Record {
    c10: f64,
    c01: f64,
    bulk: f64,
}

impl From<MooneyRivlin> for Record {
    fn from(law: MooneyRivlin) -> Self {
        let MooneyRivlin { c10, c01, bulk } = law;
        Self { c10, c01, bulk }
    }
}

impl TryFrom<Record> for MooneyRivlin {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        Self::from_constants(record.c10, record.c01, record.bulk)
    }
}
