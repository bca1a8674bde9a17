//! One type for all laws, for models and files.

mod viscous;

pub use viscous::Viscous;

use super::{
    CustomMaterial, Deformation, DruckerPrager, DruckerPragerCap, Hencky, J2, Material,
    MooneyRivlin, NeoHookean, Response, Tangent,
};
use crate::error::FemError;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Any law of this crate, or one from outside. In files: `{ neo_hookean = { young = 1e9, poisson =
/// 0.3 } }` and the like; values are checked when read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum AnyMaterial {
    /// Neo-Hookean solid.
    NeoHookean(NeoHookean),
    /// Hencky solid.
    Hencky(Hencky),
    /// Mooney-Rivlin solid.
    MooneyRivlin(MooneyRivlin),
    /// Any law with Kelvin-Voigt viscosity.
    Viscous(Viscous),
    /// J2 plasticity.
    J2(J2),
    /// Drucker-Prager plasticity.
    DruckerPrager(DruckerPrager),
    /// A law from outside this crate.
    Custom(CustomMaterial),
    /// Drucker-Prager plasticity with a cap.
    DruckerPragerCap(DruckerPragerCap),
}

impl AnyMaterial {
    /// A law from outside this crate.
    #[must_use]
    pub fn custom(law: Arc<dyn Material>) -> Self {
        Self::Custom(CustomMaterial::new(law))
    }

    /// Binds a custom law that is known by its name alone (after a file was read) to the law of that name
    /// among `laws`. Laws of this crate are left as they are.
    ///
    /// # Errors
    /// [`FemError::UnboundMaterial`] if a name is not among `laws`.
    pub fn bind(&mut self, laws: &[Arc<dyn Material>]) -> Result<(), FemError> {
        match self {
            Self::Custom(custom) if custom.law().is_none() => {
                let law = laws.iter().find(|law| law.name() == custom.name());
                let law = law.ok_or_else(|| FemError::UnboundMaterial {
                    name: custom.name().to_owned(),
                    given: names(laws),
                })?;
                *custom = CustomMaterial::new(Arc::clone(law));
                Ok(())
            }
            Self::Viscous(viscous) => viscous.law_mut().bind(laws),
            _ => Ok(()),
        }
    }

    /// The name of a custom law that is not bound yet.
    #[must_use]
    pub fn unbound(&self) -> Option<&str> {
        match self {
            Self::Custom(custom) if custom.law().is_none() => Some(custom.name()),
            Self::Viscous(viscous) => viscous.law().unbound(),
            _ => None,
        }
    }

    /// Equivalent plastic strain in the history of a point, of [`DruckerPragerCap`] its compaction; `None` for laws without plasticity, and for
    /// custom ones, whose history has no known layout.
    #[must_use]
    pub fn plastic_strain(&self, history: &[f64]) -> Option<f64> {
        match self {
            // It is the last number of their history.
            Self::J2(_) | Self::DruckerPrager(_) | Self::DruckerPragerCap(_) => {
                history.last().copied()
            }
            Self::Viscous(viscous) => viscous.law().plastic_strain(history),
            _ => None,
        }
    }

    /// The law; `None` for a custom law that is not bound yet.
    #[inline]
    fn law(&self) -> Option<&dyn Material> {
        match self {
            Self::NeoHookean(law) => Some(law),
            Self::Hencky(law) => Some(law),
            Self::MooneyRivlin(law) => Some(law),
            Self::Viscous(law) => Some(law),
            Self::J2(law) => Some(law),
            Self::DruckerPrager(law) => Some(law),
            Self::DruckerPragerCap(law) => Some(law),
            Self::Custom(custom) => custom.law(),
        }
    }
}

impl Material for AnyMaterial {
    fn name(&self) -> &str {
        match self {
            Self::Custom(custom) => custom.name(),
            _ => self.law().map_or("", Material::name),
        }
    }

    fn history_len(&self) -> usize {
        self.law().map_or(0, Material::history_len)
    }

    #[inline]
    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        match self {
            // A direct call, so that the default law can be inlined into an element loop.
            Self::NeoHookean(law) => law.respond(d, old, new),
            _ => self.law()?.respond(d, old, new),
        }
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        self.law()?.tangent(d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.law().map_or(f64::NAN, Material::wave_modulus)
    }

    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        self.law()
            .map_or(f64::NAN, |law| law.stiffness_bound(d, old))
    }

    fn viscosity(&self) -> f64 {
        self.law().map_or(f64::NAN, Material::viscosity)
    }

    fn viscosity_bound(&self, d: &Deformation) -> f64 {
        self.law().map_or(f64::NAN, |law| law.viscosity_bound(d))
    }
}

impl From<NeoHookean> for AnyMaterial {
    fn from(law: NeoHookean) -> Self {
        Self::NeoHookean(law)
    }
}

impl From<Hencky> for AnyMaterial {
    fn from(law: Hencky) -> Self {
        Self::Hencky(law)
    }
}

impl From<MooneyRivlin> for AnyMaterial {
    fn from(law: MooneyRivlin) -> Self {
        Self::MooneyRivlin(law)
    }
}

impl From<Viscous> for AnyMaterial {
    fn from(law: Viscous) -> Self {
        Self::Viscous(law)
    }
}

impl From<J2> for AnyMaterial {
    fn from(law: J2) -> Self {
        Self::J2(law)
    }
}

impl From<DruckerPrager> for AnyMaterial {
    fn from(law: DruckerPrager) -> Self {
        Self::DruckerPrager(law)
    }
}

impl From<DruckerPragerCap> for AnyMaterial {
    fn from(law: DruckerPragerCap) -> Self {
        Self::DruckerPragerCap(law)
    }
}

fn names(laws: &[Arc<dyn Material>]) -> String {
    let names: Vec<_> = laws.iter().map(|law| law.name()).collect();
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}
