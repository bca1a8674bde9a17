//! The deformation gradient with its volume change replaced by an average, in energy form.
//!
//! Fbar = s F with s = (Jbar/J)^(1/3), where Jbar is an average of J over points. With the stress
//! Pbar of Fbar and c = Pbar : Fbar, the energy sum w W(Fbar) varies by
//!
//! sum w [ s Pbar : dF + (c/3) (dJbar/Jbar - F^-T : dF) ].
//!
//! The term with dJbar is collected at every point that contributes to the average; there it is J kappa F^-T
//! : dF, where kappa, the averaged pressure, is supplied by the averaging.

use femdem_mesh::Matrix3;

/// A point with an averaged volume change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bar {
    gradient: Matrix3,
    /// F^-T.
    inverse_t: Matrix3,
    /// J.
    pub ratio: f64,
    /// Jbar.
    pub mean: f64,
    /// s.
    pub factor: f64,
}

impl Bar {
    /// A point at rest.
    pub const fn undeformed() -> Self {
        let identity = Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        Self {
            gradient: identity,
            inverse_t: identity,
            ratio: 1.0,
            mean: 1.0,
            factor: 1.0,
        }
    }

    /// `None` unless both volume ratios are positive and finite.
    #[inline]
    pub fn new(gradient: Matrix3, ratio: f64, mean: f64) -> Option<Self> {
        let positive = |j: f64| j > 0.0 && j.is_finite();
        if !(positive(ratio) && positive(mean)) {
            return None;
        }
        Some(Self {
            gradient,
            inverse_t: gradient.try_inverse()?.transpose(),
            ratio,
            mean,
            factor: (mean / ratio).cbrt(),
        })
    }

    /// Fbar.
    #[inline]
    pub fn gradient(&self) -> Matrix3 {
        self.gradient * self.factor
    }

    /// dJ/dF = J F^-T.
    pub fn cofactor(&self) -> Matrix3 {
        self.inverse_t * self.ratio
    }

    /// dJ for a change of F.
    #[inline]
    pub fn ratio_change(&self, change: &Matrix3) -> f64 {
        self.ratio * self.inverse_t.dot(change)
    }

    /// dFbar for a change of F and of Jbar.
    #[inline]
    pub fn gradient_change(&self, change: &Matrix3, mean_change: f64) -> Matrix3 {
        (change + self.gradient * self.log_factor_change(change, mean_change)) * self.factor
    }

    fn log_factor_change(&self, change: &Matrix3, mean_change: f64) -> f64 {
        (mean_change / self.mean - self.inverse_t.dot(change)) / 3.0
    }

    /// c = Pbar : Fbar, three times the mean Kirchhoff stress.
    #[inline]
    pub fn trace(&self, piola: &Matrix3) -> f64 {
        piola.dot(&self.gradient) * self.factor
    }

    /// The stress that is work conjugate to F, from Pbar and the averaged pressure kappa.
    #[inline]
    pub fn stress(&self, piola: &Matrix3, pressure: f64) -> Matrix3 {
        let spherical = self.ratio * pressure - self.trace(piola) / 3.0;
        piola * self.factor + self.inverse_t * spherical
    }

    /// dc, from the changes of Pbar and of Fbar.
    pub fn trace_change(&self, piola: &Matrix3, piola_change: &Matrix3, bar: &Matrix3) -> f64 {
        piola_change.dot(&self.gradient()) + piola.dot(bar)
    }

    /// The change of [`Bar::stress`].
    pub fn stress_change(&self, piola: &Matrix3, pressure: f64, change: &BarChange) -> Matrix3 {
        let g = &self.inverse_t;
        let spherical = self.ratio * pressure - self.trace(piola) / 3.0;
        let spherical_change = self.ratio_change(&change.gradient) * pressure
            + self.ratio * change.pressure
            - change.trace / 3.0;
        let log_factor = self.log_factor_change(&change.gradient, change.mean);
        (piola * log_factor + change.piola) * self.factor + g * spherical_change
            - g * change.gradient.transpose() * g * spherical
    }
}

/// Change of a point with an averaged volume change.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BarChange {
    /// dF.
    pub gradient: Matrix3,
    /// dJbar.
    pub mean: f64,
    /// dPbar, Pa.
    pub piola: Matrix3,
    /// dc, Pa.
    pub trace: f64,
    /// dkappa, Pa.
    pub pressure: f64,
}
