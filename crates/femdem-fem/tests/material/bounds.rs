//! The bounds from which the time step is computed.

use super::states::rand_free::Random;
use super::states::{self, YOUNG};
use femdem_fem::material::{Deformation, Material, Tangent};
use femdem_mesh::{Matrix3, Vector3};

/// A_ik = dP_iJ/dF_kL N_J N_L, its symmetric part.
fn acoustic(tangent: &Tangent, n: &Vector3) -> Matrix3 {
    let a = Matrix3::from_fn(|i, k| {
        let entry = |j: usize, l: usize| tangent[(3 * i + j, 3 * k + l)] * n[j] * n[l];
        (0..9).map(|jl| entry(jl / 3, jl % 3)).sum()
    });
    (a + a.transpose()) * 0.5
}

/// The largest eigenvalue over all directions: random ones, then a climb from the best.
fn largest_acoustic(tangent: &Tangent, random: &mut Random) -> f64 {
    let value = |n: &Vector3| acoustic(tangent, n).symmetric_eigenvalues().max();
    let mut best = (f64::NEG_INFINITY, Vector3::x());
    for trial in 0..250 {
        let shift = Vector3::from_fn(|_, _| random.signed());
        let reach = if trial < 100 {
            100.0
        } else {
            0.9_f64.powi(trial - 100)
        };
        let n = (best.1 + shift * reach).normalize();
        let at = value(&n);
        if at > best.0 {
            best = (at, n);
        }
    }
    best.0
}

/// The bound holds for the acoustic tensor, is not much above it, and holds in the wider sense of the
/// trait's documentation: G : C : G <= c |G|^2 in the nuclear norm, the smallest product
/// sqrt(sum |u|^2) sqrt(sum |B|^2) over all G = sum u (x) B.
#[test]
fn the_bound_is_above_the_acoustic_tensor() {
    let mut random = Random(8);
    for case in states::all() {
        let (mut least, mut most, mut mean) = (f64::INFINITY, 0.0_f64, 0.0);
        const STATES: usize = 30;
        for _ in 0..STATES {
            let (old, d) = states::state(&mut random, &case);
            let d = Deformation::at_rest(d.gradient);
            let tangent = case.law.tangent(&d, &old).unwrap();
            let bound = case.law.stiffness_bound(&d, &old);
            let ratio = bound / largest_acoustic(&tangent, &mut random).max(0.05 * YOUNG);
            least = least.min(ratio);
            most = most.max(ratio);
            mean += ratio / STATES as f64;
            for rank in [1, 2, 3, 2, 3] {
                let g = (0..rank).fold(Matrix3::zeros(), |g, _| {
                    let mut vector = || Vector3::from_fn(|_, _| random.signed());
                    g + vector() * vector().transpose()
                });
                let g = g / g.singular_values().sum();
                let flat = femdem_mesh::nalgebra::SVector::<f64, 9>::from_fn(|row, _| {
                    g[(row / 3, row % 3)]
                });
                assert!((tangent * flat).dot(&flat) <= bound * (1.0 + 1e-12));
            }
        }
        println!(
            "{}: bound/largest from {least:.4} to {most:.2}, mean {mean:.2}",
            case.law.name()
        );
        assert!(least >= 1.0 - 1e-12);
    }
}

/// At rest the bound is the wave modulus (for Poisson's ratios that are not negative), which is the
/// largest acoustic eigenvalue of the tangent.
#[test]
fn at_rest_the_bound_is_the_wave_modulus() {
    let rest = Deformation::at_rest(Matrix3::identity());
    for case in states::all() {
        let virgin = vec![0.0; case.law.history_len()];
        let modulus = case.law.wave_modulus();
        let tangent = case.law.tangent(&rest, &virgin).unwrap();
        let acoustic = acoustic(&tangent, &Vector3::z());
        assert!((acoustic[(2, 2)] - modulus).abs() < 1e-12 * modulus);
        let bound = case.law.stiffness_bound(&rest, &virgin);
        assert!(bound >= modulus * (1.0 - 1e-14));
        let auxetic = acoustic[(2, 2)] < 2.0 * acoustic[(0, 0)];
        assert!(
            auxetic || bound < modulus * (1.0 + 1e-12),
            "{}",
            case.law.name()
        );
    }
}

/// The largest dP/d(dF/dt) over rank-one rates, from the stress itself, against the stated bound.
#[test]
fn the_viscosity_bound_is_the_largest_viscous_modulus() {
    let mut random = Random(9);
    for case in states::viscous() {
        for _ in 0..20 {
            let (old, d) = states::state(&mut random, &case);
            let mut rate_tangent = Tangent::zeros();
            let mut scratch = old.clone();
            let rest = Deformation::at_rest(d.gradient);
            let still = case.law.respond(&rest, &old, &mut scratch).unwrap();
            for column in 0..9 {
                let mut moving = rest;
                moving.rate[(column / 3, column % 3)] = 1e4;
                let piola = case.law.respond(&moving, &old, &mut scratch).unwrap().piola;
                let slope = (piola - still.piola) / 1e4;
                for row in 0..9 {
                    rate_tangent[(row, column)] = slope[(row / 3, row % 3)];
                }
            }
            let ratio = case.law.viscosity_bound(&d) / largest_acoustic(&rate_tangent, &mut random);
            assert!(ratio > 1.0 - 1e-9 && ratio < 1.02, "{ratio}");
        }
        let rest = Deformation::at_rest(Matrix3::identity());
        let change = case.law.viscosity_bound(&rest) - case.law.viscosity();
        assert!(change.abs() < 1e-9 * case.law.viscosity());
    }
}
