//! The parameters of a contact law, named and validated.

use crate::bridge::LiquidBridge;
use crate::error::{ContactError, check, check_pressure};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// How a wall, which has no field, meets a body that deforms.
///
/// The contact energy of two bodies is p ∫ (φ_A + φ_B) dV over their overlap. Let A be the mirror image of B
/// in a plane, and B pass the plane by the depth d(x, y). Along a line normal to the plane φ_A + φ_B is 2 d/h
/// (h the length of the field) over the length 2 d of the overlap, so the energy is 4 p ∫ d²/h dx dy, half of
/// which belongs to B: 2 p ∫ d²/h dx dy. Over what passes the plane, ∫ φ_B dV = ∫ d²/(2 h) dx dy. A plane
/// that acts as the mirror image therefore has the energy 4 p ∫ φ_B dV; at 2 p ∫ φ_B dV the body goes into
/// it by twice that depth, as far as two equal bodies go into each other together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WallResponse {
    /// As the body's mirror image, 4 p ∫ φ_B dV: the wall adds no compliance to the body's own.
    #[default]
    Mirror,
    /// As it meets rigid bodies, 2 p ∫ φ_B dV: contacts keep the forces that they have there.
    Rigid,
}

/// Parameters of the contact law. Choose the penalty yourself: what is right depends on the load, so that its default
/// is right for none in particular.
///
/// ```
/// use femdem_contact::{ContactLaw, ContactParameters, restitution};
///
/// let stone = ContactParameters { penalty: 1e7, friction: 0.5, damping_ratio: 0.2, ..ContactParameters::default() };
/// ContactLaw::new(stone)?;
/// // What the damping ratio means: bodies rebound at this part of their speed.
/// assert!((restitution(0.2) - 0.572).abs() < 1e-3);
/// // Errors name the value and the range.
/// let refused = ContactLaw::new(ContactParameters { friction: -1.0, ..stone }).map(|_| ());
/// assert!(refused.is_err_and(|error| error.to_string().contains("friction = -1")));
/// # Ok::<(), femdem_contact::ContactError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ContactParameters {
    /// Penalty p, 1e-100 to 1e100 Pa: the scale of the contact energy U = p int (phi_A + phi_B) dV. Default 1e6.
    pub penalty: f64,
    /// Coulomb friction coefficient mu between bodies, and between bodies and walls where
    /// `wall_friction` is `None`. Default 0.6.
    pub friction: f64,
    /// Coulomb friction coefficient between bodies and walls; `None`, the default: `friction`.
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction mu_r: the moment against rolling is at most mu_r N r, with the rolling radius r
    /// ([`RigidContact::rolling_radius`](crate::RigidContact::rolling_radius)). Default 0.
    pub rolling_friction: f64,
    /// Fraction zeta of critical damping of the normal contact; below 1/sqrt(2). Default 0.6.
    pub damping_ratio: f64,
    /// Tangential over normal foundation modulus, r = k_t/k_n; above 0, at most 2. Default 0.8.
    pub tangential_ratio: f64,
    /// Fraction of critical damping of the tangential and torsional springs while they stick, 0 to 1. Default 0.6.
    pub tangential_damping: f64,
    /// How walls meet bodies that deform. Default: as mirror images.
    pub wall_response: WallResponse,
    /// Cohesion c of rigid bodies, Pa: an attraction by this stress over the contact area, with the energy -c V for an overlap
    /// of the volume V. Faces of the area A pull off at c A. Default 0.
    pub cohesion: f64,
    /// Work of adhesion w of balls with balls and planes, J/m^2: they pull off at 3/2 pi w R, R the reduced radius. Default 0.
    pub adhesion_energy: f64,
    /// Liquid bridges of balls with balls and planes that have touched. Default: none.
    pub liquid_bridge: Option<LiquidBridge>,
}

impl Default for ContactParameters {
    fn default() -> Self {
        Self {
            penalty: 1e6,
            friction: 0.6,
            wall_friction: None,
            rolling_friction: 0.0,
            damping_ratio: 0.6,
            tangential_ratio: 0.8,
            tangential_damping: 0.6,
            wall_response: WallResponse::Mirror,
            cohesion: 0.0,
            adhesion_energy: 0.0,
            liquid_bridge: None,
        }
    }
}

impl ContactParameters {
    /// Whether contacts attract.
    #[must_use]
    pub fn attracts(&self) -> bool {
        self.cohesion > 0.0 || self.adhesion_energy > 0.0 || self.bridge().is_some()
    }

    /// The liquid bridge, if it pulls.
    pub(crate) fn bridge(&self) -> Option<&LiquidBridge> {
        self.liquid_bridge
            .as_ref()
            .filter(|bridge| bridge.tension > 0.0)
    }

    /// The gap up to which bodies attract each other, m: where a liquid bridge breaks.
    pub(crate) fn attraction_range(&self) -> f64 {
        self.bridge().map_or(0.0, LiquidBridge::rupture_distance)
    }

    /// The work of adhesion by which round bodies would pull off as they do by adhesion and a liquid bridge together, J/m^2:
    /// 3/2 pi w R is what both pull where bodies touch.
    #[must_use]
    pub fn work_of_adhesion(&self) -> f64 {
        let pull = self
            .bridge()
            .map_or(0.0, |bridge| bridge.largest_force(1.0));
        self.adhesion_energy + pull / (1.5 * PI)
    }

    /// The law between bodies and walls: the same with the friction of the walls.
    #[must_use]
    pub fn at_walls(&self) -> Self {
        Self {
            friction: self.wall_friction.unwrap_or(self.friction),
            ..*self
        }
    }
}

/// A validated contact law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ContactParameters", into = "ContactParameters")]
pub struct ContactLaw {
    parameters: ContactParameters,
}

impl ContactLaw {
    /// Validates the parameters.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] names the first parameter out of its range.
    pub fn new(parameters: ContactParameters) -> Result<Self, ContactError> {
        let p = &parameters;
        check_pressure("penalty", p.penalty)?;
        check(
            "friction",
            p.friction,
            p.friction >= 0.0,
            "at least 0 and finite",
        )?;
        if let Some(friction) = p.wall_friction {
            check(
                "wall_friction",
                friction,
                friction >= 0.0,
                "at least 0 and finite",
            )?;
        }
        check(
            "rolling_friction",
            p.rolling_friction,
            p.rolling_friction >= 0.0,
            "at least 0 and finite",
        )?;
        check(
            "damping_ratio",
            p.damping_ratio,
            (0.0..std::f64::consts::FRAC_1_SQRT_2).contains(&p.damping_ratio),
            "at least 0 and below 0.7071",
        )?;
        check(
            "tangential_ratio",
            p.tangential_ratio,
            p.tangential_ratio > 0.0 && p.tangential_ratio <= 2.0,
            "above 0 and at most 2: tangential over normal stiffness",
        )?;
        check(
            "tangential_damping",
            p.tangential_damping,
            (0.0..=1.0).contains(&p.tangential_damping),
            "between 0 and 1",
        )?;
        check(
            "cohesion",
            p.cohesion,
            (0.0..=1e100).contains(&p.cohesion),
            "from 0 to 1e100 Pa",
        )?;
        check(
            "adhesion_energy",
            p.adhesion_energy,
            (0.0..=1e100).contains(&p.adhesion_energy),
            "from 0 to 1e100 J/m^2",
        )?;
        if let Some(bridge) = &p.liquid_bridge {
            bridge.validate()?;
        }
        Ok(Self { parameters })
    }

    /// The parameters.
    pub fn parameters(&self) -> &ContactParameters {
        &self.parameters
    }

    pub(crate) fn without_dashpots(mut self) -> Self {
        self.parameters.damping_ratio = 0.0;
        self.parameters.tangential_damping = 0.0;
        self
    }
}

impl TryFrom<ContactParameters> for ContactLaw {
    type Error = ContactError;

    fn try_from(parameters: ContactParameters) -> Result<Self, ContactError> {
        Self::new(parameters)
    }
}

impl From<ContactLaw> for ContactParameters {
    fn from(law: ContactLaw) -> Self {
        law.parameters
    }
}

/// Coefficient of restitution of a normal impact with damping ratio `zeta`, when the
/// contact carries no tension (physics of a linear oscillator clipped at zero force;
/// with the energy-based dashpot it holds for face, edge and vertex contacts alike). `zeta` is from 0
/// to below 1; NaN or infinite outside.
pub fn restitution(zeta: f64) -> f64 {
    let root = (1.0 - zeta * zeta).sqrt();
    let angle = std::f64::consts::PI - (2.0 * zeta * root).atan2(1.0 - 2.0 * zeta * zeta);
    (-zeta / root * angle).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values published with the formula: 0.1 -> 0.7441, 0.3 -> 0.4510, 0.6 -> 0.2488.
    #[test]
    fn restitution_of_the_published_damping_ratios() {
        for (zeta, e) in [(0.1, 0.7441), (0.3, 0.4510), (0.6, 0.2488)] {
            assert!((restitution(zeta) - e).abs() < 5e-5, "zeta {zeta}");
        }
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let bad = |f: fn(&mut ContactParameters)| {
            let mut p = ContactParameters::default();
            f(&mut p);
            ContactLaw::new(p).unwrap_err().to_string()
        };
        assert!(bad(|p| p.penalty = 0.0).contains("penalty = 0"));
        assert!(bad(|p| p.friction = -0.1).contains("friction = -0.1"));
        assert!(bad(|p| p.friction = f64::NAN).contains("friction = NaN"));
        assert!(bad(|p| p.wall_friction = Some(-0.1)).contains("wall_friction = -0.1"));
        assert!(bad(|p| p.wall_friction = Some(f64::INFINITY)).contains("wall_friction = inf"));
        assert!(bad(|p| p.damping_ratio = 0.8).contains("below 0.7071"));
        assert!(bad(|p| p.tangential_ratio = 0.0).contains("tangential_ratio"));
    }
}
