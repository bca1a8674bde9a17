//! An upper bound of a body's highest frequency, for the time step.

use super::forces::State;
use super::{DeformableModel, Workspace};
use crate::element::{Bar, Element, ElementFailure, T4, T10, Table};
use crate::material::{AnyMaterial, Deformation, Material};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// What limits the time step of a body without contacts.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FrequencyBound {
    /// Upper bound of omega^2 of any motion of the body, rad^2/s^2.
    pub frequency2: f64,
    /// Upper bound of the viscous decay rate of any motion, the largest eigenvalue of M^-1 C, 1/s.
    pub viscous_rate: f64,
    /// The largest stiffness of an element over its wave modulus. Infinite where an element's stiffness
    /// depends on other elements, so that there is no bound node by node.
    pub stiffening: f64,
    /// The largest strain |FᵀF − I| of an element; infinite where it is not known, which is for all but small strains of linear
    /// neo-Hookean tetrahedra.
    pub strain: f64,
}

impl FrequencyBound {
    /// The largest stable step of a leapfrog with lagged viscous forces, s: (2/omega)
    /// (sqrt(1 + xi^2) - xi) with xi = viscous rate / (2 omega) (T. Belytschko, W. K. Liu and
    /// B. Moran, Nonlinear Finite Elements for Continua and Structures, 2000, eq. 6.6.20).
    #[must_use]
    pub fn critical_step(&self) -> f64 {
        let omega = self.frequency2.sqrt();
        let xi = 0.5 * self.viscous_rate / omega;
        2.0 / omega * ((1.0 + xi * xi).sqrt() - xi)
    }

    fn raise(&mut self, frequency2: f64, viscous_rate: f64, stiffening: f64) {
        // A NaN bound must not pass for a small one.
        let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        self.frequency2 = larger(self.frequency2, frequency2);
        self.viscous_rate = larger(self.viscous_rate, viscous_rate);
        self.stiffening = larger(self.stiffening, stiffening);
    }
}

impl DeformableModel {
    /// A bound of the highest frequency at positions `x` (m) with the history `old`.
    ///
    /// For T4 and T10 it is proven for every state in which the materials' stiffness bounds hold. It exceeds
    /// the true omega by at most half for meshes of usual shapes (see the tests). With F-bar and averaged
    /// pressures it is proven for small strain. At finite strain these bounds contain the ratios by which
    /// volume changes differ within an average, and a bound of the terms due to stress.
    ///
    /// # Errors
    ///
    /// [`ElementFailure`] as from [`DeformableModel::internal_forces`].
    pub fn stable_frequency2(
        &self,
        x: &[Vector3],
        old: &[f64],
    ) -> Result<FrequencyBound, ElementFailure> {
        self.check_lengths(x, old)?;
        let state = State { x, v: &[], old };
        let bound = match self.element {
            Element::T4 => match self.bound_within(x) {
                Some(bound) => return Ok(bound),
                None => self.own_bound(&T4, false, state),
            },
            Element::T10 => self.own_bound(&T10, false, state),
            Element::T10Fbar => self.own_bound(&T10, true, state),
            Element::T4NodalPressure => self.averaged_bound(state),
        };
        Ok(FrequencyBound {
            strain: f64::INFINITY,
            ..bound?
        })
    }

    /// The bound from the magnitude of strain alone, slightly larger than that from the full state; `None`
    /// for elements that are not batched, or at large strain.
    fn bound_within(&self, x: &[Vector3]) -> Option<FrequencyBound> {
        let rows = self.batch.as_ref()?.squared_strains(x);
        let mut bound = FrequencyBound::default();
        let strains = rows.iter().flat_map(|row| &row.0);
        for ((e, coupling), strain) in self.couplings.iter().enumerate().zip(strains) {
            let AnyMaterial::NeoHookean(law) = self.material(e) else {
                return None;
            };
            let strain = strain.sqrt();
            let stiffness = law.stiffness_bound_within(strain)?;
            bound.strain = bound.strain.max(strain);
            bound.raise(stiffness * coupling, 0.0, stiffness / self.modulus(e));
        }
        Some(bound)
    }

    fn own_bound<const N: usize, const Q: usize>(
        &self,
        table: &Table<N, Q>,
        bar: bool,
        state: State,
    ) -> Result<FrequencyBound, ElementFailure> {
        let (elements, _) = self.connectivity.as_chunks::<N>();
        let mut bound = FrequencyBound::default();
        for (e, nodes) in elements.iter().enumerate() {
            let points = self.points(table, e, nodes, state);
            let bars = if bar {
                Some(self.bars(e, &points)?)
            } else {
                None
            };
            let (mut stiffness, mut viscosity) = (0.0_f64, 0.0_f64);
            for (q, point) in points.iter().enumerate() {
                let old = &state.old[self.history_at(e, q)];
                let (own, viscous) = match &bars {
                    None => self.stiffness(e, point, old)?,
                    Some(bars) => {
                        let largest = bars.points.iter().map(|b| b.ratio).fold(0.0, f64::max);
                        self.bar_stiffness(e, &bars.points[q], largest / bars.mean, old)?
                    }
                };
                stiffness = stiffness.max(own);
                viscosity = viscosity.max(viscous);
            }
            let stiffening = if bar {
                f64::INFINITY
            } else {
                stiffness / self.modulus(e)
            };
            let coupling = self.couplings[e];
            bound.raise(stiffness * coupling, viscosity * coupling, stiffening);
        }
        Ok(bound)
    }

    /// The stiffness of an average can come from any of its elements, with the weights of the averaging forth
    /// and back: theta_e^2 <= mean over its averages of theta'^2.
    fn averaged_bound(&self, state: State) -> Result<FrequencyBound, ElementFailure> {
        let Some(averages) = &self.averages else {
            return Ok(FrequencyBound::default());
        };
        let mut work = Workspace::default();
        let bars = self.nodal_bars(averages, state, &mut work)?;
        let inverse_means: Vec<f64> = bars.iter().map(|(bar, _)| 1.0 / bar.mean).collect();
        let spread = averages.smoothed(&self.volumes, &inverse_means);
        let mut nodal = vec![(0.0_f64, 0.0_f64); averages.volumes.len()];
        for (e, (bar, _)) in bars.iter().enumerate() {
            let old = &state.old[self.history_at(e, 0)];
            let (own, viscous) = self.bar_stiffness(e, bar, bar.ratio * spread[e], old)?;
            for &n in &averages.of[e] {
                let largest = &mut nodal[n as usize];
                *largest = (largest.0.max(own), largest.1.max(viscous));
            }
        }
        let mut bound = FrequencyBound::default();
        for (of, t) in averages.of.iter().zip(&self.couplings) {
            for &n in of {
                let (stiffness, viscosity) = nodal[n as usize];
                bound.raise(stiffness * t, viscosity * t, f64::INFINITY);
            }
        }
        Ok(bound)
    }

    /// Bounds of the elastic and the viscous modulus at a point.
    fn stiffness(
        &self,
        e: usize,
        felt: &Deformation,
        old: &[f64],
    ) -> Result<(f64, f64), ElementFailure> {
        let material = self.material(e);
        let bounds = (
            material.stiffness_bound(felt, old),
            material.viscosity_bound(felt),
        );
        if bounds.0.is_finite() && bounds.1.is_finite() {
            Ok(bounds)
        } else {
            Err(self.failure(e, &felt.gradient))
        }
    }

    /// The same at a point with an averaged volume change, where `spread` is the largest weight of this
    /// point's volume change in the averages. With l = dF F^-1 and theta = dJbar/Jbar, the law gets
    /// lbar = l + (theta - tr l)/3 I, and alpha theta^2 + beta |lbar|^2 <= spread (alpha tr^2 l + beta |l|^2)
    /// in sum over the average. The second variation of Fbar adds (eta^2 + d eta) tr tau + 2 eta tau : l
    /// with eta = (theta - tr l)/3.
    fn bar_stiffness(
        &self,
        e: usize,
        bar: &Bar,
        spread: f64,
        old: &[f64],
    ) -> Result<(f64, f64), ElementFailure> {
        let felt = Deformation::at_rest(bar.gradient());
        let (elastic, viscous) = self.stiffness(e, &felt, old)?;
        let mut next = vec![0.0; old.len()];
        let piola = self.respond(e, &felt, old, &mut next)?.piola;
        let kirchhoff: Matrix3 = piola * felt.gradient.transpose();
        let spread = spread.max(1.0);
        let shortest2 = (felt.smallest_stretch() / bar.factor).powi(2);
        let stress = (16.0 / 9.0 * kirchhoff.trace().abs() + 13.0 / 9.0 * kirchhoff.norm())
            * spread
            / shortest2;
        let scale = spread * bar.factor.powi(2).max(1.0);
        Ok((elastic * scale + stress, viscous * scale))
    }
}
