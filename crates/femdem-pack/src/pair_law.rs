//! Contact laws of pairs of materials.

use femdem_contact::{ContactParameters, LiquidBridge, MaterialId};
use serde::{Deserialize, Serialize};

/// What the contact law of two materials, or of a material and itself, has of its own. `None`: as the law of all others.
///
/// ```
/// use femdem_contact::ContactParameters;
/// use femdem_pack::PairLaw;
///
/// let smooth = PairLaw { friction: Some(0.1), ..PairLaw::default() };
/// let usual = ContactParameters { friction: 0.6, wall_friction: Some(0.3), ..ContactParameters::default() };
/// let law = smooth.over(&usual);
/// // A friction of its own is that with walls, too.
/// assert_eq!((law.friction, law.wall_friction, law.penalty), (0.1, None, usual.penalty));
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PairLaw {
    /// The two materials, in either order.
    pub materials: [MaterialId; 2],
    /// Penalty, Pa.
    pub penalty: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: Option<f64>,
    /// Coulomb friction coefficient between bodies and walls. `None`: `friction`, if that is given.
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction.
    pub rolling_friction: Option<f64>,
    /// Fraction of critical damping of the normal contact.
    pub damping_ratio: Option<f64>,
    /// Tangential over normal foundation modulus.
    pub tangential_ratio: Option<f64>,
    /// Fraction of critical damping of the tangential springs.
    pub tangential_damping: Option<f64>,
    /// Cohesion, Pa.
    pub cohesion: Option<f64>,
    /// Work of adhesion of balls with balls and planes, J/m^2.
    pub adhesion_energy: Option<f64>,
    /// Liquid bridges of balls with balls and planes.
    pub liquid_bridge: Option<LiquidBridge>,
}

impl PairLaw {
    /// Whether these are its two materials, in either order.
    #[must_use]
    pub fn is_of(&self, [a, b]: [MaterialId; 2]) -> bool {
        self.materials == [a, b] || self.materials == [b, a]
    }

    /// The law, where `usual` is that of all others.
    #[must_use]
    pub fn over(&self, usual: &ContactParameters) -> ContactParameters {
        let wall_friction = match self.friction {
            Some(_) => self.wall_friction,
            None => self.wall_friction.or(usual.wall_friction),
        };
        ContactParameters {
            penalty: self.penalty.unwrap_or(usual.penalty),
            friction: self.friction.unwrap_or(usual.friction),
            wall_friction,
            rolling_friction: self.rolling_friction.unwrap_or(usual.rolling_friction),
            damping_ratio: self.damping_ratio.unwrap_or(usual.damping_ratio),
            tangential_ratio: self.tangential_ratio.unwrap_or(usual.tangential_ratio),
            tangential_damping: self.tangential_damping.unwrap_or(usual.tangential_damping),
            cohesion: self.cohesion.unwrap_or(usual.cohesion),
            adhesion_energy: self.adhesion_energy.unwrap_or(usual.adhesion_energy),
            liquid_bridge: self.liquid_bridge.or(usual.liquid_bridge),
            ..*usual
        }
    }
}
