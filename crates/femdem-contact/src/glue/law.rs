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
    let s = sliding.clamp(0.0, 1.0);
    let [opening, across] = [(1.0 - s).sqrt() / strengths[0], s.sqrt() / strengths[1]];
    opening.hypot(across).recip()
}

/// One over the square of the strength in a mode, 1/Pa².
pub(super) fn inverse_square([tensile, cohesion]: [f64; 2], s: f64) -> f64 {
    (1.0 - s) / tensile.powi(2) + s / cohesion.powi(2)
}

/// What the glue of a point bears until it gives way. In which mode it does so is decided then, by the traction that it carries.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GlueLimits {
    /// Tensile strength f_t and cohesion c, Pa.
    pub strengths: [f64; 2],
    /// Tangent of the angle of internal friction φ: glue and friction bear c + p tan φ together under a pressure p on the plane
    /// that fails.
    pub slope: f64,
    /// Unit normal m of the plane that fails, in the axes of the facet, n first; n·m is not negative. What the facet's traction is
    /// along m opens that plane, and what is across slides it; of its strength and its energy the facet has the part n·m.
    pub plane: [f64; 3],
    /// What the facet carries as it is askew, in its axes, Pa: the traction σ (n − (n·m) m) of the stress along the plane that fails, at
    /// birth. The facets of a zigzag carry it in turn; it neither opens the crack nor slides it. What of that stress changes later
    /// does count.
    pub aside: [f64; 3],
}

impl GlueLimits {
    /// A facet in the plane that fails.
    #[must_use]
    pub fn flat(strengths: [f64; 2], slope: f64) -> Self {
        Self {
            strengths,
            slope,
            plane: [1.0, 0.0, 0.0],
            aside: [0.0; 3],
        }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    ///
    /// [`ContactError::Parameter`] for strengths that are not positive and finite, a slope that is negative or not finite, a normal
    /// that is no unit or points to the other side, and a traction that is not finite.
    pub fn check(&self) -> Result<(), ContactError> {
        for (name, value) in ["tensile strength of glue", "cohesion of glue"]
            .into_iter()
            .zip(self.strengths)
        {
            check(name, value, value > 0.0, "above 0 and finite, in Pa")?;
        }
        let allowed = "at least 0 and finite";
        check("slope of glue", self.slope, self.slope >= 0.0, allowed)?;
        let length = self.plane.iter().map(|x| x * x).sum::<f64>().sqrt();
        let is_unit = (length - 1.0).abs() <= UNIT;
        check("length of the normal of glue", length, is_unit, "1")?;
        let flat = self.plane[0];
        let allowed = "at least 0: the normal points to the second side";
        check("part of glue in its plane", flat, flat >= 0.0, allowed)?;
        for traction in self.aside {
            check(
                "traction of glue along the crack",
                traction,
                true,
                "finite, in Pa",
            )?;
        }
        Ok(())
    }

    /// The same where strengths are a multiple.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.strengths = self.strengths.map(|strength| strength * factor);
        self
    }

    /// How the plane that fails is driven where the facet has this traction in its glue and its friction and is under a pressure, Pa.
    fn driving(&self, traction: &[f64; 3], pressure: f64) -> Driving {
        let mut rest = [0, 1, 2].map(|i| traction[i] - self.aside[i]);
        rest[0] -= pressure;
        let along: f64 = self.plane.iter().zip(rest).map(|(m, t)| m * t).sum();
        let across = [0, 1, 2].map(|i| rest[i] - along * self.plane[i]);
        let (across, opening) = (square(&across), along.max(0.0).powi(2));
        let all = opening + across;
        Driving {
            traction: all.sqrt(),
            sliding: if all > 0.0 { across / all } else { 0.0 },
            pressure: (-along).max(0.0),
        }
    }

    /// What drives it when it gives way, without pressure, Pa: its part of the strength.
    fn strength(&self, driving: &Driving) -> f64 {
        self.plane[0] * mixed_strength(self.strengths, driving.sliding)
    }
}

/// What opens and slides the crack, by the facet: the traction on the plane that fails, times the facet's part n·m of that, Pa.
struct Driving {
    /// The norm of what pulls along the normal of the plane and of what is across.
    traction: f64,
    /// The square of what is across over that of this norm: the part of sliding. 1 where the plane is pushed shut.
    sliding: f64,
    /// What pushes the plane shut.
    pressure: f64,
}

/// How far the length of a unit normal may be from 1.
const UNIT: f64 = 1e-9;

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
    /// Traction where the sides have not opened, in the axes of the facet, Pa: that at birth for glue born there, and for glue
    /// born under pressure less than nothing by as much as its spring has to open until the pressure is gone; for glue of a bond,
    /// what friction took from it.
    pub traction: [f64; 3],
    stage: Stage,
}

/// Where on its law glue is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
enum Stage {
    /// On the elastic branch.
    Rises(Rise),
    /// It has given way.
    Falls(Fall),
}

/// The elastic branch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Rise {
    /// Where it ends.
    limits: GlueLimits,
    /// λ at the last step, m.
    last: f64,
}

/// What the faces of a point hold beside its glue, Pa.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Held {
    /// By friction, along the two axes in the facet.
    pub friction: [f64; 2],
    pub pressure: f64,
}

/// How glue gives way.
struct GivesWay {
    /// The traction from which it falls, above 0, Pa.
    peak: f64,
    /// The part of sliding.
    sliding: f64,
}

/// The softening branch of a law, in the mode in which the glue gave way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Fall {
    /// The largest traction that it bore, above 0, Pa.
    peak: f64,
    /// Dissipated beyond the peak, J/m².
    energy: f64,
    /// The largest λ so far, m.
    largest: f64,
}

fn square(traction: &[f64; 3]) -> f64 {
    traction.iter().map(|t| t * t).sum()
}

impl Glue {
    /// Glue born under a traction T (Pa), whose normal part is not negative, between faces that hold the rest. It is on the elastic
    /// branch of its law, so no force jumps, and gives way at once if the facet is beyond its limits. `None` for a facet across the
    /// plane that fails which carries nothing.
    pub fn born(
        law: &GlueLaw,
        traction: [f64; 3],
        held: Held,
        limits: &GlueLimits,
    ) -> Option<Self> {
        // There is nothing before it: it falls from where it is.
        let last = square(&traction).sqrt() / law.stiffness;
        let mut glue = Self {
            traction,
            stage: Stage::Rises(Rise {
                limits: *limits,
                last,
            }),
        };
        if held.pressure > 0.0 {
            // The faces have to open so far until they press each other no more.
            glue.traction[0] = -law.stiffness * (held.pressure / law.contact);
        }
        if let Some(now) = Self::onset(law, limits, last, &traction, held) {
            glue.stage = Stage::Falls(glue.fall(law, limits, &now));
        }
        let bears = limits.plane[0] > 0.0 || matches!(glue.stage, Stage::Falls(_));
        bears.then_some(glue)
    }

    /// Glue that softens from a peak (Pa) on, and dissipates an energy beyond it, J/m².
    pub fn softening(law: &GlueLaw, traction: [f64; 3], peak: f64, energy: f64) -> Self {
        let fall = Fall::new(law, peak, energy);
        Self {
            traction,
            stage: Stage::Falls(fall),
        }
    }

    /// How it gives way at these limits under an elastic traction (Pa), if it does; at λ = `last` (m) it has not.
    ///
    /// It falls from its traction less the part by which the facet is driven beyond what it bears; from what it bore at the last step,
    /// if that is more, so that no force jumps however long a step is. A facet to which pressure and friction left less than its part
    /// of the strength rises to that first: it falls over no longer way than others.
    fn onset(
        law: &GlueLaw,
        limits: &GlueLimits,
        last: f64,
        elastic: &[f64; 3],
        held: Held,
    ) -> Option<GivesWay> {
        let friction = held.friction;
        let all = [
            elastic[0],
            elastic[1] + friction[0],
            elastic[2] + friction[1],
        ];
        let driving = limits.driving(&all, held.pressure);
        let strength = limits.strength(&driving);
        let bears = strength + limits.slope * driving.pressure;
        if driving.traction < bears {
            return None;
        }
        let traction = square(elastic).sqrt();
        let reached = if driving.traction > 0.0 {
            traction * (bears / driving.traction)
        } else {
            traction
        };
        let before = (law.stiffness * last).min(traction);
        let peak = reached.max(before).max(strength);
        (peak > 0.0).then_some(GivesWay {
            peak,
            sliding: driving.sliding,
        })
    }

    /// The branch on which it falls from a peak P. With the energy of fracture G of its mode, and born under T, it dissipates
    /// beyond the peak what is left of
    ///
    /// G = ∫ t dλ − T²/(2k) = (P² − T²)/(2k) + E,   λ from 0,
    ///
    /// so that breaking takes G whatever T is. It falls no steeper than it rises, P s P/E <= k with the first slope s of the
    /// [`Softening`]: elements beside it, whose stiffness k is, could not follow. Where E is more for that, it takes more than G: a
    /// facet across the plane that fails, which carries more than its part of it, one of elements too coarse for their strength, and
    /// one that pressure makes as strong.
    fn fall(&self, law: &GlueLaw, limits: &GlueLimits, now: &GivesWay) -> Fall {
        let GivesWay { peak, sliding } = *now;
        let [normal, one, two] = self.traction;
        let lent = 0.5 * square(&[normal.max(0.0), one, two]) / law.stiffness;
        let risen = 0.5 * peak * peak / law.stiffness;
        let all = limits.plane[0] * mixed_energy(law.energies, law.mix, sliding);
        let least = 2.0 * law.softening.slope() * risen;
        Fall::new(law, peak, (all - risen + lent).max(least))
    }

    /// Secant stiffness S, Pa/m.
    pub fn secant(&self, law: &GlueLaw) -> f64 {
        match &self.stage {
            Stage::Rises(_) => law.stiffness,
            Stage::Falls(fall) => fall.strength(law) / fall.largest,
        }
    }

    /// Whether nothing holds any more.
    pub fn is_broken(&self, law: &GlueLaw) -> bool {
        match &self.stage {
            Stage::Rises(_) => false,
            Stage::Falls(fall) => fall.beyond(law) >= law.softening.end(),
        }
    }

    /// Part of the stiffness at birth that is lost.
    pub fn damage(&self, law: &GlueLaw) -> f64 {
        1.0 - self.secant(law) / law.stiffness
    }

    /// Whether its numbers are finite and possible.
    pub fn is_sound(&self, law: &GlueLaw) -> bool {
        let stage = match &self.stage {
            Stage::Rises(rise) => {
                rise.limits.check().is_ok() && rise.last >= 0.0 && rise.last.is_finite()
            }
            Stage::Falls(fall) => fall.is_sound(law),
        };
        stage && self.traction.iter().all(|x| x.is_finite())
    }

    /// Keeps the opening of its spring (m) at which it is now, between faces that hold the rest, and returns what that dissipates, J/m².
    pub fn reach(&mut self, law: &GlueLaw, stretch: &[f64; 3], held: Held) -> f64 {
        let lambda = square(stretch).sqrt();
        if let Stage::Rises(Rise { limits, last }) = self.stage {
            let elastic = stretch.map(|x| law.stiffness * x);
            self.stage = match Self::onset(law, &limits, last, &elastic, held) {
                Some(now) => Stage::Falls(self.fall(law, &limits, &now)),
                None => Stage::Rises(Rise {
                    limits,
                    last: lambda,
                }),
            };
        }
        match &mut self.stage {
            Stage::Rises(_) => 0.0,
            Stage::Falls(fall) => fall.reach(law, lambda),
        }
    }
}

impl Fall {
    fn new(law: &GlueLaw, peak: f64, energy: f64) -> Self {
        Self {
            peak,
            energy,
            largest: peak / law.stiffness,
        }
    }

    /// λ beyond that of the peak, over E/P, at the largest λ.
    fn beyond(&self, law: &GlueLaw) -> f64 {
        ((self.largest - self.peak / law.stiffness) * self.peak / self.energy).max(0.0)
    }

    /// Traction at the largest λ, Pa.
    fn strength(&self, law: &GlueLaw) -> f64 {
        self.peak * law.softening.traction(self.beyond(law))
    }

    /// Dissipated so far, J/m²: the area under the traction up to the largest λ, less what is stored there.
    fn dissipated(&self, law: &GlueLaw) -> f64 {
        0.5 * self.peak * self.peak / law.stiffness
            + self.energy * law.softening.area(self.beyond(law))
            - 0.5 * self.strength(law) * self.largest
    }

    /// Keeps the largest λ, and returns what that dissipates, J/m².
    fn reach(&mut self, law: &GlueLaw, lambda: f64) -> f64 {
        if lambda <= self.largest {
            return 0.0;
        }
        let before = self.dissipated(law);
        self.largest = lambda;
        self.dissipated(law) - before
    }

    fn is_sound(&self, law: &GlueLaw) -> bool {
        let all = [self.peak, self.energy, self.largest];
        // The quotient was rounded when the glue was made.
        let least = self.peak / law.stiffness * (1.0 - 1e-12);
        all.iter().all(|x| *x > 0.0 && x.is_finite()) && self.largest >= least
    }
}
