//! Constitutive laws: from the deformation of a material point to its stress.
//!
//! **Use it** to compute the stress, energy and tangent of an element, or to add your own law. All laws are
//! written per unit of reference volume, for the first Piola stress and the deformation gradient, and are
//! valid at any strain. **Do not use it** for anisotropic solids, damage or temperature: no law here includes
//! them (the trait allows them).
//!
//! | law | for | history |
//! |---|---|---|
//! | [`NeoHookean`] | the default: soft and stiff solids at any strain | none |
//! | [`Hencky`] | stiff solids; the base of the plastic laws | none |
//! | [`MooneyRivlin`] | rubber | none |
//! | [`Viscous`] | any of these with Kelvin-Voigt viscosity | that of the law |
//! | [`J2`] | metals: von Mises yield, linear and Voce hardening | 7 numbers |
//! | [`DruckerPrager`] | soil, concrete, rock: strength that grows with pressure | 7 numbers |
//! | [`DruckerPragerCap`] | powders: the same, and compaction under pressure | 7 numbers |
//! | [`CustomMaterial`] | your own law | as the law defines |
//!
//! # Adding a law
//!
//! This one is neo-Hookean with the volumetric energy K/2 (J - 1)^2. Its tangent is computed by central
//! differences, which is enough for the explicit integrator (it never needs one) and for a first Newton run.
//!
//! ```
//! use femdem_mesh::Matrix3;
//! use femdem_fem::material::{
//!     AnyMaterial, Deformation, Material, Response, Tangent, difference_tangent,
//! };
//! use std::sync::Arc;
//!
//! #[derive(Debug)]
//! struct Rubber { shear: f64, bulk: f64 }
//!
//! impl Material for Rubber {
//!     fn name(&self) -> &str { "rubber" }
//!     fn respond(&self, d: &Deformation, _old: &[f64], _new: &mut [f64]) -> Option<Response> {
//!         let (f, j) = (d.gradient, d.volume_ratio()?);
//!         let inverse_t = f.try_inverse()?.transpose();
//!         let energy = 0.5 * self.shear * (f.norm_squared() - 3.0 - 2.0 * j.ln())
//!             + 0.5 * self.bulk * (j - 1.0).powi(2);
//!         let piola = self.shear * (f - inverse_t) + self.bulk * (j - 1.0) * j * inverse_t;
//!         Response::elastic(energy, piola)
//!     }
//!     fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
//!         difference_tangent(self, d, old)
//!     }
//!     fn wave_modulus(&self) -> f64 { self.bulk + 2.0 * self.shear }
//!     fn stiffness_bound(&self, d: &Deformation, _old: &[f64]) -> f64 {
//!         let (j, s) = (d.gradient.determinant(), d.smallest_stretch());
//!         let volumetric = self.bulk * j * ((2.0 * j - 1.0).abs() + (j - 1.0).abs());
//!         self.shear + (self.shear + volumetric) / (s * s)
//!     }
//! }
//!
//! let rubber = AnyMaterial::custom(Arc::new(Rubber { shear: 1e6, bulk: 1e7 }));
//! let stretched = Deformation::at_rest(Matrix3::from_diagonal(&[1.1, 1.0, 1.0].into()));
//! let pulls = rubber.respond(&stretched, &[], &mut []).is_some_and(|r| r.piola[(0, 0)] > 0.0);
//! assert!(pulls, "a stretched rubber pulls");
//! let inverted = Deformation::at_rest(-Matrix3::identity());
//! assert!(rubber.respond(&inverted, &[], &mut []).is_none(), "no stress inside out");
//! ```
//!
//! # Accuracy
//!
//! - Tangents and stresses agree with fourth-order differences to 3e-10 of their size (the accuracy of the
//!   differences), on every branch of the plastic laws, and are exact to round-off for equal and nearly equal
//!   stretches. A rotation gives less than 1e-14 E of stress (3e-14 E at a Poisson's ratio of 0.49: round-off
//!   times the bulk modulus).
//! - Return maps are exact for steps of any size when the strain keeps its direction, and of first
//!   order in the step otherwise (backward Euler): over a loop of 4 to 8 % strain in 4,000 steps the work
//!   is stored or dissipated to 2e-6 for associated flow, to 1e-3 for flow with less dilatancy.
//! - The energies of [`NeoHookean`], [`Hencky`] and the plastic laws keep nine digits at a strain of 1e-6, so
//!   that a line search works for stiff bodies; that of [`MooneyRivlin`] keeps about four.
//! - Cost of a stress: 30 ns neo-Hookean, 60 ns Mooney-Rivlin, 350 to 450 ns in logarithmic strain, which
//!   needs an eigenvalue problem (tangents 0.2 to 1 us), on one core of 2020s hardware.
//!
//! # Conventions
//!
//! F = dx/dX, J = det F, P the first Piola stress (work conjugate to F), tau = P F^T = J sigma the
//! Kirchhoff stress, b = F F^T. Tension is positive. Moduli are given as Young's modulus and Poisson's
//! ratio at small strain. Energies and powers are per reference volume.

mod any;
mod custom;
mod drucker_prager;
mod drucker_prager_cap;
mod hencky;
mod j2;
mod log_strain;
mod moduli;
mod mooney_rivlin;
mod neo_hookean;
mod principal;
pub(crate) mod spectral;

pub use any::{AnyMaterial, Viscous};
pub use custom::CustomMaterial;
pub use drucker_prager::DruckerPrager;
pub use drucker_prager_cap::DruckerPragerCap;
pub use hencky::Hencky;
pub use j2::{J2, Voce};
pub use moduli::Moduli;
pub use mooney_rivlin::MooneyRivlin;
pub use neo_hookean::NeoHookean;

use femdem_mesh::Matrix3;
use std::fmt::Debug;

/// dP/dF, Pa: entry (3 i + J, 3 k + L) is dP_iJ / dF_kL. For plasticity it is the derivative of the
/// stress at the end of the step at fixed history (algorithmic); it need not be symmetric.
pub type Tangent = femdem_mesh::nalgebra::SMatrix<f64, 9, 9>;

/// Deformation at a material point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deformation {
    /// F = dx/dX, dimensionless.
    pub gradient: Matrix3,
    /// dF/dt, 1/s; zero in statics.
    pub rate: Matrix3,
}

impl Deformation {
    /// The gradient F without a rate.
    #[inline]
    #[must_use]
    pub fn at_rest(gradient: Matrix3) -> Self {
        Self {
            gradient,
            rate: Matrix3::zeros(),
        }
    }

    /// J = det F; `None` if it is not positive and finite.
    #[inline]
    #[must_use]
    pub fn volume_ratio(&self) -> Option<f64> {
        let j = self.gradient.determinant();
        (j > 0.0 && j.is_finite()).then_some(j)
    }

    /// The smallest principal stretch, dimensionless; NaN if F is not finite.
    #[must_use]
    pub fn smallest_stretch(&self) -> f64 {
        let c = self.gradient.tr_mul(&self.gradient);
        let [a, b, c] = spectral::Spectral::of(&c).values;
        if (a + b + c).is_finite() {
            a.min(b).min(c).max(0.0).sqrt()
        } else {
            f64::NAN
        }
    }

    /// A lower bound of the square of the smallest principal stretch, closer than a tenth of the
    /// spread of the squares; exact where they spread far. NaN if F is not finite.
    pub(crate) fn smallest_stretch2_bound(&self) -> f64 {
        let c = self.gradient.tr_mul(&self.gradient);
        let mean = c.trace() / 3.0;
        let below = spectral::smallest_below(&c, mean);
        if below > 0.5 * mean {
            below
        } else {
            self.smallest_stretch().powi(2)
        }
    }
}

/// Response of a material point, per unit of reference volume.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Response {
    /// Stored (recoverable) energy, J/m^3.
    pub energy: f64,
    /// First Piola stress, Pa, the viscous part included.
    pub piola: Matrix3,
    /// Power turned into heat by viscosity, W/m^3.
    pub viscous_power: f64,
    /// Work dissipated by plastic flow since `old`, J/m^3.
    pub plastic_work: f64,
}

impl Response {
    /// The response of an elastic law; `None` unless energy and stress are finite.
    #[inline]
    #[must_use]
    pub fn elastic(energy: f64, piola: Matrix3) -> Option<Self> {
        Self {
            energy,
            piola,
            ..Self::default()
        }
        .finite()
    }

    /// The response itself if all its numbers are finite.
    #[inline]
    #[must_use]
    pub fn finite(self) -> Option<Self> {
        // Without early exits, so that the nine tests run in parallel.
        let piola = self.piola.iter().fold(true, |ok, p| ok & p.is_finite());
        let rest = self.energy + self.viscous_power + self.plastic_work;
        (piola & rest.is_finite()).then_some(self)
    }
}

/// A constitutive law. See the [module documentation](self) for an example.
pub trait Material: Debug + Send + Sync {
    /// The law's name, by which a custom law is identified after a checkpoint is read.
    fn name(&self) -> &str;

    /// Length of the history of an integration point. All zero is the virgin state.
    fn history_len(&self) -> usize {
        0
    }

    /// Energy and stress at `d` for the history `old`; the history at the end of the step is written to
    /// `new`. Both slices have [`Material::history_len`] numbers. Must be objective: F -> Q F turns P into Q
    /// P and does not affect the history.
    ///
    /// `None` if no stress is defined there: J <= 0, a number that is not finite, a history of the wrong
    /// length. `new` is then invalid.
    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response>;

    /// dP/dF at `d` for the history `old`, at fixed dF/dt; `None` where [`Material::respond`] is `None`.
    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent>;

    /// rho c_p^2 at the undeformed state: the modulus of a plane compression wave, Pa.
    fn wave_modulus(&self) -> f64;

    /// A number c, Pa, such that G : dP/dF : G <= c |G|^2 for all G = a (x) N, that is, an upper bound
    /// of the largest eigenvalue of the acoustic tensor over all reference directions N, for the
    /// elastic tangent and the algorithmic one.
    ///
    /// The laws of this module satisfy more, whether the tangent is positive or not: G : dP/dF : G <= c
    /// (sum_a |u_a|^2) (sum_a |B_a|^2) for every G = sum_a u_a (x) B_a. A linear tetrahedron of density rho
    /// and reference heights h_a, with a quarter of its mass at each node, then has omega^2 <= 4 c/rho sum_a
    /// 1/h_a^2. NaN or infinite where there is no stress.
    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64;

    /// The largest viscous modulus (stress per strain rate) at the undeformed state, Pa s.
    fn viscosity(&self) -> f64 {
        0.0
    }

    /// The largest viscous modulus dP/d(dF/dt) at `d`, Pa s, in the sense of
    /// [`Material::stiffness_bound`].
    fn viscosity_bound(&self, _d: &Deformation) -> f64 {
        self.viscosity()
    }
}

/// dP/dF of a law by central differences of its stress, with an error of about 1e-9 of the stiffness where
/// the stress is smooth; `None` where a stress is undefined. Costs 18 stresses.
#[must_use]
pub fn difference_tangent<M: Material + ?Sized>(
    law: &M,
    d: &Deformation,
    old: &[f64],
) -> Option<Tangent> {
    let step = 6e-6 * d.gradient.norm();
    let mut scratch = vec![0.0; old.len()];
    let mut tangent = Tangent::zeros();
    for k in 0..3 {
        for l in 0..3 {
            let mut piola_at = |shift: f64| {
                let mut shifted = *d;
                shifted.gradient[(k, l)] += shift;
                let response = law.respond(&shifted, old, &mut scratch)?;
                Some(response.piola)
            };
            let slope = (piola_at(step)? - piola_at(-step)?) / (2.0 * step);
            for i in 0..3 {
                for j in 0..3 {
                    tangent[(3 * i + j, 3 * k + l)] = slope[(i, j)];
                }
            }
        }
    }
    Some(tangent)
}
