//! The numbers of a bond.

use crate::error::{ContactError, check};
use crate::glue::{GlueLaw, GluedFacet, Softening};
use serde::{Deserialize, Serialize};

/// The least part of the energy of fracture beyond the strength that is not a matter of rounding.
const LEAST_BEYOND: f64 = 1e-9;

/// The law of a bond, per area of its section.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BondLaw {
    /// Stiffness k along and across the normal, Pa/m: Young's modulus over the thickness.
    pub stiffness: f64,
    /// Tensile strength f_t, Pa.
    pub tensile: f64,
    /// Shear strength c without pressure, Pa.
    pub cohesion: f64,
    /// Coefficient of friction μ: of the strength under pressure, and of the broken faces.
    pub friction: f64,
    /// Energies of fracture by opening and by sliding, J/m².
    pub energies: [f64; 2],
    /// Exponent η of [mixed modes](crate::glue::mixed_energy).
    pub mix: f64,
    /// How the traction falls.
    pub softening: Softening,
    /// Part ζ of critical damping of the two bodies along the normal of the bond.
    pub damping: f64,
}

impl Default for BondLaw {
    fn default() -> Self {
        Self {
            stiffness: 1e11,
            tensile: 1e6,
            cohesion: 3e6,
            friction: 0.6,
            energies: [20.0, 100.0],
            mix: 2.0,
            softening: Softening::Linear,
            damping: 0.0,
        }
    }
}

impl BondLaw {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] for a number that is not positive and finite, or for friction and damping negative; and for an
    /// energy that in some mode is not more than what a point stores at its strength, f²/2k: nothing would be left to soften by.
    /// The bound over all modes asks for slightly more where strength and energy change in opposite ways.
    pub fn check(&self) -> Result<(), ContactError> {
        for (name, value) in [
            ("tensile strength of the bond", self.tensile),
            ("cohesion of the bond", self.cohesion),
        ] {
            check(name, value, value > 0.0, "above 0 and finite, in Pa")?;
        }
        let allowed = "at least 0 and below 10: a part of critical damping";
        let zeta = self.damping;
        check(
            "damping of the bond",
            zeta,
            (0.0..10.0).contains(&zeta),
            allowed,
        )?;
        let law = self.glue();
        law.check()?;
        let least = GluedFacet::least_beyond_peak(&law, self.strengths());
        check(
            "part of the energy of fracture of the bond beyond its strength",
            least,
            least > LEAST_BEYOND,
            "above 1e-9: raise the energy or the stiffness k, or lower the strength f, as f^2/(2 k) is stored before it gives way",
        )
    }

    /// The law of its points once they have given way. The stiffness under pressure is that before.
    pub(crate) fn glue(&self) -> GlueLaw {
        GlueLaw {
            stiffness: self.stiffness,
            energies: self.energies,
            mix: self.mix,
            softening: self.softening,
            contact: self.stiffness,
            tangential: self.stiffness,
            friction: self.friction,
            presses: true,
        }
    }

    pub(crate) fn strengths(&self) -> [f64; 2] {
        [self.tensile, self.cohesion]
    }
}
