//! Fracture of the materials of a scenario.

use femdem_contact::glue::Softening;
use femdem_fem::fracture::{Strength, Weibull};
use femdem_solve::{Fracture, Fragments};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::error::wrong;

/// How the bodies of a material break; see [`Fracture`]. What is `None` has the usual value of that.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FractureEntry {
    /// Tensile strength \[Pa\].
    pub tensile: f64,
    /// Cohesion of Mohr-Coulomb \[Pa\].
    pub cohesion: f64,
    /// Angle of friction of Mohr-Coulomb \[degrees\].
    pub friction_angle: f64,
    /// Energies of fracture by opening and by sliding \[J/m²\].
    pub energy: [f64; 2],
    /// Exponent of mixed modes.
    #[serde(default)]
    pub mix: Option<f64>,
    /// How the traction of a crack falls.
    #[serde(default)]
    pub softening: Option<Softening>,
    /// Scatter of the strength from place to place.
    #[serde(default)]
    pub weibull: Option<WeibullEntry>,
    /// Steps between two looks at the stresses.
    #[serde(default)]
    pub every: Option<u32>,
    /// Stiffness of a new crack over E/h.
    #[serde(default)]
    pub stiffness: Option<f64>,
    /// Whether the mesh may be too coarse for the process zone.
    #[serde(default)]
    pub coarse: bool,
    /// Whether the parts into which a body falls become bodies.
    #[serde(default)]
    pub fragments: Fragments,
}

/// Weibull's scatter of the strength.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct WeibullEntry {
    /// Modulus; a large one means little scatter.
    pub modulus: f64,
    /// The volume whose characteristic strength is that of the material \[m³\].
    pub volume: f64,
    /// Seed of the scatter.
    #[serde(default)]
    pub seed: u64,
}

impl FractureEntry {
    /// The same for the engine.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key that is out of its range.
    pub fn fracture(&self) -> Result<Fracture, Error> {
        let positive = "above 0 and finite";
        let check = |name: &'static str, value: f64, allowed| match value > 0.0 && value.is_finite()
        {
            true => Ok(()),
            false => Err(wrong(name, &value.to_string(), allowed)),
        };
        check(
            "fracture.tensile",
            self.tensile,
            "above 0 and finite, in Pa",
        )?;
        check(
            "fracture.cohesion",
            self.cohesion,
            "above 0 and finite, in Pa",
        )?;
        let angle = self.friction_angle;
        if !(0.0..90.0).contains(&angle) {
            let allowed = "from 0 to below 90, in degrees";
            return Err(wrong(
                "fracture.friction-angle",
                &angle.to_string(),
                allowed,
            ));
        }
        let [opening, sliding] = self.energy;
        if !(opening > 0.0 && sliding >= opening && sliding.is_finite()) {
            let allowed =
                "that of opening above 0, then that of sliding, at least as large, in J/m²";
            return Err(wrong(
                "fracture.energy",
                &format!("{:?}", self.energy),
                allowed,
            ));
        }
        if self.every == Some(0) {
            return Err(wrong("fracture.every", "0", "at least 1 step"));
        }
        for (name, value) in [
            ("fracture.mix", self.mix),
            ("fracture.stiffness", self.stiffness),
        ] {
            value.map_or(Ok(()), |value| check(name, value, positive))?;
        }
        let scatter = self
            .weibull
            .map(|entry| Weibull::new(entry.modulus, entry.volume, entry.seed));
        let strength = Strength::new(self.tensile, self.cohesion, angle.to_radians())?;
        let usual = Fracture::new(strength, self.energy);
        Ok(Fracture {
            mix: self.mix.unwrap_or(usual.mix),
            softening: self.softening.unwrap_or(usual.softening),
            every: self.every.unwrap_or(usual.every),
            stiffness: self.stiffness.unwrap_or(usual.stiffness),
            coarse: self.coarse,
            fragments: self.fragments,
            scatter: scatter.transpose()?,
            ..usual
        })
    }
}
