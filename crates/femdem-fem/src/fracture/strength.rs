//! When a stress breaks a material, and along which planes.

use crate::error::{FemError, check};
use crate::material::spectral::{Spectral, range_around};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// How a crack opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum FractureMode {
    /// Pulled apart.
    Tension,
    /// Sheared off.
    Shear,
}

/// The planes along which a material fails first under a stress, by unit normals of either sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FailurePlanes {
    /// The plane of the largest principal stress.
    Tension(Vector3),
    /// The two planes of Mohr and Coulomb: their normals make the angle pi/4 + phi/2 with the direction of the smallest
    /// principal stress (the strongest compression), in the plane of the largest and the smallest.
    Shear([Vector3; 2]),
}

impl FailurePlanes {
    /// How a crack along them opens.
    #[must_use]
    pub fn mode(&self) -> FractureMode {
        match self {
            Self::Tension(_) => FractureMode::Tension,
            Self::Shear(_) => FractureMode::Shear,
        }
    }

    /// Their unit normals.
    #[must_use]
    pub fn normals(&self) -> &[Vector3] {
        match self {
            Self::Tension(normal) => std::slice::from_ref(normal),
            Self::Shear(normals) => normals,
        }
    }
}

/// Strength of a brittle material: Mohr-Coulomb with tension cut-off (Jaeger, Cook and Zimmerman, Fundamentals of Rock
/// Mechanics, 4th ed., sections 4.5 and 4.6).
///
/// ```
/// use femdem_fem::fracture::Strength;
/// use femdem_fem::mesh::{Matrix3, Vector3};
///
/// let rock = Strength::new(5e6, 20e6, 0.5)?;
/// let pressed = |stress: f64| Matrix3::from_diagonal(&Vector3::new(0.0, 0.0, -stress));
/// let strength = rock.compressive();
/// assert!((rock.ratio(&pressed(0.5 * strength)) - 0.5).abs() < 1e-12);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct Strength {
    tensile: f64,
    cohesion: f64,
    friction_angle: f64,
}

/// The stored form.
#[derive(Serialize, Deserialize)]
#[serde(rename = "Strength", deny_unknown_fields)]
struct Record {
    tensile: f64,
    cohesion: f64,
    friction_angle: f64,
}

impl TryFrom<Record> for Strength {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        Self::new(record.tensile, record.cohesion, record.friction_angle)
    }
}

impl From<Strength> for Record {
    fn from(strength: Strength) -> Self {
        Self {
            tensile: strength.tensile,
            cohesion: strength.cohesion,
            friction_angle: strength.friction_angle,
        }
    }
}

impl Strength {
    /// A material that breaks at a tension `tensile` (Pa), or where the shear stress of a plane reaches
    /// `cohesion` (Pa) plus pressure times the tangent of `friction_angle` (rad).
    ///
    /// # Errors
    ///
    /// [`FemError::Parameter`] unless cohesion > 0, 0 <= angle <= 1.5 and 0 < tensile <= cohesion / tan(angle), the
    /// tension that no plane can bear.
    pub fn new(tensile: f64, cohesion: f64, friction_angle: f64) -> Result<Self, FemError> {
        check("cohesion", cohesion, cohesion > 0.0, "positive (Pa)")?;
        let angle = friction_angle;
        let allowed = "from 0 to 1.5 rad";
        check(
            "friction angle",
            angle,
            (0.0..=1.5).contains(&angle),
            allowed,
        )?;
        let cut_off = tensile > 0.0 && tensile * angle.tan() <= cohesion;
        let allowed = "positive and at most cohesion / tan(friction angle) (Pa)";
        check("tensile strength", tensile, cut_off, allowed)?;
        Ok(Self {
            tensile,
            cohesion,
            friction_angle,
        })
    }

    /// Tensile strength, Pa.
    #[must_use]
    pub fn tensile(&self) -> f64 {
        self.tensile
    }

    /// Shear strength without pressure, Pa.
    #[must_use]
    pub fn cohesion(&self) -> f64 {
        self.cohesion
    }

    /// Angle of internal friction, rad.
    #[must_use]
    pub fn friction_angle(&self) -> f64 {
        self.friction_angle
    }

    /// Uniaxial compressive strength, 2 c cos phi / (1 - sin phi), Pa.
    #[must_use]
    pub fn compressive(&self) -> f64 {
        let (sin, cos) = self.friction_angle.sin_cos();
        2.0 * self.cohesion * cos / (1.0 - sin)
    }

    /// How much of the strength a Cauchy stress (Pa) uses up: the material fails at 1. The ratio grows in proportion
    /// to the stress. It is negative where no multiple of the stress breaks the material, as under pressure alone.
    #[must_use]
    pub fn ratio(&self, cauchy: &Matrix3) -> f64 {
        let [most, .., least] = principal(cauchy).map(|(value, _)| value);
        self.limits().ratio([least, most])
    }

    /// How much of the strength of a plane the tractions of pull and of shear (Pa) use up: those of a stress no more than its ratio.
    pub(super) fn ratio_across(&self, [pull, shear]: &[f64; 2]) -> f64 {
        let slide = shear + pull * self.friction_angle.tan();
        (pull / self.tensile).max(slide / self.cohesion)
    }

    /// The planes along which it fails first when this Cauchy stress grows in proportion.
    #[must_use]
    pub fn planes(&self, cauchy: &Matrix3) -> FailurePlanes {
        let [(most, first), .., (least, third)] = principal(cauchy);
        let limits = self.limits();
        if most * limits.tension >= limits.shear([least, most]) {
            return FailurePlanes::Tension(first);
        }
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 + 0.5 * self.friction_angle).sin_cos();
        FailurePlanes::Shear([third * cos + first * sin, third * cos - first * sin])
    }

    /// The factors of the principal stresses in the ratios.
    pub(super) fn limits(&self) -> Limits {
        let (sin, cos) = self.friction_angle.sin_cos();
        let twice = 2.0 * self.cohesion * cos;
        Limits {
            tension: 1.0 / self.tensile,
            pulled: (1.0 + sin) / twice,
            pressed: (1.0 - sin) / twice,
            deviator: (3.0 + sin * sin).sqrt() / twice,
        }
    }
}

/// Principal stresses with their directions, the largest (most tensile) first.
fn principal(cauchy: &Matrix3) -> [(f64, Vector3); 3] {
    let Spectral { values, vectors } = Spectral::of(cauchy);
    let mut all = [0, 1, 2].map(|i| (values[i], vectors.column(i).into()));
    all.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    all
}

/// Ratios of stress to strength as functions of the extreme principal stresses, 1/Pa.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    tension: f64,
    pulled: f64,
    pressed: f64,
    /// Of 2 sqrt p in the largest ratio of shear at a given mean and p.
    deviator: f64,
}

impl Limits {
    /// The shear stress of the worst plane, less friction, over cohesion: (s1 (1 + sin phi) - s3 (1 - sin phi)) / (2 c cos phi).
    fn shear(&self, [least, most]: [f64; 2]) -> f64 {
        self.pulled * most - self.pressed * least
    }

    fn ratio(&self, range: [f64; 2]) -> f64 {
        (self.tension * range[1]).max(self.shear(range))
    }

    /// An upper bound of the ratio, too large by 1 % at most of the ratio of the deviator; not finite if the stress is not.
    pub(super) fn bound(&self, cauchy: &Matrix3) -> f64 {
        self.ratio(range_around(cauchy))
    }

    /// An upper bound that costs a single root: exact in uniaxial tension, far too large in compression if the tensile strength
    /// is low. With the deviator's p of [`range_around`] the largest principal stress is at most
    /// mean + 2 sqrt p, and s1 - s3 = 2 sqrt(3 p) sin u, s1 + s3 = 2 mean + 2 sqrt p cos u for some angle u.
    #[inline]
    pub(super) fn rough_bound(&self, s: &Matrix3) -> f64 {
        let mean = (s.m11 + s.m22 + s.m33) / 3.0;
        let (a, b, c) = (s.m11 - mean, s.m22 - mean, s.m33 - mean);
        let off = s.m23 * s.m23 + s.m13 * s.m13 + s.m12 * s.m12;
        let twice_root = ((a * a + b * b + c * c + 2.0 * off) * (4.0 / 6.0)).sqrt();
        let shear = (self.pulled - self.pressed) * mean + self.deviator * twice_root;
        (self.tension * (mean + twice_root)).max(shear)
    }
}
