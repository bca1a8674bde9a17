//! When, and along which planes, a material fails.

use crate::error::{FemError, check};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// By which criterion a material fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FractureMode {
    /// The largest principal stress reaches the tensile strength.
    Tension,
    /// Shear reaches the strength of Mohr and Coulomb.
    Shear,
}

/// The strength of Mohr and Coulomb with a cut-off of tension: a material fails where the largest principal stress reaches
/// the tensile strength f, or where on some plane the shear reaches c + p tan φ, with the pressure p on it.
///
/// ```
/// use femdem_fem::fracture::{FractureMode, Strength};
/// use femdem_mesh::{Matrix3, Vector3};
///
/// let rock = Strength::new(5e6, 20e6, 0.8_f64.atan())?;
/// // Compressed along z without support it fails at 2 c cos φ/(1 - sin φ) = 83.2 MPa,
/// let pressed = Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, -83.2e6));
/// assert!((rock.ratio(&pressed) - 1.0).abs() < 1e-3);
/// // along planes whose normals are 45° + φ/2 = 64.3° from z.
/// let (mode, normals) = rock.planes(&pressed);
/// assert_eq!(mode, FractureMode::Shear);
/// assert!(normals.iter().all(|n| (n.z.abs().acos().to_degrees() - 64.3).abs() < 0.1));
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Strength {
    tensile: f64,
    cohesion: f64,
    friction_angle: f64,
}

/// A strength as read, before its numbers are checked.
#[derive(Deserialize)]
#[serde(rename = "Strength", deny_unknown_fields)]
struct Stored {
    tensile: f64,
    cohesion: f64,
    friction_angle: f64,
}

impl TryFrom<Stored> for Strength {
    type Error = FemError;

    fn try_from(stored: Stored) -> Result<Self, FemError> {
        Self::new(stored.tensile, stored.cohesion, stored.friction_angle)
    }
}

impl Strength {
    /// A tensile strength f and a cohesion c, Pa, and an angle of friction φ, rad.
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] unless f and c are positive and finite, and φ is at least 0 and below π/2.
    pub fn new(tensile: f64, cohesion: f64, friction_angle: f64) -> Result<Self, FemError> {
        let positive = "above 0 and finite, in Pa";
        check("tensile strength", tensile, tensile > 0.0, positive)?;
        check("cohesion", cohesion, cohesion > 0.0, positive)?;
        let range = 0.0..FRAC_PI_2;
        check(
            "angle of friction",
            friction_angle,
            range.contains(&friction_angle),
            "at least 0 and below π/2, in rad",
        )?;
        Ok(Self {
            tensile,
            cohesion,
            friction_angle,
        })
    }

    /// Tensile strength f, Pa.
    #[must_use]
    pub fn tensile(&self) -> f64 {
        self.tensile
    }

    /// Cohesion c, Pa.
    #[must_use]
    pub fn cohesion(&self) -> f64 {
        self.cohesion
    }

    /// Angle of friction φ, rad.
    #[must_use]
    pub fn friction_angle(&self) -> f64 {
        self.friction_angle
    }

    /// Strength in compression without support from the sides, 2 c cos φ/(1 − sin φ), Pa.
    #[must_use]
    pub fn compressive(&self) -> f64 {
        let (sin, cos) = self.friction_angle.sin_cos();
        2.0 * self.cohesion * cos / (1.0 - sin)
    }

    /// The smallest |σ| with which it fails, Pa: f, or the distance of the plane (1 + sin φ) σ_1 − (1 − sin φ) σ_3 = 2 c cos φ.
    #[must_use]
    pub fn least(&self) -> f64 {
        let (sin, cos) = self.friction_angle.sin_cos();
        let shear = 2.0 * self.cohesion * cos / (1.0 + sin).hypot(1.0 - sin);
        self.tensile.min(shear)
    }

    /// Stress over strength, at least 0 and 1 where it fails: the larger of σ_1/f and ((1 + sin φ) σ_1 − (1 − sin φ) σ_3)/(2 c cos φ)
    /// with the principal stresses σ_1 ≥ σ_3, tension positive.
    #[must_use]
    pub fn ratio(&self, cauchy: &Matrix3) -> f64 {
        let symmetric = (cauchy + cauchy.transpose()) * 0.5;
        let values = symmetric.symmetric_eigenvalues();
        let [tension, shear] = self.ratios(values.max(), values.min());
        tension.max(shear).max(0.0)
    }

    fn ratios(&self, most: f64, least: f64) -> [f64; 2] {
        let (sin, cos) = self.friction_angle.sin_cos();
        let shear = (1.0 + sin) * most - (1.0 - sin) * least;
        [most / self.tensile, shear / (2.0 * self.cohesion * cos)]
    }

    /// An upper bound of [`ratio`](Self::ratio) that is cheap, and convex in the stress: the mean of stresses is within the largest
    /// of their bounds. With the mean p = tr σ/3 and J_2 = s:s/2 of the deviator s, σ_1 ≤ p + 2 √(J_2/3),
    /// σ_1 − σ_3 ≤ 2 √J_2 and σ_1 + σ_3 ≤ 2 p + √(J_2/3).
    pub(super) fn bound(&self, cauchy: &Matrix3) -> f64 {
        let mean = cauchy.trace() / 3.0;
        let deviator = cauchy - Matrix3::from_diagonal_element(mean);
        let root = (0.5 * deviator.norm_squared()).sqrt();
        let third = root / 3_f64.sqrt();
        let (sin, cos) = self.friction_angle.sin_cos();
        let shear = 2.0 * root + sin * (2.0 * mean + third);
        let tension = (mean + 2.0 * third) / self.tensile;
        tension.max(shear / (2.0 * self.cohesion * cos))
    }

    /// By which criterion it fails first under a stress, and the unit normals of the planes: in tension one, along the largest
    /// principal stress; in shear two, 45° − φ/2 from it towards the smallest.
    #[must_use]
    pub fn planes(&self, cauchy: &Matrix3) -> (FractureMode, Vec<Vector3>) {
        let eigen = ((cauchy + cauchy.transpose()) * 0.5).symmetric_eigen();
        let (first, last) = (eigen.eigenvalues.imax(), eigen.eigenvalues.imin());
        let [tension, shear] = self.ratios(eigen.eigenvalues[first], eigen.eigenvalues[last]);
        let axis = |i: usize| eigen.eigenvectors.column(i).into_owned();
        if tension >= shear || first == last {
            return (FractureMode::Tension, vec![axis(first)]);
        }
        let (sin, cos) = (FRAC_PI_4 - 0.5 * self.friction_angle).sin_cos();
        let [along, across] = [axis(first) * cos, axis(last) * sin];
        (FractureMode::Shear, vec![along + across, along - across])
    }
}
