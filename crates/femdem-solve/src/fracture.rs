//! How a deformable body breaks.

use crate::error::{SolveError, check};
use femdem_contact::glue::{Softening, least_compliance};
use femdem_fem::fracture::{Strength, Weibull};
use serde::{Deserialize, Serialize};

/// Largest part of its energy that a crack may be lent at its birth.
pub(crate) const LOAN: f64 = 0.1;

/// What becomes of the parts into which a body has fallen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fragments {
    /// Each becomes a body when the host calls [`World::fragment_bodies`](crate::World::fragment_bodies).
    #[default]
    Bodies,
    /// They stay pieces of one body.
    Pieces,
}

/// The strength of a material, the energy that cracks in it take, and how they are followed. A body whose
/// [`DeformableSpec`](crate::DeformableSpec) has one may break.
///
/// Where a node's mean stress, or at the front of a crack its force, exceeds the strength, the node is split along a plane
/// through it (femdem-fem's [`fracture`](femdem_fem::fracture)); facets along that plane are held together by
/// [`glue`](femdem_contact::glue) until they have taken their energy. None of these numbers is to be fitted to a specimen.
///
/// ```
/// use femdem_fem::fracture::Strength;
/// use femdem_solve::Fracture;
///
/// // Concrete: 3 MPa, 90 J/m².
/// let strength = Strength::new(3e6, 12e6, 38_f64.to_radians())?;
/// let fracture = Fracture::new(strength, [90.0, 450.0]);
/// // At E = 26.5 GPa the process zone is 0.26 m long: E G/f².
/// assert!((fracture.process_zone(26.5e9) - 0.265).abs() < 1e-3);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fracture {
    /// Strength of the material.
    pub strength: Strength,
    /// Energies of fracture by opening and by sliding, J/m².
    pub energies: [f64; 2],
    /// Exponent of mixed modes: see [`mixed_energy`](femdem_contact::glue::mixed_energy).
    pub mix: f64,
    /// How the traction of a crack falls.
    pub softening: Softening,
    /// Scatter of the strength from place to place. Whether a mesh is fine enough is asked for the strength without it: facets of
    /// places that it makes much stronger may take more energy than given.
    pub scatter: Option<Weibull>,
    /// Steps between two looks at the stresses.
    pub every: u32,
    /// Stiffness of a new crack over E/h, with Young's modulus E and the height h of the elements beside it, at most
    /// [the largest](Self::largest_height) that is right.
    pub stiffness: f64,
    /// Whether elements may be [higher](Self::largest_height) than strength and energy allow: cracks then take more energy than
    /// given.
    pub coarse: bool,
    /// What becomes of the parts into which it falls.
    pub fragments: Fragments,
}

impl Fracture {
    /// Usual numbers, for a strength and energies of fracture by opening and by sliding (J/m²).
    #[must_use]
    pub fn new(strength: Strength, energies: [f64; 2]) -> Self {
        Self {
            strength,
            energies,
            mix: 2.0,
            softening: Softening::Linear,
            scatter: None,
            every: 5,
            stiffness: 2.0,
            coarse: false,
            fragments: Fragments::default(),
        }
    }

    /// The length l = E G/f² of the zone in which a crack opens, m, for Young's modulus E (Pa).
    #[must_use]
    pub fn process_zone(&self, young: f64) -> f64 {
        young * self.energies[0] / self.strength.tensile().powi(2)
    }

    /// The largest height h of elements, m, with which a new crack is lent no more than a tenth of its energy by opening, h/(2 α l),
    /// and in no mixed mode, of strength P and energy G without pressure, has to fall steeper than it rises: P² h/(2 α E) is at most
    /// G/(1 + 2 s), with the [first slope](Softening::slope) s of the softening, G/2 for a straight line. The least over modes is
    /// found to a part of about η/256, too low rather than too high. This is of facets in the plane that fails: those askew to it carry
    /// stress along it, too, are lent more, and may take more than G where that is much.
    #[must_use]
    pub fn largest_height(&self, young: f64) -> f64 {
        let strengths = [self.strength.tensile(), self.strength.cohesion()];
        let least = least_compliance(self.energies, self.mix, strengths);
        let mixed = 2.0 * young * least / (1.0 + 2.0 * self.softening.slope());
        self.stiffness * (LOAN * 2.0 * self.process_zone(young)).min(mixed)
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] for energies, an exponent or a stiffness that are not positive and finite, sliding
    /// that takes less energy than opening, and 0 steps.
    pub fn validate(&self) -> Result<(), SolveError> {
        let [opening, sliding] = self.energies;
        for (name, value) in [
            ("energy of fracture by opening", opening),
            ("exponent of mixed modes", self.mix),
            ("stiffness of cracks", self.stiffness),
            ("steps between looks at the stresses", f64::from(self.every)),
        ] {
            check(name, value, value > 0.0, "above 0 and finite")?;
        }
        check(
            "energy of fracture by sliding",
            sliding,
            sliding >= opening,
            "at least that by opening, and finite",
        )
    }
}
