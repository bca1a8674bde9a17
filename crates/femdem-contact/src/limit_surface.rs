//! What Coulomb's law allows a patch in friction force and torsion moment together.
//!
//! While a patch slides with velocity v and spin w about its centre of pressure x_p, its friction is the gradient of the
//! dissipation
//!
//! D(v, w) = mu int p(x) |v + w n x (x - x_p)| dS,   F = dD/dv,   M = dD/dw,
//!
//! and these values bound it while it sticks. The bounds of each alone are F_max = mu N and M_max = mu int p |x - x_p|
//! dS. In between, with f = F/F_max and m = M/M_max, the surface of a disc under uniform pressure is used. With the
//! distance s R = v/w of the centre of rotation from the disc's centre, up to s = 1,
//!
//! f = 4/(3 pi s) ((1 + s^2) E(s) - (1 - s^2) K(s)),
//! D = 4/(9 pi) ((7 + s^2) E(s) - 4 (1 - s^2) K(s)) w R F_max,   M = dD/dw,
//!
//! with the complete elliptic integrals E and K of modulus s. It is represented by f^2 + m^2 + f^2 m^2 a(f^2) = 1 with
//! a cubic a that has the right curvatures at both ends (f = s for slow sliding, F v = D - w^2 R^2 F_max/(8 v) for slow spin)
//! and stays within 4e-4 of the surface (test `the_disc_is_represented`). Goyal, Ruina and Papadopoulos
//! (1991), Wear 143, 307-330, describe the limit surface; for other patches than discs the tests state the distance.

/// Coefficients of a(f^2): fitted to the disc, with a(0) = 1/2 and a(1) = 7/9 from the curvatures at the ends.
const DISC: [f64; 4] = [
    0.5,
    0.194_121_56,
    0.620_870_93,
    7.0 / 9.0 - 0.5 - 0.194_121_56 - 0.620_870_93,
];

/// Friction forces and torsion moments that a patch can carry together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitSurface {
    /// Largest friction force mu N, N, not negative.
    pub force: f64,
    /// Largest torsion moment mu int p |x - x_p| dS, N m, not negative.
    pub moment: f64,
}

/// A point of the normalised surface and its tangent.
struct Point {
    f: f64,
    m: f64,
    /// Derivatives of f and m along the surface.
    tangent: [f64; 2],
}

/// The point of the normalised surface with f = 2 t/(1 + t^2), t from 0 to 1.
fn point(t: f64) -> Point {
    let square = t * t;
    let (f, c) = (2.0 * t / (1.0 + square), (1.0 - square) / (1.0 + square));
    let x = f * f;
    let [a0, a1, a2, a3] = DISC;
    let a = a0 + x * (a1 + x * (a2 + x * a3));
    // m = c/sqrt(1 + x a), with x a differentiated by x.
    let slope = a0 + x * (2.0 * a1 + x * (3.0 * a2 + x * 4.0 * a3));
    let h = 1.0 / (1.0 + x * a).sqrt();
    Point {
        f,
        m: c * h,
        tangent: [c, -f * h * (1.0 + c * c * slope * h * h)],
    }
}

/// Size up to which ratios of loads to bounds are told apart.
const HUGE: f64 = 1e100;

/// Above 0 outside of the normalised surface.
fn excess(f: f64, m: f64) -> f64 {
    let (x, y) = (f * f, m * m);
    let [a0, a1, a2, a3] = DISC;
    x + y + x * y * (a0 + x * (a1 + x * (a2 + x * a3))) - 1.0
}

impl LimitSurface {
    /// Fractions of a friction force (N) and a torsion moment (N m) that remain within the surface; both 1 if
    /// they are within.
    ///
    /// Outside, the point of the surface that is closest to them in the energy of the springs, `stiffness` N/m and
    /// `torsion_stiffness` N m, is taken: the springs then slip along the normal of the surface, in which direction Coulomb's
    /// law dissipates most. Neither fraction is negative or above 1.
    pub fn within(
        &self,
        force: f64,
        moment: f64,
        stiffness: f64,
        torsion_stiffness: f64,
    ) -> [f64; 2] {
        let ratio = |x: f64, bound: f64| match x.abs() {
            0.0 => 0.0,
            x => (x / bound).min(HUGE),
        };
        let (p, q) = (ratio(force, self.force), ratio(moment, self.moment));
        if p <= 1.0 && q <= 1.0 && excess(p, q) <= 0.0 {
            return [1.0; 2];
        }
        // The square of a ratio of two mean radii of the patch: about 1, unless it has hardly any stiffness.
        let radius = self.moment / self.force;
        let metric = radius * radius * (stiffness / torsion_stiffness);
        let metric = if metric.is_finite() {
            metric.clamp(1e-3, 1e3)
        } else {
            1.0
        };
        let Point { f, m, .. } = if p == 0.0 || self.force <= 0.0 {
            point(0.0)
        } else if q == 0.0 || self.moment <= 0.0 {
            point(1.0)
        } else {
            closest(p, q, metric)
        };
        let part = |to: f64, from: f64, bound: f64| {
            if from <= to {
                1.0
            } else if bound > 0.0 {
                to / from
            } else {
                0.0
            }
        };
        [part(f, p, self.force), part(m, q, self.moment)]
    }
}

/// The point of the normalised surface that is closest to (p, q) outside, with weight `metric` on the square of the
/// distance in m.
fn closest(p: f64, q: f64, metric: f64) -> Point {
    // Half the derivative of the squared distance along the surface; negative at t = 0 and positive at t = 1.
    let slope = |t: f64| {
        let at = point(t);
        (at.f - p) * at.tangent[0] + metric * (at.m - q) * at.tangent[1]
    };
    // Regula falsi; an end that stays twice counts half (Dowell and Jarratt 1971, "Illinois").
    let (mut low, mut high) = (0.0, 1.0);
    let (mut below, mut above) = (slope(low), slope(high));
    let mut side = 0;
    for _ in 0..60 {
        let t = (low * above - high * below) / (above - below);
        let here = slope(t);
        if here > 0.0 {
            (high, above) = (t, here);
            below *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (low, below) = (t, here);
            above *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        }
        if high - low < 1e-12 || here.abs() < 1e-12 * (p + metric * q) {
            return point(t);
        }
    }
    point(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pressure over points of a plane: positions from its centre and weights that add up to 1.
    struct Pressure(Vec<([f64; 2], f64)>);

    impl Pressure {
        /// Of density `p` on the rectangle of half widths `half`.
        fn new(half: [f64; 2], p: impl Fn(f64, f64) -> f64) -> Self {
            const N: i32 = 400;
            let at =
                |i: i32, half: f64| half * (2.0 * f64::from(i) + 1.0 - f64::from(N)) / f64::from(N);
            let cells = (0..N * N).map(|i| [at(i / N, half[0]), at(i % N, half[1])]);
            let cells: Vec<_> = cells.map(|[x, y]| ([x, y], p(x, y))).collect();
            let total: f64 = cells.iter().map(|(_, p)| p).sum();
            let centre = |k: usize| cells.iter().map(|(x, p)| x[k] * p).sum::<f64>() / total;
            let [cx, cy] = [centre(0), centre(1)];
            Self(
                cells
                    .iter()
                    .map(|([x, y], p)| ([x - cx, y - cy], p / total))
                    .collect(),
            )
        }

        /// Friction force and torsion moment over their bounds, for sliding with velocity s in the direction `angle` and
        /// unit spin.
        fn carried(&self, s: f64, angle: f64) -> [f64; 2] {
            let most: f64 = self.0.iter().map(|([x, y], p)| x.hypot(*y) * p).sum();
            let (mut force, mut moment) = ([0.0; 2], 0.0);
            for ([x, y], p) in &self.0 {
                let v = [s * most * angle.cos() - y, s * most * angle.sin() + x];
                let rate = p / v[0].hypot(v[1]).max(f64::MIN_POSITIVE);
                force[0] += v[0] * rate;
                force[1] += v[1] * rate;
                moment += (x * v[1] - y * v[0]) * rate;
            }
            [force[0].hypot(force[1]), moment / most]
        }

        /// The smallest and the largest factor by which the represented surface must grow to reach this patch's.
        fn distance(&self) -> [f64; 2] {
            let mut range = [f64::INFINITY, 0.0_f64];
            for angle in [0.0, 0.4, 0.8, 1.2, std::f64::consts::FRAC_PI_2] {
                for s in [0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3, 1.7, 2.5, 4.0, 10.0] {
                    let [f, m] = self.carried(s, angle);
                    let unit = LimitSurface {
                        force: 1.0,
                        moment: 1.0,
                    };
                    // Along the ray through the origin, by bisection.
                    let (mut low, mut high) = (0.5, 2.0);
                    for _ in 0..50 {
                        let k = 0.5 * (low + high);
                        let inside = unit.within(f / k, m / k, 1.0, 1.0) == [1.0; 2];
                        *(if inside { &mut high } else { &mut low }) = k;
                    }
                    range = [range[0].min(high), range[1].max(high)];
                }
            }
            range
        }
    }

    fn assert_range(patch: &Pressure, low: f64, high: f64) {
        let [least, most] = patch.distance();
        assert!(
            (least - low).abs() < 2e-3 && (most - high).abs() < 2e-3,
            "{least} {most}"
        );
    }

    /// Within 1 %, which contains the quadrature's own error.
    #[test]
    fn the_disc_is_represented() {
        let disc = Pressure::new([1.0; 2], |x, y| if x.hypot(y) < 1.0 { 1.0 } else { 0.0 });
        assert_range(&disc, 1.0, 1.0);
    }

    /// Coulomb's law integrated over other patches: where the surface lies against theirs.
    #[test]
    fn other_patches_are_near() {
        let square = Pressure::new([1.0; 2], |_, _| 1.0);
        assert_range(&square, 0.997, 1.007);
        let cap = Pressure::new([1.0; 2], |x, y| (1.0 - x * x - y * y).max(0.0));
        assert_range(&cap, 1.000, 1.010);
        let wedge = Pressure::new([1.0; 2], |x, _| 1.0 + x);
        assert_range(&wedge, 0.991, 1.042);
        let strip = Pressure::new([10.0, 1.0], |_, _| 1.0);
        assert_range(&strip, 0.926, 1.112);
    }

    /// The chosen point is on the surface, and the step to it is along the normal in the metric of the springs: no other
    /// point of the surface is nearer.
    #[test]
    fn a_trial_returns_to_the_closest_point() {
        let bounds = LimitSurface {
            force: 3.0,
            moment: 0.2,
        };
        for (k, k_theta) in [(1.0, 0.004), (1.0, 0.1), (5.0, 0.001)] {
            for trial in [
                [3.1, 0.01],
                [0.2, 0.4],
                [2.5, 0.15],
                [400.0, 7.0],
                [3.0, 90.0],
            ] {
                let [force, moment] = trial;
                let [a, b] = bounds.within(force, moment, k, k_theta);
                let found = [force * a, moment * b];
                let off = excess(found[0] / bounds.force, found[1] / bounds.moment);
                assert!(off.abs() < 1e-9, "{off}");
                let energy =
                    |f: f64, m: f64| (f - force).powi(2) / k + (m - moment).powi(2) / k_theta;
                let best = energy(found[0], found[1]);
                for i in 0..=1000 {
                    let Point { f, m, .. } = point(f64::from(i) / 1000.0);
                    let other = energy(f * bounds.force, m * bounds.moment);
                    assert!(best <= other * (1.0 + 1e-12), "{trial:?}");
                }
            }
        }
    }

    #[test]
    fn patches_without_bounds_or_loads() {
        let held = |force, moment, f, m| LimitSurface { force, moment }.within(f, m, 1.0, 1.0);
        assert_eq!(held(0.0, 0.0, 0.0, 0.0), [1.0; 2]);
        assert_eq!(held(0.0, 0.0, 1.0, 1.0), [0.0; 2]);
        assert_eq!(held(1.0, 0.0, 0.5, 1.0), [1.0, 0.0]);
        assert_eq!(held(1.0, 0.0, 4.0, 1.0), [0.25, 0.0]);
        assert_eq!(held(1.0, 1.0, 4.0, 0.0), [0.25, 1.0]);
        assert_eq!(held(1.0, 1.0, 0.0, 4.0), [1.0, 0.25]);
        assert_eq!(held(1.0, 1.0, 0.6, 0.6), [1.0; 2]);
        let tiny = held(1e-300, 1e-310, 1e300, 1e300);
        assert!(tiny.iter().all(|x| (0.0..1e-90).contains(x)), "{tiny:?}");
    }
}
