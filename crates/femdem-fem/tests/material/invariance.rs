//! Properties of any law: no stress from rotation, objectivity, smoothness at equal stretches, refusals.

use super::states::rand_free::Random;
use super::states::{self, YOUNG, respond};
use femdem_fem::material::{AnyMaterial, Deformation, Hencky, Material, NeoHookean, Tangent};
use femdem_mesh::{Matrix3, Vector3};

#[test]
fn rotations_give_no_stress() {
    let mut random = Random(3);
    for case in states::all() {
        let virgin = vec![0.0; case.law.history_len()];
        let mut largest = 0.0_f64;
        for _ in 0..50 {
            let turn = states::rotation(&mut random);
            let spin = Vector3::from_fn(|_, _| 100.0 * random.signed()).cross_matrix();
            let d = Deformation::at_rest(turn);
            let (response, new) = respond(&case.law, &d, &virgin);
            largest = largest.max(response.piola.norm() / YOUNG);
            assert_eq!(new, virgin);
            assert!(response.energy.abs() < 1e-15 * YOUNG && response.plastic_work == 0.0);
            let spinning = Deformation {
                gradient: turn,
                rate: spin * turn,
            };
            let with_spin = respond(&case.law, &spinning, &virgin).0;
            let viscous = (with_spin.piola - response.piola).norm();
            assert!(viscous <= 1e-12 * 100.0 * case.law.viscosity());
        }
        println!("{} {largest:.1e} E", case.law.name());
        assert!(largest < 1e-12);
    }
}

/// A superposed rotation Q(t) with dQ/dt = W Q rotates the stress and changes neither energy nor history.
#[test]
fn laws_are_objective() {
    let mut random = Random(4);
    let mut largest = 0.0_f64;
    for case in states::all() {
        for _ in 0..30 {
            let (old, d) = states::state(&mut random, &case);
            let turn = states::rotation(&mut random);
            let spin = Vector3::from_fn(|_, _| 100.0 * random.signed()).cross_matrix();
            let turned = Deformation {
                gradient: turn * d.gradient,
                rate: turn * d.rate + spin * turn * d.gradient,
            };
            let (still, history) = respond(&case.law, &d, &old);
            let (moved, moved_history) = respond(&case.law, &turned, &old);
            let scale = still.piola.norm() + YOUNG;
            largest = largest.max((turn * still.piola - moved.piola).norm() / scale);
            largest = largest.max((still.energy - moved.energy).abs() / YOUNG);
            largest = largest.max((still.plastic_work - moved.plastic_work).abs() / YOUNG);
            largest =
                largest.max((still.viscous_power - moved.viscous_power).abs() / scale / 100.0);
            for (a, b) in history.iter().zip(&moved_history) {
                largest = largest.max((a - b).abs());
            }
        }
    }
    println!("largest change {largest:.1e}");
    assert!(largest < 1e-12);
}

/// Isotropy: rotating the reference configuration rotates the arguments of P and nothing else.
#[test]
fn laws_are_isotropic() {
    let mut random = Random(5);
    let mut largest = 0.0_f64;
    for case in states::all() {
        let virgin = vec![0.0; case.law.history_len()];
        for _ in 0..30 {
            let d = Deformation::at_rest(states::gradient(&mut random, case.strain));
            let turn = states::rotation(&mut random);
            let turned = Deformation::at_rest(d.gradient * turn);
            let plain = respond(&case.law, &d, &virgin).0;
            let other = respond(&case.law, &turned, &virgin).0;
            let error = (plain.piola * turn - other.piola).norm();
            largest = largest.max(error / (plain.piola.norm() + YOUNG));
        }
    }
    println!("largest change {largest:.1e}");
    assert!(largest < 1e-12);
}

/// Stretches that differ by 1e-3 .. 1e-15 of their size: stress and tangent are as near to those of equal
/// stretches as the difference, and neither suffers from cancellation.
#[test]
fn nearly_equal_stretches_are_no_exception() {
    let mut random = Random(6);
    for case in states::all() {
        let virgin = vec![0.0; case.law.history_len()];
        let frame = states::rotation(&mut random);
        let turn = states::rotation(&mut random);
        for base in [1.0, 1.0 + 0.5 * case.strain, 1.0 - 0.5 * case.strain] {
            let at = |gap: f64, third: f64| {
                let stretches = Vector3::new(base, base * (1.0 + gap), base * third);
                let gradient =
                    turn * frame * Matrix3::from_diagonal(&stretches) * frame.transpose();
                let d = Deformation::at_rest(gradient);
                let piola = respond(&case.law, &d, &virgin).0.piola;
                (piola, case.law.tangent(&d, &virgin).unwrap())
            };
            // Two equal stretches, then three.
            for third in [1.0 + 0.4 * case.strain, 1.0] {
                let (piola, tangent): (Matrix3, Tangent) = at(0.0, third);
                for exponent in [3, 6, 8, 10, 12, 14, 15] {
                    let gap = 10.0_f64.powi(-exponent);
                    let (near_piola, near_tangent) = at(gap, third);
                    let allowed = (300.0 * gap + 1e-12) * tangent.norm();
                    let error = (near_piola - piola).norm();
                    assert!(error < allowed, "{} {gap:e} {error:e}", case.law.name());
                    let error = (near_tangent - tangent).norm();
                    assert!(error < allowed, "{} {gap:e} {error:e}", case.law.name());
                }
            }
        }
    }
}

#[test]
fn states_without_a_stress_are_refused() {
    let flat = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0));
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    let mut gradients = vec![flat, mirror, Matrix3::zeros(), Matrix3::identity() * 1e200];
    for bad in [f64::NAN, f64::INFINITY] {
        for entry in 0..9 {
            let mut gradient = Matrix3::identity();
            gradient[entry] = bad;
            gradients.push(gradient);
        }
    }
    for case in states::all() {
        let len = case.law.history_len();
        let virgin = vec![0.0; len];
        for &gradient in &gradients {
            let d = Deformation::at_rest(gradient);
            assert_eq!(
                case.law.respond(&d, &virgin, &mut vec![0.0; len]),
                None,
                "{gradient}"
            );
            assert_eq!(case.law.tangent(&d, &virgin), None, "{gradient}");
        }
        let fine = Deformation::at_rest(Matrix3::identity());
        if len > 0 {
            assert_eq!(
                case.law.respond(&fine, &virgin[1..], &mut vec![0.0; len]),
                None
            );
            assert_eq!(
                case.law.respond(&fine, &virgin, &mut vec![0.0; len + 1]),
                None
            );
            assert_eq!(case.law.tangent(&fine, &[]), None);
            let damaged = vec![f64::NAN; len];
            assert_eq!(case.law.respond(&fine, &damaged, &mut vec![0.0; len]), None);
            assert!(case.law.stiffness_bound(&fine, &damaged).is_nan());
        }
        let inverted = Deformation::at_rest(mirror);
        assert!(!case.law.stiffness_bound(&inverted, &virgin).is_finite());
    }
}

/// The energy of a small strain on top of a large rotation against Hooke's, whose error is of the
/// order of the strain: no cancellation at eps = 1e-6, where energies are 1e-12 E.
#[test]
fn small_strains_keep_their_energy() {
    let mut random = Random(10);
    let poisson = 0.3;
    let lambda = YOUNG * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let shear = YOUNG / (2.0 * (1.0 + poisson));
    let laws: [AnyMaterial; 2] = [
        NeoHookean::new(YOUNG, poisson).unwrap().into(),
        Hencky::new(YOUNG, poisson).unwrap().into(),
    ];
    let mut largest = 0.0_f64;
    for law in laws {
        for _ in 0..50 {
            let strain = Matrix3::from_fn(|_, _| 1e-6 * random.signed());
            let strain = (strain + strain.transpose()) * 0.5;
            let still = Matrix3::identity() + strain;
            let turned = states::rotation(&mut random) * still;
            let [energy, other] =
                [still, turned].map(|f| respond(&law, &Deformation::at_rest(f), &[]).0.energy);
            assert!(
                (other / energy - 1.0).abs() < 1e-8,
                "{}",
                other / energy - 1.0
            );
            largest = largest.max((other / energy - 1.0).abs());
            let hooke = 0.5 * lambda * strain.trace().powi(2) + shear * strain.norm_squared();
            assert!(
                (energy / hooke - 1.0).abs() < 2e-5,
                "{}",
                energy / hooke - 1.0
            );
        }
    }
    println!("largest change of the energy {largest:.1e}");
}
