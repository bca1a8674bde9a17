//! How the traction of a crack falls as it opens.

use serde::{Deserialize, Serialize};

/// Part of the peak at which [`Softening::Exponential`] ends.
const TAIL: f64 = 0.01;

/// Traction over its peak, y, against the opening beyond that of the peak over G/T_0, x. The area under y is 1, so that the
/// energy G is dissipated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Softening {
    /// A straight line to x = 2.
    #[default]
    Linear,
    /// An exponential, shifted so that it ends: (e^(−c x) − ε)/(1 − ε) with ε = 0.01, to x = 4.8.
    Exponential,
    /// Two straight lines, through y = 1/3 at x = 0.8 to x = 3.6 (Petersson 1981, for concrete).
    Bilinear,
}

impl Softening {
    /// Traction over its peak at x.
    #[must_use]
    pub fn traction(self, x: f64) -> f64 {
        if x >= self.end() {
            return 0.0;
        }
        match self {
            Self::Linear => 1.0 - 0.5 * x,
            Self::Exponential => ((-decay() * x).exp() - TAIL) / (1.0 - TAIL),
            Self::Bilinear if x < 0.8 => 1.0 - x * (2.0 / 2.4),
            Self::Bilinear => (3.6 - x) / 8.4,
        }
    }

    /// Area under the traction from 0 to x, in closed form.
    #[must_use]
    pub fn area(self, x: f64) -> f64 {
        if x >= self.end() {
            return 1.0;
        }
        match self {
            Self::Linear => x - 0.25 * x * x,
            Self::Exponential => (-(-decay() * x).exp_m1() / decay() - TAIL * x) / (1.0 - TAIL),
            Self::Bilinear if x < 0.8 => x - x * x * (1.0 / 2.4),
            Self::Bilinear => 1.0 - (3.6 - x) * (3.6 - x) / 16.8,
        }
    }

    /// How fast the traction falls from its peak on: −dy/dx at x = 0, where it is steepest.
    #[must_use]
    pub fn slope(self) -> f64 {
        match self {
            Self::Linear => 0.5,
            Self::Exponential => decay() / (1.0 - TAIL),
            Self::Bilinear => 2.0 / 2.4,
        }
    }

    /// Where the traction has ended.
    #[must_use]
    pub fn end(self) -> f64 {
        match self {
            Self::Linear => 2.0,
            Self::Exponential => -TAIL.ln() / decay(),
            Self::Bilinear => 3.6,
        }
    }
}

/// The c with which the area of the shifted exponential is 1: ∫ (e^(−c x) − ε) dx = (1 − ε + ε ln ε)/c.
fn decay() -> f64 {
    (1.0 - TAIL + TAIL * TAIL.ln()) / (1.0 - TAIL)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Softening; 3] = [
        Softening::Linear,
        Softening::Exponential,
        Softening::Bilinear,
    ];

    /// The area is the integral of the traction, which falls from 1 to 0, and is 1 at the end.
    #[test]
    fn areas_are_those_under_the_tractions() {
        for law in ALL {
            assert_eq!((law.traction(0.0), law.area(0.0)), (1.0, 0.0));
            let (n, end) = (200_000, law.end());
            let step = end / f64::from(n);
            let mut sum = 0.0;
            let mut before = 1.0;
            for k in 0..n {
                sum += law.traction((f64::from(k) + 0.5) * step) * step;
                let x = f64::from(k + 1) * step;
                let fall = (before - law.traction(x)) / step;
                assert!(
                    (0.0..=law.slope() * (1.0 + 1e-6)).contains(&fall),
                    "{law:?} at {x}"
                );
                assert!(k > 0 || fall > 0.999 * law.slope());
                before = law.traction(x);
                assert!((law.area(x) - sum).abs() < 1e-9, "{law:?} at {x}");
            }
            assert!(
                (sum - 1.0).abs() < 1e-9 && law.traction(0.999_999 * end) < 1e-5,
                "{law:?}"
            );
            assert_eq!((law.traction(2.0 * end), law.area(2.0 * end)), (0.0, 1.0));
        }
    }
}
