//! Ratios and planes against exact values.

use super::*;
use femdem_fem::fracture::{FailurePlanes, FractureMode};
use proptest::prelude::*;

fn diagonal(x: f64, y: f64, z: f64) -> Matrix3 {
    Matrix3::from_diagonal(&Vector3::new(x, y, z))
}

/// The largest (|shear| - pressure tan phi) / c over planes, by trying many; with the best normal.
fn worst_plane(strength: &Strength, cauchy: &Matrix3) -> (f64, Vector3) {
    let friction = strength.friction_angle().tan();
    let mut worst = (f64::NEG_INFINITY, Vector3::x());
    let (rings, around) = (600, 1200);
    for i in 0..=rings {
        let polar = f64::from(i) / f64::from(rings) * std::f64::consts::FRAC_PI_2;
        for k in 0..around {
            let turn = f64::from(k) / f64::from(around) * std::f64::consts::TAU;
            let n = Vector3::new(
                polar.sin() * turn.cos(),
                polar.sin() * turn.sin(),
                polar.cos(),
            );
            let traction = cauchy * n;
            let normal = traction.dot(&n);
            let shear = (traction - n * normal).norm();
            let ratio = (shear + normal * friction) / strength.cohesion();
            if ratio > worst.0 {
                worst = (ratio, n);
            }
        }
    }
    worst
}

#[test]
fn uniaxial_strengths() {
    let rock = rock();
    assert!((rock.ratio(&diagonal(0.0, 0.0, TENSILE)) - 1.0).abs() < 1e-14);
    // 83.2 MPa for a cohesion of 20 MPa and tan phi = 0.8: 2 c (tan phi + sqrt(1 + tan^2 phi)).
    let exact = 40e6 * (0.8 + 1.64_f64.sqrt());
    assert!((rock.compressive() / exact - 1.0).abs() < 1e-14);
    assert!((rock.ratio(&diagonal(0.0, -exact, 0.0)) - 1.0).abs() < 1e-13);
    // Under the pressure p the strength rises by p (1 + sin phi)/(1 - sin phi), p (sqrt(1 + t^2) + t)^2 with t = tan phi.
    let (pressure, gain) = (30e6, (0.8 + 1.64_f64.sqrt()).powi(2));
    let top = exact + gain * pressure;
    assert!((rock.ratio(&diagonal(-pressure, -pressure, -top)) - 1.0).abs() < 1e-13);
    // Pure shear without friction.
    let tresca = Strength::new(1e9, 20e6, 0.0).unwrap();
    assert!((tresca.ratio(&diagonal(20e6, -20e6, 0.0)) - 1.0).abs() < 1e-14);
    assert!(rock.ratio(&diagonal(-1e9, -1e9, -1e9)) < 0.0);
    assert_eq!(rock.ratio(&Matrix3::zeros()), 0.0);
}

#[test]
fn shear_is_the_worst_of_all_planes() {
    let strength = Strength::new(1e6, 20e6, 0.6).unwrap();
    for i in 0..6 {
        let turn = rotation(i);
        let cauchy = turn * diagonal(-10e6, -25e6, -120e6) * turn.transpose();
        let (ratio, normal) = worst_plane(&strength, &cauchy);
        assert!((strength.ratio(&cauchy) / ratio - 1.0).abs() < 1e-4);
        let planes = strength.planes(&cauchy);
        assert_eq!(planes.mode(), FractureMode::Shear);
        let nearest = planes.normals().iter().map(|n| n.dot(&normal).abs());
        assert!(nearest.fold(0.0, f64::max) > 0.9999);
        // Both planes are equally bad, and steep: pi/4 + phi/2 above the section.
        for n in planes.normals() {
            assert!((n.norm() - 1.0).abs() < 1e-14);
            let traction = cauchy * n;
            let pull = traction.dot(n);
            let shear = (traction - n * pull).norm();
            assert!(((shear + pull * 0.6_f64.tan()) / 20e6 / ratio - 1.0).abs() < 1e-4);
            let axis = turn.column(2).dot(n).abs().acos();
            assert!((axis - std::f64::consts::FRAC_PI_4 - 0.3).abs() < 1e-9);
        }
    }
}

proptest! {
    #[test]
    fn turning_stress_turns_planes(i in any::<u64>(), a in -100e6..4e6_f64, b in -100e6..4e6_f64, c in 1e6..8e6_f64) {
        let (rock, turn, q) = (rock(), rotation(i), rotation(i ^ 77));
        let cauchy = q * diagonal(a, b, c) * q.transpose();
        let turned = turn * cauchy * turn.transpose();
        let ratio = rock.ratio(&cauchy);
        prop_assert!((rock.ratio(&turned) - ratio).abs() < 1e-12 * (1.0 + ratio.abs()));
        let (planes, after) = (rock.planes(&cauchy), rock.planes(&turned));
        // Equal principal stresses leave directions open.
        prop_assume!((a - b).abs() > 1e4 && (a - c).abs() > 1e4 && (b - c).abs() > 1e4);
        prop_assert_eq!(planes.mode(), after.mode());
        for n in planes.normals() {
            let found = after.normals().iter().map(|m| m.dot(&(turn * n)).abs());
            prop_assert!(found.fold(0.0, f64::max) > 1.0 - 1e-9);
        }
        // Tension is normal to the plane: no shear on it.
        if let FailurePlanes::Tension(n) = planes {
            prop_assert!((cauchy * n - n * n.dot(&(cauchy * n))).norm() < 1e-8 * cauchy.norm());
        }
    }

    /// On which the gate of the decision rests.
    #[test]
    fn the_ratio_of_a_mean_is_at_most_the_largest(i in any::<u64>(), share in 0.0..1.0_f64) {
        let rock = rock();
        let any = |k: u64| {
            let q = rotation(i ^ k);
            q * Matrix3::from_diagonal(&(noisy(i ^ (k + 9)) * 1e8)) * q.transpose()
        };
        let (first, second) = (any(1), any(2));
        let mean = rock.ratio(&(first * share + second * (1.0 - share)));
        prop_assert!(mean <= rock.ratio(&first).max(rock.ratio(&second)) + 1e-12);
    }
}

#[test]
fn files_are_checked() {
    let text = serde_json::to_string(&rock()).unwrap();
    assert_eq!(serde_json::from_str::<Strength>(&text).unwrap(), rock());
    let bad = text.replace("\"tensile\":", "\"tensile\":-");
    let error = serde_json::from_str::<Strength>(&bad)
        .unwrap_err()
        .to_string();
    assert!(error.contains("tensile strength"), "{error}");
}
