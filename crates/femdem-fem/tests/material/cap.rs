//! The law of powders with a cap: its surfaces, the curve of a die, and strain steps of any size.

use super::states::rand_free::Random;
use super::states::{self, YOUNG, powder, respond};
use femdem_fem::material::{AnyMaterial, Deformation, DruckerPragerCap, Material, Response};
use femdem_mesh::{Matrix3, Vector3};

const POISSON: f64 = 0.2;
const BULK: f64 = YOUNG / (3.0 * (1.0 - 2.0 * POISSON));
const SHEAR: f64 = YOUNG / (2.0 * (1.0 + POISSON));
const COHESION: f64 = 5e-3 * YOUNG;
const ECCENTRICITY: f64 = 0.6;

/// A point of powder with its history.
struct Point {
    law: AnyMaterial,
    history: Vec<f64>,
}

impl Point {
    fn new(law: DruckerPragerCap) -> Self {
        let law = AnyMaterial::from(law);
        let history = vec![0.0; law.history_len()];
        Self { law, history }
    }

    /// Goes to a deformation; returns the stress on the compacted powder, e^kappa tau.
    fn go(&mut self, gradient: &Matrix3) -> (Matrix3, Response) {
        let d = Deformation::at_rest(*gradient);
        let (response, new) = respond(&self.law, &d, &self.history);
        self.history = new;
        let tau = response.piola * gradient.transpose();
        (tau * self.compaction().exp(), response)
    }

    /// Goes to principal logarithmic strains.
    fn strain(&mut self, strains: [f64; 3]) -> Matrix3 {
        let stretches = Vector3::from(strains.map(f64::exp));
        self.go(&Matrix3::from_diagonal(&stretches)).0
    }

    fn compaction(&self) -> f64 {
        self.history[6]
    }
}

/// p, positive in compression, and q.
fn invariants(stress: &Matrix3) -> [f64; 2] {
    let p = -stress.trace() / 3.0;
    let deviator = stress + Matrix3::identity() * p;
    [p, (1.5 * deviator.norm_squared()).sqrt()]
}

/// Compressed on all sides by kappa + p_b(kappa)/K the powder bears p_b(kappa), in steps of any size, across the
/// corners of its curve and beyond its end; it unloads with K; and where it opens p_b stays.
#[test]
fn isotropic_compression_follows_the_curve() {
    let law = powder(5e-3, ECCENTRICITY);
    let curve = |kappa: f64| match kappa {
        k if k < 0.05 => (5e-3 + 0.1 * k) * YOUNG,
        k if k < 0.1 => (1e-2 + 1.8 * (k - 0.05)) * YOUNG,
        k => (0.1 + (k - 0.1)) * YOUNG,
    };
    for steps in [1, 3, 40] {
        let mut point = Point::new(law.clone());
        let mut last = 0.0;
        for step in 1..=steps {
            let kappa = 0.5 * f64::from(step) / f64::from(steps);
            last = kappa + curve(kappa) / BULK;
            let [p, q] = invariants(&point.strain([-last / 3.0; 3]));
            assert!((p / curve(kappa) - 1.0).abs() < 1e-12, "{p}");
            assert!((point.compaction() - kappa).abs() < 1e-12 && q < 1e-12 * p);
        }
        let [p, _] = invariants(&point.strain([-(last - 0.1) / 3.0; 3]));
        assert!((p - curve(0.5) + 0.1 * BULK).abs() < 1e-12 * YOUNG);
        // Torn, at d / tan(beta), and closed again: as strong as before.
        let [p, _] = invariants(&point.strain([0.1; 3]));
        assert!((p + COHESION / 1.1_f64.tan()).abs() < 1e-12 * YOUNG);
        assert!((point.compaction() - 0.5).abs() < 1e-12);
        let [p, _] = invariants(&point.strain([-1.0; 3]));
        assert!(p > curve(0.5), "{p}");
    }
}

/// Sheared at a constant volume, a compacted powder fails at q = d + p tan(beta), with its p, and keeps its volume, its
/// compaction and, turned at the same time, all of that.
#[test]
fn shear_ends_at_the_line() {
    let mut random = Random(21);
    for share in [-0.02, 0.0, 0.1, 0.2] {
        let mut point = Point::new(powder(5e-3, ECCENTRICITY));
        let top = point.strain([-0.05; 3]);
        let (kappa, pressure) = (point.compaction(), share * invariants(&top)[0]);
        let volume = -kappa - pressure / BULK;
        for shear in [0.05, 0.2, 0.5] {
            let strains = [shear, -0.3 * shear, -0.7 * shear].map(|e| e + volume / 3.0);
            let stretches = Vector3::from(strains.map(f64::exp));
            let turn = states::rotation(&mut random);
            let [p, q] = invariants(&point.go(&(turn * Matrix3::from_diagonal(&stretches))).0);
            assert!((p - pressure).abs() < 1e-10 * YOUNG, "{p} {pressure}");
            let limit = COHESION + pressure * 1.1_f64.tan();
            assert!((q - limit.max(0.0)).abs() < 1e-10 * YOUNG, "{q} {limit}");
            assert_eq!(point.compaction(), kappa);
        }
    }
}

/// The rate equations of compression in a die by small steps of the trapezoid: axial and radial stress on the
/// compacted powder, positive in compression, over the axial strain.
struct Die {
    stress: [f64; 2],
    kappa: f64,
}

impl Die {
    fn curve(kappa: f64) -> [f64; 2] {
        let knots = [[0.0, 5e-3], [0.05, 1e-2], [0.1, 0.1], [0.2, 0.2]];
        let k = (0..2).find(|&k| kappa < knots[k + 1][0]).unwrap_or(2);
        let slope = (knots[k + 1][1] - knots[k][1]) / (knots[k + 1][0] - knots[k][0]);
        [knots[k][1] + slope * (kappa - knots[k][0]), slope].map(|v| v * YOUNG)
    }

    /// (p - p_a)^2 + R^2 q^2 - R^2 (d + p_a tan beta)^2.
    fn excess(stress: [f64; 2], kappa: f64) -> f64 {
        let (r, slope) = (ECCENTRICITY, 1.1_f64.tan());
        let centre = (Self::curve(kappa)[0] - r * COHESION) / (1.0 + r * slope);
        let (p, q) = ((stress[0] + 2.0 * stress[1]) / 3.0, stress[0] - stress[1]);
        (p - centre).powi(2) + r * r * (q * q - (COHESION + centre * slope).powi(2))
    }

    /// Rates of the stresses and of the compaction per unit of axial strain, with slopes by differences.
    fn rates(stress: [f64; 2], kappa: f64) -> [f64; 3] {
        let (lame, two_mu) = (BULK - SHEAR / 1.5, 2.0 * SHEAR);
        let elastic = [lame + two_mu, lame];
        if Self::excess(stress, kappa) < 0.0 {
            return [elastic[0], elastic[1], 0.0];
        }
        let by = |da: f64, dr: f64| {
            let at =
                |sign: f64| Self::excess([stress[0] + sign * da, stress[1] + sign * dr], kappa);
            0.5 * (at(1.0) - at(-1.0))
        };
        let h = 1e-6 * YOUNG;
        // Both radial stresses together; flow is that of one.
        let (axial, radial) = (by(h, 0.0) / h, by(0.0, h) / h);
        let hard = (Self::excess(stress, kappa + 1e-7) - Self::excess(stress, kappa)) / 1e-7;
        let flow = [axial, 0.5 * radial];
        let volume = flow[0] + 2.0 * flow[1];
        let stiff = flow.map(|f| lame * volume + two_mu * f);
        let rate = (axial * elastic[0] + radial * elastic[1])
            / (axial * stiff[0] + radial * stiff[1] - hard * volume);
        [
            elastic[0] - rate * stiff[0],
            elastic[1] - rate * stiff[1],
            rate * volume,
        ]
    }

    fn press(&mut self, strain: f64) {
        let first = Self::rates(self.stress, self.kappa);
        let after = |rates: [f64; 3]| {
            let stress = [0, 1].map(|k| self.stress[k] + strain * rates[k]);
            (stress, self.kappa + strain * rates[2])
        };
        let (stress, kappa) = after(first);
        let second = Self::rates(stress, kappa);
        (self.stress, self.kappa) = after([0, 1, 2].map(|k| 0.5 * (first[k] + second[k])));
    }
}

/// Compression in a die, with the true stress on its punch, against the rate equations; then the stress is relieved with
/// K + 4/3 mu.
#[test]
fn a_die_follows_the_rate_equations() {
    let mut point = Point::new(powder(5e-3, ECCENTRICITY));
    let mut die = Die {
        stress: [0.0; 2],
        kappa: 0.0,
    };
    let mut top = Matrix3::zeros();
    for step in 1..=200 {
        let strain = 0.001 * f64::from(step);
        for _ in 0..200 {
            die.press(0.001 / 200.0);
        }
        for part in [0.8, 0.6, 0.4, 0.2, 0.0] {
            top = point.strain([0.0, 0.0, 0.001 * part - strain]);
        }
        for (stress, expected) in [(-top.m33, die.stress[0]), (-top.m11, die.stress[1])] {
            let error = (stress - expected).abs() / (expected + 1e-3 * YOUNG);
            assert!(error < 5e-3, "{step}: {stress} {expected}");
        }
        let error = (point.compaction() - die.kappa).abs();
        assert!(error < 2e-4, "{}", point.compaction() - die.kappa);
    }
    println!("die: {:.4} of the rates", -top.m33 / die.stress[0]);
    let kappa = point.compaction();
    let relieved = point.strain([0.0, 0.0, -0.199]);
    let slope = (relieved.m33 - top.m33) / 1e-3;
    assert!((slope / (BULK + SHEAR / 0.75) - 1.0).abs() < 1e-10 && point.compaction() == kappa);
}

/// Any step of any size: the stress ends within the surfaces, on one of them if anything flowed, and nothing is created.
#[test]
fn steps_of_any_size_end_on_the_surfaces() {
    let mut random = Random(31);
    let mut worst = 0.0_f64;
    for _ in 0..3000 {
        let mut between =
            |low: f64, high: f64| low * (high / low).powf(0.5 + 0.5 * random.signed());
        let (cohesion, r) = (between(1e-9, 1.0) * YOUNG, between(1e-2, 1e2));
        let (beta, first) = (between(0.02, 1.55), between(1e-9, 1.0) * YOUNG);
        let (knot, second) = (between(1e-6, 1.0), first * between(1.0001, 1e6));
        let third = second * between(1.0001, 1e3);
        let curve = vec![[0.0, first], [knot, second], [2.0 * knot, third]];
        let law = DruckerPragerCap::new(YOUNG, POISSON, cohesion, beta, r, curve).unwrap();
        let size = between(1e-6, 3.0);
        let mut point = Point::new(law.clone());
        for _ in 0..4 {
            let before = point.history.clone();
            let (stress, response) = point.go(&states::gradient(&mut random, size));
            let [p, q] = invariants(&stress);
            let pb = law.yield_pressure(point.compaction());
            let centre = (pb - r * cohesion) / (1.0 + r * beta.tan());
            let radius = r * (cohesion + centre * beta.tan());
            // Relative to the stress, to which round-off of the strains is amplified by at most tan(beta) and R.
            let excess = if p > centre {
                ((p - centre).hypot(r * q) - radius) / (r * YOUNG * size + pb + r * cohesion)
            } else {
                (q - cohesion - p * beta.tan()) / (YOUNG * size + q) / (1.0 + beta.tan())
            };
            let tension = (-cohesion / beta.tan() - p) / (YOUNG * size);
            worst = worst.max(excess).max(tension);
            assert!(point.compaction() >= before[6] && response.plastic_work >= 0.0);
            let flowed = point.history != before && p > -cohesion / beta.tan() + 1e-9 * YOUNG;
            assert!(!flowed || excess > -1e-9, "{excess}");
        }
    }
    println!("largest excess {worst:.1e}");
    assert!(worst < 1e-9);
}

/// Over random closed loops of strain the work is not negative, whatever the state they begin in.
#[test]
fn closed_loops_take_work() {
    let mut random = Random(41);
    for loops in 0..40 {
        let mut point = Point::new(powder([0.0, 5e-3, 2e-2][loops % 3], ECCENTRICITY));
        let start = states::gradient(&mut random, 0.1);
        point.go(&start);
        let shapes: [Matrix3; 3] =
            std::array::from_fn(|_| Matrix3::from_fn(|_, _| 0.02 * random.signed()));
        let (mut before, mut work) = (point.go(&start).1, 0.0);
        let energy = before.energy;
        for step in 1..=400 {
            let at = |step: u32| {
                let angle = std::f64::consts::TAU * f64::from(step) / 400.0;
                let turn = shapes[0] * angle.sin()
                    + shapes[1] * (1.0 - angle.cos())
                    + shapes[2] * (2.0 * angle).sin();
                (Matrix3::identity() + turn) * start
            };
            let after = point.go(&at(step)).1;
            work += 0.5 * (before.piola + after.piola).dot(&(at(step) - at(step - 1)));
            assert!(after.plastic_work >= 0.0);
            before = after;
        }
        assert!(
            work + energy - before.energy > -1e-9 * YOUNG,
            "{loops} {work}"
        );
    }
}
