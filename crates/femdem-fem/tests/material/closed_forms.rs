//! Laws against closed forms: Hooke's law at rest, simple shear, uniaxial stretch, viscous flow.

use super::states::{YOUNG, respond};
use femdem_fem::material::{
    AnyMaterial, Deformation, DruckerPrager, DruckerPragerCap, Hencky, J2, Material, MooneyRivlin,
    NeoHookean, Tangent, Viscous,
};
use femdem_mesh::{Matrix3, Rotation, Vector3};

/// Kirchhoff stress of a virgin point.
fn kirchhoff(law: &AnyMaterial, gradient: Matrix3) -> Matrix3 {
    let virgin = vec![0.0; law.history_len()];
    let response = respond(law, &Deformation::at_rest(gradient), &virgin).0;
    response.piola * gradient.transpose()
}

fn near(value: f64, expected: f64) {
    let error = (value - expected).abs() / YOUNG;
    assert!(error < 1e-13, "{value} is not {expected}");
}

/// Every law starts as Hooke's: dP/dF G = lambda tr(G) I + mu (G + G^T).
#[test]
fn at_rest_every_law_is_hookes() {
    for poisson in [-0.2, 0.0, 0.3, 0.49] {
        let elastic = NeoHookean::new(YOUNG, poisson).unwrap();
        let laws: [AnyMaterial; 7] = [
            elastic.into(),
            Hencky::new(YOUNG, poisson).unwrap().into(),
            MooneyRivlin::new(YOUNG, poisson, 0.3).unwrap().into(),
            J2::new(YOUNG, poisson, 1.0, 0.0).unwrap().into(),
            DruckerPrager::new(YOUNG, poisson, 1.0, 0.5, 0.1)
                .unwrap()
                .into(),
            DruckerPragerCap::new(YOUNG, poisson, 1.0, 0.5, 0.6, vec![[0.0, 1.0], [1.0, 2.0]])
                .unwrap()
                .into(),
            Viscous::new(elastic, 1.0, 1.0).unwrap().into(),
        ];
        let lambda = YOUNG * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let shear = YOUNG / (2.0 * (1.0 + poisson));
        let same = |a: usize, b: usize| f64::from(u8::from(a == b));
        let hooke = Tangent::from_fn(|row, column| {
            let (i, j, k, l) = (row / 3, row % 3, column / 3, column % 3);
            lambda * same(i, j) * same(k, l)
                + shear * (same(i, k) * same(j, l) + same(i, l) * same(j, k))
        });
        let rest = Deformation::at_rest(Matrix3::identity());
        for law in laws {
            let virgin = vec![0.0; law.history_len()];
            let tangent = law.tangent(&rest, &virgin).unwrap();
            assert!(
                (tangent - hooke).norm() < 1e-13 * hooke.norm(),
                "{}",
                law.name()
            );
            near(law.wave_modulus(), lambda + 2.0 * shear);
        }
    }
}

/// Simple shear by gamma (no change of volume). Neo-Hookean: tau_xy = mu gamma, tau_xx = mu gamma^2.
/// Mooney-Rivlin: tau_xy the same, tau_xx - tau_zz = 2 c10 gamma^2, tau_zz - tau_yy = 2 c01 gamma^2
/// (Rivlin 1948). Hencky: principal strains +- asinh(gamma/2), so tau_xy = 4 mu asinh(gamma/2) /
/// sqrt(4 + gamma^2).
#[test]
fn simple_shear() {
    let poisson = 0.25;
    let mu = YOUNG / 2.5;
    for gamma in [1e-3, 0.1, 1.0, 3.0] {
        let shear = Matrix3::new(1.0, gamma, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let square = gamma * gamma;
        let tau = kirchhoff(&NeoHookean::new(YOUNG, poisson).unwrap().into(), shear);
        near(tau.m12, mu * gamma);
        near(tau.m11, mu * square);
        near(tau.m22, 0.0);
        let tau = kirchhoff(
            &MooneyRivlin::new(YOUNG, poisson, 0.25).unwrap().into(),
            shear,
        );
        near(tau.m12, mu * gamma);
        near(tau.m11 - tau.m33, 0.75 * mu * square);
        near(tau.m33 - tau.m22, 0.25 * mu * square);
        let tau = kirchhoff(&Hencky::new(YOUNG, poisson).unwrap().into(), shear);
        near(
            tau.m12,
            4.0 * mu * (0.5 * gamma).asinh() / (4.0 + square).sqrt(),
        );
        near(tau.m33, 0.0);
    }
}

/// Equal stretch s on all sides: neo-Hookean mu (s^2 - 1) + 3 lambda ln s, Hencky 3 K ln s,
/// Mooney-Rivlin K/2 (s^6 - 1); and the stretch of one axis at a Poisson's ratio of 0.
#[test]
fn stretches() {
    let (lambda, mu) = (YOUNG / 2.5, YOUNG / 2.5);
    let bulk = lambda + mu / 1.5;
    for s in [0.7_f64, 1.01, 1.6] {
        let swollen = Matrix3::identity() * s;
        let tau = kirchhoff(&NeoHookean::new(YOUNG, 0.25).unwrap().into(), swollen);
        near(tau.m11, mu * (s * s - 1.0) + 3.0 * lambda * s.ln());
        let tau = kirchhoff(&Hencky::new(YOUNG, 0.25).unwrap().into(), swollen);
        near(tau.m22, 3.0 * bulk * s.ln());
        let tau = kirchhoff(
            &MooneyRivlin::new(YOUNG, 0.25, 0.5).unwrap().into(),
            swollen,
        );
        near(tau.m33 / s.powi(3), 0.5 * bulk * (s.powi(3) - s.powi(-3)));
        let pulled = Matrix3::from_diagonal(&Vector3::new(s, 1.0, 1.0));
        let tau = kirchhoff(&NeoHookean::new(YOUNG, 0.0).unwrap().into(), pulled);
        near(tau.m11, 0.5 * YOUNG * (s * s - 1.0));
        let tau = kirchhoff(&Hencky::new(YOUNG, 0.0).unwrap().into(), pulled);
        near(tau.m11, YOUNG * s.ln());
        near(tau.m22, 0.0);
    }
}

/// Hundredfold stretch at a small change of volume: P = Q diag(mu (s - 1/s) + lambda ln J/s) R for the principal
/// stretches s.
#[test]
fn large_stretches_keep_their_change_of_volume() {
    let (lambda, mu) = (YOUNG / 2.5, YOUNG / 2.5);
    let law: AnyMaterial = NeoHookean::new(YOUNG, 0.25).unwrap().into();
    for s in [5.0_f64, 50.0, 500.0] {
        let stretches = Vector3::new(s, 1.0, 0.9 / s);
        let stress = stretches.map(|t| mu * (t - 1.0 / t) + lambda * 0.9_f64.ln() / t);
        for k in 0..20 {
            let turn = |a: f64| {
                let turn =
                    Rotation::from_euler_angles(a * f64::from(k), 1.0 + a, -a * f64::from(k));
                turn.to_rotation_matrix().into_inner()
            };
            let (q, r) = (turn(0.7), turn(1.9));
            let gradient = q * Matrix3::from_diagonal(&stretches) * r;
            let response = respond(&law, &Deformation::at_rest(gradient), &[]).0;
            let piola = q * Matrix3::from_diagonal(&stress) * r;
            // det F is the difference of numbers of the size of s squared.
            let error = (response.piola - piola).norm() / piola.norm();
            assert!(error < 1e-15 * s * s, "{s}: {error:e}");
        }
    }
}

/// Newtonian flow beside an elastic law: a shear rate g gives the true stress eta g and the power
/// eta g^2, a swelling at the rate e the mean stress 3 zeta e and 9 zeta e^2, in any strained state, per
/// current volume.
#[test]
fn viscous_flow_is_newtonian() {
    let elastic = AnyMaterial::from(NeoHookean::new(YOUNG, 0.3).unwrap());
    let (eta, zeta) = (2e4, 7e4);
    let law = AnyMaterial::from(Viscous::new(elastic.clone(), eta, zeta).unwrap());
    let strained = Matrix3::new(1.2, 0.3, 0.0, -0.1, 0.8, 0.2, 0.0, 0.1, 1.1);
    let volume = strained.determinant();
    let viscous = |velocity_gradient: Matrix3| {
        let rate = velocity_gradient * strained;
        let moving = Deformation {
            gradient: strained,
            rate,
        };
        let response = respond(&law, &moving, &[]).0;
        let still = respond(&elastic, &moving, &[]).0;
        assert_eq!(response.energy, still.energy);
        let piola = response.piola - still.piola;
        (
            piola * strained.transpose() / volume,
            response.viscous_power / volume,
        )
    };
    let mut shearing = Matrix3::zeros();
    shearing.m12 = 50.0;
    let (stress, power) = viscous(shearing);
    let mut expected = Matrix3::zeros();
    (expected.m12, expected.m21) = (eta * 50.0, eta * 50.0);
    assert!((stress - expected).norm() < 1e-6 * eta);
    assert!((power / (eta * 2500.0) - 1.0).abs() < 1e-12);
    let (stress, power) = viscous(Matrix3::identity() * 10.0);
    assert!((stress - Matrix3::identity() * (30.0 * zeta)).norm() < 1e-6 * zeta);
    assert!((power / (900.0 * zeta) - 1.0).abs() < 1e-12);
    // A stretch along one axis shows the longitudinal modulus zeta + 4/3 eta.
    let (stress, _) = viscous(Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 0.0)));
    assert!((stress.m11 / (zeta + eta / 0.75) - 1.0).abs() < 1e-9);
}
