//! Plastic laws against closed forms and the balance of energy.

use super::states::rand_free::Random;
use super::states::{self, Case, YOUNG, respond};
use femdem_fem::material::{AnyMaterial, Deformation, DruckerPrager, J2, Material, Voce};
use femdem_mesh::{Matrix3, Vector3};

const POISSON: f64 = 0.3;
const YIELD: f64 = 0.01 * YOUNG;
const HARDENING: f64 = 0.05 * YOUNG;

/// A specimen in a testing machine: axial stretch along x, the same stretch along y and z.
struct Specimen {
    law: AnyMaterial,
    history: Vec<f64>,
    lateral: f64,
}

impl Specimen {
    fn new(law: impl Into<AnyMaterial>) -> Self {
        let law = law.into();
        let history = vec![0.0; law.history_len()];
        Self {
            law,
            history,
            lateral: 0.0,
        }
    }

    /// Axial and lateral Kirchhoff stress at these logarithmic strains, and the history at the end.
    fn at(&self, axial: f64, lateral: f64) -> ([f64; 2], Vec<f64>) {
        let stretches = Vector3::new(axial.exp(), lateral.exp(), lateral.exp());
        let d = Deformation::at_rest(Matrix3::from_diagonal(&stretches));
        let (response, new) = respond(&self.law, &d, &self.history);
        let kirchhoff = response.piola * d.gradient.transpose();
        ([kirchhoff.m11, kirchhoff.m22], new)
    }

    /// Strains the specimen axially with the lateral stress held; returns the axial stress.
    fn strain(&mut self, axial: f64, held: f64) -> f64 {
        let (mut low, mut high) = (self.lateral - 0.5, self.lateral + 0.5);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            let too_wide = self.at(axial, middle).0[1] > held;
            if too_wide {
                high = middle
            } else {
                low = middle
            }
        }
        self.lateral = 0.5 * (low + high);
        let ([stress, _], new) = self.at(axial, self.lateral);
        self.history = new;
        stress
    }
}

/// Linear hardening, uniaxial stress: tau = E eps below yield, then E (s0 + H eps)/(E + H); reverse yield at
/// minus the stress reached. The radial return is exact here for steps of any size.
#[test]
fn uniaxial_j2_follows_the_closed_form() {
    let metal = J2::new(YOUNG, POISSON, YIELD, HARDENING).unwrap();
    let plastic = |strain: f64| YOUNG * (YIELD + HARDENING * strain) / (YOUNG + HARDENING);
    for steps in [1, 7, 50] {
        let mut specimen = Specimen::new(metal);
        let mut reached = 0.0;
        for step in 1..=steps {
            let strain = 0.2 * step as f64 / steps as f64;
            reached = specimen.strain(strain, 0.0);
            let expected = plastic(strain).min(YOUNG * strain);
            assert!(
                (reached / expected - 1.0).abs() < 1e-10,
                "{steps}: {reached} {expected}"
            );
        }
        // Elastic until -reached, which is 2 reached/E lower, then hardening on the other side.
        let elastic = specimen.strain(0.2 - reached / YOUNG, 0.0);
        assert!(elastic.abs() < 1e-9 * reached);
        let turn = 0.2 - 2.0 * reached / YOUNG;
        let slope = YOUNG * HARDENING / (YOUNG + HARDENING);
        for further in [0.01, 0.05, 0.1] {
            let stress = specimen.strain(turn - further, 0.0);
            let expected = -reached - slope * further;
            assert!(
                (stress / expected - 1.0).abs() < 1e-10,
                "{stress} {expected}"
            );
        }
    }
}

/// With a Voce term, at the strain sigma_y(alpha)/E + alpha the stress is sigma_y(alpha), also where the
/// exponential has vanished and for a curve that rises a thousand times faster than elasticity.
#[test]
fn uniaxial_voce_follows_the_closed_form() {
    for rate in [0.1, 16.0, 1e3, 1e6] {
        let voce = Voce {
            stress: 3.0 * YIELD,
            rate,
        };
        let metal = J2::new(YOUNG, POISSON, YIELD, HARDENING).unwrap();
        let metal = metal.with_saturation(voce).unwrap();
        for alpha in [1e-6, 1e-4, 1e-2, 0.1, 0.3] {
            let curve = YIELD + HARDENING * alpha + 2.0 * YIELD * (1.0 - (-rate * alpha).exp());
            let stress = Specimen::new(metal).strain(curve / YOUNG + alpha, 0.0);
            assert!(
                (stress / curve - 1.0).abs() < 1e-9,
                "{rate} {alpha}: {stress} {curve}"
            );
        }
    }
}

/// Over random walks the stress stays on the yield surface, plastic flow preserves the volume, and elastic
/// steps leave the history unchanged, bit for bit.
#[test]
fn flow_stays_on_the_yield_surface_and_keeps_volume() {
    let metal = J2::new(YOUNG, POISSON, YIELD, HARDENING).unwrap();
    let law = AnyMaterial::from(metal);
    let mut random = Random(11);
    let mut gradient = Matrix3::identity();
    let mut old = vec![0.0; law.history_len()];
    let mut flows = 0;
    for _ in 0..2000 {
        gradient = states::gradient(&mut random, 0.01) * gradient;
        // Keeps the walk near volume 1, as for a metal.
        gradient /= gradient.determinant().cbrt();
        let (response, new) = respond(&law, &Deformation::at_rest(gradient), &old);
        let kirchhoff = response.piola * gradient.transpose();
        let deviator = kirchhoff - Matrix3::identity() * (kirchhoff.trace() / 3.0);
        let q = 1.5_f64.sqrt() * deviator.norm();
        let limit = YIELD + HARDENING * new[6];
        assert!(q <= limit * (1.0 + 1e-11));
        if new == old {
            assert_eq!(response.plastic_work, 0.0);
        } else {
            flows += 1;
            assert!((q / limit - 1.0).abs() < 1e-11 && new[6] > old[6]);
        }
        let [xx, yy, zz, yz, xz, xy] = [0, 1, 2, 3, 4, 5].map(|k| new[k]);
        let metric = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) + Matrix3::identity();
        assert!((metric.determinant() - 1.0).abs() < 1e-9);
        old = new;
    }
    assert!(flows > 200 && flows < 1990, "{flows}");
}

/// (work - stored - dissipated)/work over a closed loop of stretch, shear and rotation in `steps` steps.
fn imbalance(law: &AnyMaterial, steps: usize) -> f64 {
    let at = |t: f64| {
        let (sine, cosine) = (std::f64::consts::TAU * t).sin_cos();
        Matrix3::new(
            1.0 - 0.04 * sine,
            0.08 * sine * cosine,
            0.0,
            0.0,
            1.0 - 0.06 * (1.0 - cosine),
            0.05 * sine,
            0.03 * (1.0 - cosine),
            0.0,
            1.0 - 0.02 * sine,
        )
    };
    let mut old = vec![0.0; law.history_len()];
    let mut before = respond(law, &Deformation::at_rest(at(0.0)), &old).0;
    let (mut work, mut dissipated) = (0.0, 0.0);
    for step in 0..steps {
        let (start, end) = [step, step + 1].map(|s| at(s as f64 / steps as f64)).into();
        let (after, new) = respond(law, &Deformation::at_rest(end), &old);
        work += 0.5 * (before.piola + after.piola).dot(&(end - start));
        assert!(after.plastic_work >= 0.0, "flow dissipates");
        dissipated += after.plastic_work;
        (before, old) = (after, new);
    }
    println!(
        "{}: work {work:.3e}, dissipated {dissipated:.3e}",
        law.name()
    );
    assert!(dissipated > 0.2 * work && work > 0.0);
    (work - before.energy - dissipated) / work
}

/// The work over a loop is the stored and dissipated energy, to the order of the step (backward Euler).
#[test]
fn work_is_stored_or_dissipated() {
    for Case { law, .. } in states::plastic() {
        let [coarse, fine, finest] = [500, 1000, 4000].map(|steps| imbalance(&law, steps).abs());
        println!("{}: {coarse:.1e} {fine:.1e} {finest:.1e}", law.name());
        assert!(finest < 1e-3 && finest < 0.35 * fine.max(1e-6));
    }
}

const COHESION: f64 = 1e-3 * YOUNG;
const FRICTION: f64 = 0.6;

fn rock(dilatancy: f64) -> DruckerPrager {
    DruckerPrager::new(YOUNG, POISSON, COHESION, FRICTION, dilatancy).unwrap()
}

/// Triaxial compression under confining pressure s3: the cone is that of Mohr-Coulomb there,
/// s1 = s3 (1 + sin phi)/(1 - sin phi) + 2 c cos phi/(1 - sin phi) in compression; and the volume grows by
/// 2 sin psi/(1 - sin psi) of the axial plastic shortening.
#[test]
fn triaxial_strength_and_dilatancy_are_mohr_coulombs() {
    let (sine, cosine) = FRICTION.sin_cos();
    for dilatancy in [0.0, 0.3, 0.6] {
        for confining in [0.0, 2.0 * COHESION, 20.0 * COHESION] {
            let mut specimen = Specimen::new(rock(dilatancy));
            let bulk = YOUNG / (3.0 * (1.0 - 2.0 * POISSON));
            let hydrostatic = -confining / (3.0 * bulk);
            let start = specimen.strain(hydrostatic, -confining);
            assert!((start + confining).abs() < 1e-9 * YOUNG);
            let strength = (confining * (1.0 + sine) + 2.0 * COHESION * cosine) / (1.0 - sine);
            let first = specimen.strain(hydrostatic - 0.2, -confining);
            let before = (hydrostatic - 0.2, specimen.lateral);
            let second = specimen.strain(hydrostatic - 0.25, -confining);
            assert!((-first / strength - 1.0).abs() < 1e-9, "{first} {strength}");
            assert!(
                (-second / strength - 1.0).abs() < 1e-9,
                "{second} {strength}"
            );
            // At constant stress all further strain is plastic.
            let axial = hydrostatic - 0.25 - before.0;
            let volume = axial + 2.0 * (specimen.lateral - before.1);
            let expected = -2.0 * dilatancy.sin() / (1.0 - dilatancy.sin()) * axial;
            assert!((volume - expected).abs() < 1e-9, "{volume} {expected}");
        }
    }
}

/// Equal tension on all sides ends at the apex, p = c / tan phi, and stays there; so does any stretch
/// that is mostly dilation. Without cohesion there is no tension at all.
#[test]
fn tension_ends_at_the_apex() {
    for (cohesion, dilatancy) in [(COHESION, 0.6), (COHESION, 0.0), (0.0, 0.3)] {
        let law = DruckerPrager::new(YOUNG, POISSON, cohesion, FRICTION, dilatancy).unwrap();
        let law = AnyMaterial::from(law);
        let apex = cohesion / FRICTION.tan();
        let mut old = vec![0.0; law.history_len()];
        for stretch in [1.001, 1.01, 1.1] {
            let stretches = Vector3::new(stretch, stretch, 1.0 + 0.9 * (stretch - 1.0));
            let d = Deformation::at_rest(Matrix3::from_diagonal(&stretches));
            let (response, new) = respond(&law, &d, &old);
            let error = response.piola * d.gradient.transpose() - Matrix3::identity() * apex;
            assert!(error.norm() < 1e-9 * COHESION, "{error}");
            old = new;
        }
    }
}
