//! Materials of a scenario.

use femdem_fem::MaterialRegion;
use femdem_fem::material::{
    AnyMaterial, DruckerPrager, DruckerPragerCap, Hencky, J2, MooneyRivlin, NeoHookean, Viscous,
    Voce,
};
use serde::{Deserialize, Serialize};

use super::FractureEntry;
use crate::Error;
use crate::error::wrong;

/// Laws of deformable matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// [`NeoHookean`].
    NeoHookean,
    /// [`Hencky`].
    Hencky,
    /// [`MooneyRivlin`], with `share`.
    MooneyRivlin,
    /// [`J2`] plasticity, with `yield-stress` and hardening.
    J2,
    /// [`DruckerPrager`] plasticity, with `cohesion` and angles.
    DruckerPrager,
    /// [`DruckerPragerCap`] plasticity, with `cohesion`, an angle and a cap.
    DruckerPragerCap,
}

/// A material. Rigid bodies need its density only, walls nothing; keys that do not belong to its law are refused.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct MaterialEntry {
    /// Density \[kg/m³\].
    pub density: Option<f64>,
    /// The law of deformable bodies.
    pub law: Option<Law>,
    /// Young's modulus \[Pa\].
    pub young: Option<f64>,
    /// Poisson's ratio.
    pub poisson: Option<f64>,
    /// Share of the second invariant in the shear modulus, 0 to 1 (Mooney-Rivlin).
    pub share: Option<f64>,
    /// Yield stress \[Pa\] (J2).
    pub yield_stress: Option<f64>,
    /// Hardening modulus \[Pa\] (J2); 0 if left out.
    pub hardening: Option<f64>,
    /// Yield stress at large plastic strain \[Pa\], approached exponentially (J2).
    pub saturation_stress: Option<f64>,
    /// Rate at which `saturation-stress` is approached, per unit of plastic strain (J2).
    pub saturation_rate: Option<f64>,
    /// Cohesion \[Pa\] (both Drucker-Prager laws).
    pub cohesion: Option<f64>,
    /// Angle of friction \[degrees\] (both): of Mohr-Coulomb, or with a cap that in the plane of p and q.
    pub friction_angle: Option<f64>,
    /// Angle of dilatancy \[degrees\] (Drucker-Prager); 0 if left out.
    pub dilatancy_angle: Option<f64>,
    /// Eccentricity R of the cap (Drucker-Prager with a cap).
    pub cap_eccentricity: Option<f64>,
    /// Hydrostatic yield pressure \[Pa\] over the compaction, in pairs (Drucker-Prager with a cap).
    pub yield_pressure: Option<Vec<[f64; 2]>>,
    /// Shear viscosity beside any law \[Pa s\]; 0 if left out.
    pub shear_viscosity: Option<f64>,
    /// Bulk viscosity beside any law \[Pa s\]; 0 if left out.
    pub bulk_viscosity: Option<f64>,
    /// How breakable bodies of it break.
    pub fracture: Option<FractureEntry>,
}

impl MaterialEntry {
    /// The law with its density.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key: a material without a law, or with a number out of the range of its law.
    pub fn region(&self) -> Result<MaterialRegion, Error> {
        let law = self.law.ok_or_else(|| {
            wrong(
                "law",
                "none",
                "a deformable body needs one of neo-hookean, hencky, mooney-rivlin, j2, \
                 drucker-prager and drucker-prager-cap",
            )
        })?;
        self.refuse_strangers(law)?;
        Ok(MaterialRegion {
            material: self.with_viscosity(self.elastic(law)?)?,
            density: self.density()?,
        })
    }

    /// The density, which every body needs.
    pub(super) fn density(&self) -> Result<f64, Error> {
        self.density
            .ok_or_else(|| wrong("density", "none", "a body needs it, in kg/m³"))
    }

    fn elastic(&self, law: Law) -> Result<AnyMaterial, Error> {
        let young = needed("young", self.young)?;
        let poisson = needed("poisson", self.poisson)?;
        let material = match law {
            Law::NeoHookean => NeoHookean::new(young, poisson)?.into(),
            Law::Hencky => Hencky::new(young, poisson)?.into(),
            Law::MooneyRivlin => {
                MooneyRivlin::new(young, poisson, needed("share", self.share)?)?.into()
            }
            Law::J2 => self.plastic(young, poisson)?.into(),
            Law::DruckerPrager => {
                let (friction, dilatancy) = self.angles()?;
                let cohesion = needed("cohesion", self.cohesion)?;
                DruckerPrager::new(young, poisson, cohesion, friction, dilatancy)?.into()
            }
            Law::DruckerPragerCap => self.capped(young, poisson)?.into(),
        };
        Ok(material)
    }

    /// Angles of friction and dilatancy \[rad\]. They are checked here, in degrees as given.
    fn angles(&self) -> Result<(f64, f64), Error> {
        let friction = needed("friction-angle", self.friction_angle)?;
        if !(0.0..90.0).contains(&friction) {
            let allowed = "from 0 to below 90, in degrees";
            return Err(wrong("friction-angle", &friction.to_string(), allowed));
        }
        let dilatancy = self.dilatancy_angle.unwrap_or(0.0);
        if !(0.0..=friction).contains(&dilatancy) {
            let allowed = "from 0 to the friction angle, in degrees";
            return Err(wrong("dilatancy-angle", &dilatancy.to_string(), allowed));
        }
        Ok((friction.to_radians(), dilatancy.to_radians()))
    }

    fn capped(&self, young: f64, poisson: f64) -> Result<DruckerPragerCap, Error> {
        let friction = needed("friction-angle", self.friction_angle)?;
        if !(friction > 0.0 && friction < 90.0) {
            let allowed = "above 0 and below 90, in degrees";
            return Err(wrong("friction-angle", &friction.to_string(), allowed));
        }
        let cohesion = needed("cohesion", self.cohesion)?;
        let eccentricity = needed("cap-eccentricity", self.cap_eccentricity)?;
        let pairs = self.yield_pressure.clone().ok_or_else(|| {
            let allowed = "the law of the material needs it: give pairs of compaction and Pa";
            wrong("yield-pressure", "none", allowed)
        })?;
        let friction = friction.to_radians();
        DruckerPragerCap::new(young, poisson, cohesion, friction, eccentricity, pairs)
            .map_err(Error::from)
    }

    fn plastic(&self, young: f64, poisson: f64) -> Result<J2, Error> {
        let yield_stress = needed("yield-stress", self.yield_stress)?;
        let law = J2::new(young, poisson, yield_stress, self.hardening.unwrap_or(0.0))?;
        match (self.saturation_stress, self.saturation_rate) {
            (None, None) => Ok(law),
            (stress, rate) => Ok(law.with_saturation(Voce {
                stress: needed("saturation-stress", stress)?,
                rate: needed("saturation-rate", rate)?,
            })?),
        }
    }

    fn with_viscosity(&self, law: AnyMaterial) -> Result<AnyMaterial, Error> {
        if self.shear_viscosity.is_none() && self.bulk_viscosity.is_none() {
            return Ok(law);
        }
        let [shear, bulk] =
            [self.shear_viscosity, self.bulk_viscosity].map(Option::unwrap_or_default);
        Ok(AnyMaterial::from(Viscous::new(law, shear, bulk)?))
    }

    /// Refuses the keys of laws in a material that has none, and numbers out of the range of its law, though it be of
    /// rigid bodies only.
    pub(super) fn check(&self) -> Result<(), Error> {
        if let Some(fracture) = &self.fracture {
            fracture.fracture()?;
        }
        if self.law.is_some() {
            return self.region().map(|_| ());
        }
        let of_all = [
            ("young", self.young),
            ("poisson", self.poisson),
            ("shear-viscosity", self.shear_viscosity),
            ("bulk-viscosity", self.bulk_viscosity),
        ];
        let of_all = of_all.map(|(name, value)| (name, value.map(|number| number.to_string())));
        let of_some = self
            .keys_of_some_laws()
            .map(|(name, value, _)| (name, value));
        for (name, value) in of_all.into_iter().chain(of_some) {
            if let Some(value) = value {
                return Err(wrong(
                    name,
                    &value,
                    "a material without a law has its density only: take it out, or give a law",
                ));
            }
        }
        Ok(())
    }

    /// Refuses keys that do not belong to the law: they would silently have no effect.
    fn refuse_strangers(&self, law: Law) -> Result<(), Error> {
        for (name, value, of) in self.keys_of_some_laws() {
            if let Some(value) = value.filter(|_| !of.contains(&law)) {
                return Err(wrong(
                    name,
                    &value,
                    "the law of the material does not have it: take it out, or change the law",
                ));
            }
        }
        Ok(())
    }

    /// The keys that not every law has, their values as text, and the laws that have them.
    fn keys_of_some_laws(&self) -> [(&'static str, Option<String>, &'static [Law]); 10] {
        const J2: &[Law] = &[Law::J2];
        const CONE: &[Law] = &[Law::DruckerPrager, Law::DruckerPragerCap];
        const CAP: &[Law] = &[Law::DruckerPragerCap];
        let number = |value: Option<f64>| value.map(|number| number.to_string());
        let pairs = self.yield_pressure.as_ref();
        [
            ("share", number(self.share), &[Law::MooneyRivlin]),
            ("yield-stress", number(self.yield_stress), J2),
            ("hardening", number(self.hardening), J2),
            ("saturation-stress", number(self.saturation_stress), J2),
            ("saturation-rate", number(self.saturation_rate), J2),
            ("cohesion", number(self.cohesion), CONE),
            ("friction-angle", number(self.friction_angle), CONE),
            (
                "dilatancy-angle",
                number(self.dilatancy_angle),
                &[Law::DruckerPrager],
            ),
            ("cap-eccentricity", number(self.cap_eccentricity), CAP),
            (
                "yield-pressure",
                pairs.map(|pairs| format!("{pairs:?}")),
                CAP,
            ),
        ]
    }
}

fn needed(name: &'static str, value: Option<f64>) -> Result<f64, Error> {
    value.ok_or_else(|| {
        wrong(
            name,
            "none",
            "the law of the material needs it: give a number",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(text: &str) -> Result<MaterialRegion, Error> {
        let entry: MaterialEntry = toml::from_str(&format!("density = 1000\n{text}")).unwrap();
        entry.region()
    }

    #[test]
    fn every_law_is_made_of_its_keys() {
        for (text, law) in [
            (
                "law = \"neo-hookean\"",
                AnyMaterial::from(NeoHookean::new(1e6, 0.3).unwrap()),
            ),
            ("law = \"hencky\"", Hencky::new(1e6, 0.3).unwrap().into()),
            (
                "law = \"mooney-rivlin\"\nshare = 0.2",
                MooneyRivlin::new(1e6, 0.3, 0.2).unwrap().into(),
            ),
            (
                "law = \"j2\"\nyield-stress = 1e4\nhardening = 2e4",
                J2::new(1e6, 0.3, 1e4, 2e4).unwrap().into(),
            ),
            (
                "law = \"drucker-prager\"\ncohesion = 1e3\nfriction-angle = 30",
                DruckerPrager::new(1e6, 0.3, 1e3, 30_f64.to_radians(), 0.0)
                    .unwrap()
                    .into(),
            ),
            (
                "law = \"drucker-prager-cap\"\ncohesion = 1e3\nfriction-angle = 60\n\
                 cap-eccentricity = 0.6\nyield-pressure = [[0, 1e4], [0.5, 1e5]]",
                DruckerPragerCap::new(
                    1e6,
                    0.3,
                    1e3,
                    60_f64.to_radians(),
                    0.6,
                    vec![[0.0, 1e4], [0.5, 1e5]],
                )
                .unwrap()
                .into(),
            ),
        ] {
            let region = entry(&format!("{text}\nyoung = 1e6\npoisson = 0.3")).unwrap();
            assert_eq!((region.material, region.density), (law, 1000.0), "{text}");
        }
        let viscous = entry("law = \"hencky\"\nyoung = 1e6\npoisson = 0.3\nshear-viscosity = 5");
        let wanted = Viscous::new(Hencky::new(1e6, 0.3).unwrap(), 5.0, 0.0).unwrap();
        assert_eq!(viscous.unwrap().material, AnyMaterial::from(wanted));
    }

    #[test]
    fn what_is_missing_or_strange_is_named() {
        for (text, words) in [
            ("young = 1e6", ["law = none", "neo-hookean"]),
            (
                "law = \"hencky\"\nyoung = 1e6",
                ["poisson = none", "needs it"],
            ),
            (
                "law = \"hencky\"\nyoung = 1e6\npoisson = 0.6",
                ["poisson = 0.6", "0.5"],
            ),
            (
                "law = \"hencky\"\nyoung = 1e6\npoisson = 0.3\nshare = 0.1",
                ["share = 0.1", "take it out"],
            ),
            (
                "law = \"drucker-prager\"\nyoung = 1e6\npoisson = 0.3\ncohesion = 1\nfriction-angle = 95",
                ["friction-angle = 95", "below 90, in degrees"],
            ),
            (
                "law = \"drucker-prager\"\nyoung = 1e6\npoisson = 0.3\ncohesion = 1\nfriction-angle = 30\n\
                 dilatancy-angle = 31",
                ["dilatancy-angle = 31", "in degrees"],
            ),
            (
                "law = \"drucker-prager-cap\"\nyoung = 1e6\npoisson = 0.3\ncohesion = 1\nfriction-angle = 30\n\
                 cap-eccentricity = 0.5",
                ["yield-pressure = none", "pairs"],
            ),
            (
                "law = \"drucker-prager-cap\"\nyoung = 1e6\npoisson = 0.3\ncohesion = 1\nfriction-angle = 30\n\
                 cap-eccentricity = 0.5\nyield-pressure = [[0, 1e4], [0.1, 1e3]]",
                ["yield pressure = 1000", "above the one before"],
            ),
            (
                "law = \"drucker-prager\"\nyoung = 1e6\npoisson = 0.3\ncohesion = 1\nfriction-angle = 30\n\
                 yield-pressure = [[0, 1e4], [0.1, 2e4]]",
                ["yield-pressure = [[0.0, 10000.0]", "take it out"],
            ),
        ] {
            let message = entry(text).unwrap_err().to_string();
            assert!(
                words.iter().all(|w| message.contains(w)),
                "{text}: {message}"
            );
        }
    }
}
