//! The contact law.

use std::mem::MaybeUninit;

use femdem_solve::contact::{ContactLaw, ContactParameters, LiquidBridge, MaterialId};

use crate::border::{Failure, FemdemStatus, border, place};

/// How bodies meet each other and walls. Begin with femdem_law_default.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemLaw {
    /// Penalty p, from 1e-100 to 1e100 Pa: the contact energy is p times the integral of both fields over the overlap.
    pub penalty: f64,
    /// Coulomb's coefficient of friction, at least 0.
    pub friction: f64,
    /// The same between bodies and walls; NaN, the default, stands for that between bodies.
    pub wall_friction: f64,
    /// Coefficient of rolling friction, at least 0.
    pub rolling_friction: f64,
    /// Part of the critical damping of the normal contact, from 0 to below 0.7071.
    pub damping_ratio: f64,
    /// Tangential over normal stiffness, above 0, at most 2.
    pub tangential_ratio: f64,
    /// Part of the critical damping of the friction springs, from 0 to 1.
    pub tangential_damping: f64,
    /// Cohesion, Pa: an attraction by this stress over the contact area.
    pub cohesion: f64,
    /// Work of adhesion of balls with balls and planes, J/m^2.
    pub adhesion_energy: f64,
    /// Volume of the liquid bridges of balls that have touched, m^3; 0: no bridges.
    pub bridge_volume: f64,
    /// Surface tension of the bridges, N/m.
    pub bridge_tension: f64,
    /// Contact angle of the bridges, from 0 to below pi/2, rad.
    pub bridge_angle: f64,
}

impl FemdemLaw {
    pub(crate) fn parameters(&self) -> ContactParameters {
        let bridge = LiquidBridge {
            volume: self.bridge_volume,
            tension: self.bridge_tension,
            contact_angle: self.bridge_angle,
        };
        ContactParameters {
            penalty: self.penalty,
            friction: self.friction,
            wall_friction: (!self.wall_friction.is_nan()).then_some(self.wall_friction),
            rolling_friction: self.rolling_friction,
            damping_ratio: self.damping_ratio,
            tangential_ratio: self.tangential_ratio,
            tangential_damping: self.tangential_damping,
            cohesion: self.cohesion,
            adhesion_energy: self.adhesion_energy,
            liquid_bridge: (self.bridge_volume != 0.0).then_some(bridge),
            ..ContactParameters::default()
        }
    }

    pub(crate) fn law(&self) -> Result<ContactLaw, Failure> {
        Ok(ContactLaw::new(self.parameters())?)
    }
}

impl From<&ContactParameters> for FemdemLaw {
    fn from(law: &ContactParameters) -> Self {
        let bridge = law.liquid_bridge.as_ref();
        Self {
            penalty: law.penalty,
            friction: law.friction,
            wall_friction: law.wall_friction.unwrap_or(f64::NAN),
            rolling_friction: law.rolling_friction,
            damping_ratio: law.damping_ratio,
            tangential_ratio: law.tangential_ratio,
            tangential_damping: law.tangential_damping,
            cohesion: law.cohesion,
            adhesion_energy: law.adhesion_energy,
            bridge_volume: bridge.map_or(0.0, |bridge| bridge.volume),
            bridge_tension: bridge.map_or(0.0, |bridge| bridge.tension),
            bridge_angle: bridge.map_or(0.0, |bridge| bridge.contact_angle),
        }
    }
}

/// The number of a material.
pub(crate) fn material(number: u32) -> Result<MaterialId, Failure> {
    let id = u8::try_from(number);
    let id = id.map_err(|_| Failure::refused("material", number, "from 0 to 255"))?;
    Ok(MaterialId(id))
}

/// Writes the default law: a penalty of 1e6 Pa, which is right for no material in particular, a friction of 0.6 and a damping
/// ratio of 0.6.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_law_default(law: Option<&mut MaybeUninit<FemdemLaw>>) -> FemdemStatus {
    border(|| {
        place("law", law)?.write(FemdemLaw::from(&ContactParameters::default()));
        Ok(())
    })
}
