//! The numbers of a cohesive law, and what they give at a point.

use super::Softening;
use crate::error::{ContactError, check};
use serde::{Deserialize, Serialize};

/// The law of a cut facet, for all its points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GlueLaw {
    /// Stiffness k of the glue before it softens, Pa/m: some E/h of the elements beside.
    pub stiffness: f64,
    /// Energies of fracture by opening and by sliding, J/m².
    pub energies: [f64; 2],
    /// Exponent η of [`mixed_energy`].
    pub mix: f64,
    /// How the traction falls.
    pub softening: Softening,
    /// Stiffness k_c of the contact of the faces, Pa/m.
    pub contact: f64,
    /// Stiffness k_t of their friction, Pa/m.
    pub tangential: f64,
    /// Their coefficient of friction.
    pub friction: f64,
    /// Whether faces that overlap press each other by this law. Where they meet by another one, as the skins of deformable bodies do,
    /// it only keeps the pressure that they carry at birth.
    pub presses: bool,
}

/// Energy of fracture of a mixed mode: G_I + (G_II − G_I) s^η, where s is the part of sliding (Benzeggagh and Kenane 1996).
#[must_use]
pub fn mixed_energy(energies: [f64; 2], mix: f64, sliding: f64) -> f64 {
    energies[0] + (energies[1] - energies[0]) * sliding.clamp(0.0, 1.0).powf(mix)
}

/// Traction at which a plane without pressure fails in a mixed mode, Pa, for strengths by opening and by sliding: on their ellipse,
/// 1/P² = (1 − s)/f² + s/c², where s is the part of sliding.
#[must_use]
pub fn mixed_strength(strengths: [f64; 2], sliding: f64) -> f64 {
    inverse_square(strengths, sliding.clamp(0.0, 1.0))
        .sqrt()
        .recip()
}

/// One over the square of the strength in a mode, 1/Pa².
pub(super) fn inverse_square([tensile, cohesion]: [f64; 2], s: f64) -> f64 {
    (1.0 - s) / tensile.powi(2) + s / cohesion.powi(2)
}

/// What the glue of a point bears, and what it takes to break it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GlueLimits {
    /// The traction from which on it softens, P, Pa; 0 for that at birth.
    pub peak: f64,
    /// The energy G that it takes to break it, J/m²; the glue dissipates as much, and what was lent at its birth.
    pub energy: f64,
}

impl GlueLimits {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// [`ContactError::Parameter`] for a peak that is negative or not finite, and an energy that is not positive and finite.
    pub fn check(&self) -> Result<(), ContactError> {
        let allowed = "at least 0 and finite, in Pa";
        check("peak of glue", self.peak, self.peak >= 0.0, allowed)?;
        let allowed = "above 0 and finite, in J/m^2";
        check("energy of glue", self.energy, self.energy > 0.0, allowed)
    }
}

impl GlueLaw {
    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// [`ContactError::Parameter`] for a stiffness, an energy or an exponent that is not positive and finite, and a friction that
    /// is negative or not finite.
    pub fn check(&self) -> Result<(), ContactError> {
        let [opening, sliding] = self.energies;
        for (name, value) in [
            ("stiffness of the glue", self.stiffness),
            ("energy of fracture by opening", opening),
            ("energy of fracture by sliding", sliding),
            ("exponent of mixed modes", self.mix),
            ("stiffness of the contact", self.contact),
            ("stiffness of the friction", self.tangential),
        ] {
            check(name, value, value > 0.0, "above 0 and finite")?;
        }
        let allowed = "at least 0 and finite";
        check("friction", self.friction, self.friction >= 0.0, allowed)
    }

    /// The energy G that it takes to break a point in the mode of a traction (normal, and two along the facet, Pa), J/m².
    #[must_use]
    pub fn energy(&self, traction: [f64; 3]) -> f64 {
        let [normal, one, two] = [traction[0].max(0.0), traction[1], traction[2]];
        let sliding = one * one + two * two;
        let all = normal * normal + sliding;
        let share = if all > 0.0 { sliding / all } else { 0.0 };
        mixed_energy(self.energies, self.mix, share)
    }
}

/// The glue of a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Glue {
    /// Traction where the sides have not opened, in the axes of the facet, Pa: that at birth for glue born there, with a normal
    /// part that is not negative; for glue of a bond, what friction took from it.
    pub traction: [f64; 3],
    /// The largest traction that it bears, above 0, Pa.
    peak: f64,
    /// Dissipated beyond the peak, J/m².
    energy: f64,
    /// The largest λ so far, m.
    largest: f64,
}

impl Glue {
    /// Glue born under a traction T (Pa), on the elastic branch of its law: it rises to its peak P, or has its peak at once if T is
    /// more. So no force jumps, and breaking takes G whatever T is: the energy E beyond the peak is what is left of
    ///
    /// G = ∫ t dλ − T²/(2k) = (P² − T²)/(2k) + E,   λ from 0.
    ///
    /// The rise has at most half of G: P is less where elements are so coarse, thus k so small, that it would have more. `None`
    /// for glue that bears nothing.
    pub fn born(law: &GlueLaw, traction: [f64; 3], limits: &GlueLimits) -> Option<Self> {
        let traction = [traction[0].max(0.0), traction[1], traction[2]];
        let square = traction.iter().map(|t| t * t).sum::<f64>();
        let most = square + law.stiffness * limits.energy;
        let peak_square = (limits.peak * limits.peak).min(most).max(square);
        let rise = 0.5 * (peak_square - square) / law.stiffness;
        let peak = peak_square.sqrt();
        (peak > 0.0).then(|| Self::softening(law, traction, peak, limits.energy - rise))
    }

    /// Glue that softens from a peak (Pa) on, and dissipates an energy beyond it, J/m².
    pub fn softening(law: &GlueLaw, traction: [f64; 3], peak: f64, energy: f64) -> Self {
        Self {
            traction,
            peak,
            energy,
            largest: peak / law.stiffness,
        }
    }

    /// λ beyond that of the peak, over G/T_0, at the largest λ.
    fn beyond(&self, law: &GlueLaw) -> f64 {
        ((self.largest - self.peak / law.stiffness) * self.peak / self.energy).max(0.0)
    }

    /// Traction at the largest λ, Pa.
    fn strength(&self, law: &GlueLaw) -> f64 {
        self.peak * law.softening.traction(self.beyond(law))
    }

    /// Secant stiffness S, Pa/m.
    pub fn secant(&self, law: &GlueLaw) -> f64 {
        self.strength(law) / self.largest
    }

    /// Whether nothing holds any more.
    pub fn is_broken(&self, law: &GlueLaw) -> bool {
        self.beyond(law) >= law.softening.end()
    }

    /// Part of the stiffness at birth that is lost.
    pub fn damage(&self, law: &GlueLaw) -> f64 {
        1.0 - self.secant(law) / law.stiffness
    }

    /// Whether its numbers are finite and possible.
    pub fn is_sound(&self, law: &GlueLaw) -> bool {
        let all = [self.peak, self.energy, self.largest];
        // The quotient was rounded when the glue was made.
        let least = self.peak / law.stiffness * (1.0 - 1e-12);
        all.iter().all(|x| *x > 0.0 && x.is_finite())
            && self.largest >= least
            && self.traction.iter().all(|x| x.is_finite())
    }

    /// Stored where the sides have not opened, J/m²: T²/(2k), before it has softened.
    pub fn lent(&self, law: &GlueLaw) -> f64 {
        0.5 * self.traction.iter().map(|t| t * t).sum::<f64>() / law.stiffness
    }

    /// Dissipated so far, J/m²: the area under the traction up to the largest λ, less what is stored there.
    fn dissipated(&self, law: &GlueLaw) -> f64 {
        0.5 * self.peak * self.peak / law.stiffness
            + self.energy * law.softening.area(self.beyond(law))
            - 0.5 * self.strength(law) * self.largest
    }

    /// Keeps the largest λ, and returns what that dissipates, J/m².
    pub fn reach(&mut self, law: &GlueLaw, lambda: f64) -> f64 {
        if lambda <= self.largest {
            return 0.0;
        }
        let before = self.dissipated(law);
        self.largest = lambda;
        self.dissipated(law) - before
    }
}
