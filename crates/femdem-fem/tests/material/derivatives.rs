//! Stress and tangent against central differences.

use super::states::rand_free::Random;
use super::states::{self, Case, YOUNG, respond};
use femdem_fem::material::{AnyMaterial, Deformation, Material, Tangent};
use femdem_mesh::Matrix3;

/// Central differences of fourth order of `value` along F_kL.
fn slope(d: &Deformation, k: usize, l: usize, value: impl Fn(&Deformation) -> f64) -> f64 {
    let h = 1e-5;
    let at = |shift: f64| {
        let mut shifted = *d;
        shifted.gradient[(k, l)] += shift;
        value(&shifted)
    };
    (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h)
}

/// Error of the stress against the slope of W = energy + plastic work of the step.
fn stress_error(case: &Case, random: &mut Random) -> f64 {
    let (old, d) = states::state(random, case);
    let d = Deformation::at_rest(d.gradient);
    let potential = |d: &Deformation| {
        let response = respond(&case.law, d, &old).0;
        response.energy + response.plastic_work
    };
    let piola = respond(&case.law, &d, &old).0.piola;
    let differences = Matrix3::from_fn(|k, l| slope(&d, k, l, potential));
    (piola - differences).norm() / (piola.norm() + 1e-3 * YOUNG)
}

fn tangent_error(case: &Case, random: &mut Random) -> f64 {
    let (old, d) = states::state(random, case);
    let tangent = case.law.tangent(&d, &old).unwrap();
    let differences = Tangent::from_fn(|row, column| {
        slope(&d, column / 3, column % 3, |d| {
            respond(&case.law, d, &old).0.piola[(row / 3, row % 3)]
        })
    });
    (tangent - differences).norm() / tangent.norm().max(1e-3 * YOUNG)
}

/// The largest error over random states. A step of the differences across the yield surface or the border of
/// the apex would show as an error; with these seeds there is none.
fn largest(error: impl Fn(&Case, &mut Random) -> f64, cases: &[Case]) -> f64 {
    let mut largest = 0.0_f64;
    for case in cases {
        let mut random = Random(7);
        for _ in 0..60 {
            largest = largest.max(error(case, &mut random));
        }
    }
    println!("largest error {largest:.1e}");
    largest
}

#[test]
fn elastic_stress_is_the_slope_of_the_energy() {
    assert!(largest(stress_error, &states::elastic()) < 1e-6);
}

#[test]
fn elastic_and_viscous_tangents_are_slopes_of_the_stress() {
    let mut cases = states::elastic();
    cases.push(states::viscous().remove(0));
    assert!(largest(tangent_error, &cases) < 1e-6);
}

/// For associated flow the stress at the end of a step is the slope of stored energy plus dissipated
/// work (Ortiz and Stainier, Comput. Methods Appl. Mech. Engrg. 171, 419 (1999)): elastic steps, the
/// radial return, the cone's and the apex'.
#[test]
fn plastic_stress_is_the_slope_of_the_incremental_energy() {
    assert!(largest(stress_error, &states::plastic()[..4]) < 1e-6);
}

#[test]
fn algorithmic_tangents_are_slopes_of_the_stress() {
    let mut cases = states::plastic();
    cases.push(states::viscous().remove(1));
    assert!(largest(tangent_error, &cases) < 1e-6);
}

/// The random states of the tests above reach every branch: elastic steps, flow, the apex, and the cap.
#[test]
fn every_branch_is_reached() {
    for case in states::plastic() {
        let mut random = Random(7);
        let mut branches = [0; 4];
        let cap = matches!(case.law, AnyMaterial::DruckerPragerCap(_));
        for _ in 0..60 {
            let (old, d) = states::state(&mut random, &case);
            let (response, new) = respond(&case.law, &d, &old);
            let kirchhoff = response.piola * d.gradient.transpose();
            let mean = kirchhoff.trace() / 3.0;
            let shear = (kirchhoff - Matrix3::identity() * mean).norm();
            let branch = match (new == old, shear < 1e-9 * YOUNG) {
                (true, _) => 0,
                (false, _) if cap && new[6] > old[6] => 3,
                (false, false) => 1,
                (false, true) => 2,
            };
            branches[branch] += 1;
        }
        let cone = cap || matches!(case.law, AnyMaterial::DruckerPrager(_));
        println!("{} {branches:?}", case.law.name());
        assert!(branches[0] > 1 && branches[1] > 1);
        assert!((branches[2] > 2) == cone && (branches[3] > 2) == cap);
    }
}
