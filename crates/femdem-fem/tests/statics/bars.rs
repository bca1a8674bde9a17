//! Bars in tension and compression.

use super::planes::plane;
use super::{newton, solvers, with};
use femdem_fem::Drive;
use femdem_fem::element::Element;
use femdem_fem::material::{AnyMaterial, DruckerPrager, J2, NeoHookean};
use femdem_fem::statics::{
    LoadPath, StaticOptions, StaticSolution, solve_static, solve_static_from,
};
use femdem_fem::{Boundary, Curve, DeformableModel, MaterialRegion};
use femdem_mesh::{TetMesh, Vector3};

const LENGTH: f64 = 4.0;

fn bar(element: Element, material: AnyMaterial) -> DeformableModel {
    let mesh = TetMesh::block([4, 2, 2], &Vector3::new(LENGTH, 1.0, 1.0)).unwrap();
    let region = MaterialRegion {
        material,
        density: 1000.0,
    };
    DeformableModel::new(&mesh, element, vec![region], None).unwrap()
}

/// Symmetry about the planes through the origin.
fn symmetric(model: &DeformableModel) -> Boundary {
    let mut boundary = Boundary::default();
    for axis in 0..3 {
        let components = [0, 1, 2].map(|k| k == axis);
        boundary.fix(model, &plane(axis, 0.0), components).unwrap();
    }
    boundary
}

/// A motion that is complete at 1 s.
fn shift(by: Vector3) -> Drive {
    Drive::Linear {
        velocity: by,
        start: 0.0,
        end: 1.0,
    }
}

/// Pulls the end at x = 4 while planes of symmetry keep the state uniform.
fn pull(model: &DeformableModel, by: f64, options: &StaticOptions) -> StaticSolution {
    let mut boundary = symmetric(model);
    let drive = shift(Vector3::new(by, 0.0, 0.0));
    boundary
        .drive(model, &plane(0, LENGTH), [true, false, false], drive)
        .unwrap();
    solve_static(model, &boundary, options).unwrap()
}

/// Force on the end at x = 4.
fn force(model: &DeformableModel, solution: &StaticSolution) -> f64 {
    let nodes = model.nodes().iter().zip(&solution.reactions);
    nodes.filter(|(x, _)| x.x == LENGTH).map(|(_, f)| f.x).sum()
}

/// Nominal stress of tau = mu (b - 1) + lambda ln J in uniaxial tension by a stretch, with the lateral
/// stretch found by bisection.
fn neo_hookean_tension(young: f64, poisson: f64, stretch: f64) -> f64 {
    let mu = young / (2.0 * (1.0 + poisson));
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let tau = |s: f64, side: f64| mu * (s * s - 1.0) + lambda * (stretch * side * side).ln();
    let (mut low, mut high) = (1e-3, 2.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if tau(middle, middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    tau(stretch, low) / stretch
}

/// Linear elements need one step. Quadratic ones need several: in one, they fold between their points and
/// reach another equilibrium.
#[test]
fn rubber_pulled_to_three_times_its_length() {
    for (element, steps) in [(Element::T4, 1), (Element::T10, 8), (Element::T10Fbar, 8)] {
        let model = bar(element, NeoHookean::new(1e6, 0.4).unwrap().into());
        let options = StaticOptions {
            steps,
            ..newton(1e-10)
        };
        let solution = pull(&model, 2.0 * LENGTH, &options);
        let ratio = force(&model, &solution) / neo_hookean_tension(1e6, 0.4, 3.0);
        assert!((ratio - 1.0).abs() < 1e-8, "{element:?} {ratio}");
    }
}

#[test]
fn newton_takes_four_iterations_to_round_off() {
    let model = bar(Element::T10, NeoHookean::new(1e6, 0.3).unwrap().into());
    for linear in solvers() {
        // Clamped ends, so that the state is not uniform.
        let mut boundary = Boundary::default();
        boundary.fix(&model, &plane(0, 0.0), [true; 3]).unwrap();
        let drive = shift(Vector3::new(0.0, 0.0, 0.2));
        boundary
            .drive(&model, &plane(0, LENGTH), [true; 3], drive)
            .unwrap();
        let solution = solve_static(&model, &boundary, &with(linear, 1e-13)).unwrap();
        let (_, report) = &solution.report.steps[0];
        assert!(report.residual() < 1e-12, "{report:?}");
        assert!(
            report.iterations <= 4 || report.linear_iterations > 100,
            "{report:?}"
        );
        // Quadratic convergence: each residual is about the square of the one before, up to a factor.
        for pair in report
            .residuals
            .windows(2)
            .filter(|w| w[0] > 1e-6 && w[1] > 1e-12)
        {
            assert!(pair[1] < 50.0 * pair[0] * pair[0], "{linear:?} {report:?}");
        }
    }
}

/// tau = s0 + H alpha, ln(stretch) = tau/E + alpha, nominal stress tau / stretch.
#[test]
fn a_bar_of_metal_hardens_along_its_curve() {
    let (young, yield_stress, hardening) = (200e9, 400e6, 2e9);
    let steel = J2::new(young, 0.3, yield_stress, hardening).unwrap();
    for element in [Element::T4, Element::T10Fbar] {
        let model = bar(element, steel.into());
        let options = StaticOptions {
            steps: 10,
            ..newton(1e-8)
        };
        let solution = pull(&model, 0.05 * LENGTH, &options);
        let alpha = (1.05_f64.ln() - yield_stress / young) / (1.0 + hardening / young);
        let exact = (yield_stress + hardening * alpha) / 1.05;
        let ratio = force(&model, &solution) / exact;
        assert!((ratio - 1.0).abs() < 1e-7, "{element:?} {ratio}");
        assert!(
            solution
                .state
                .history
                .iter()
                .any(|h| (h - alpha).abs() < 1e-9)
        );
    }
}

/// Uniaxial strength of Mohr and Coulomb, 2 c cos(phi) / (1 - sin(phi)), which this cone matches, as a
/// Kirchhoff stress. The flow is not associated, so the tangent is not symmetric, of which the solvers use one triangle.
#[test]
fn a_bar_of_rock_is_crushed_at_its_strength() {
    let (cohesion, friction): (f64, f64) = (1e6, 0.5);
    let rock = DruckerPrager::new(1e9, 0.2, cohesion, friction, 0.1).unwrap();
    let model = bar(Element::T4, rock.into());
    let strength = 2.0 * cohesion * friction.cos() / (1.0 - friction.sin());
    let options = StaticOptions {
        steps: 4,
        ..newton(1e-6)
    };
    let solution = pull(&model, -0.02 * LENGTH, &options);
    let ratio = -force(&model, &solution) / (strength / 0.98);
    assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
}

/// A metal bar that a traction stretches plastically springs back once it is unloaded: its length is that of
/// the plastic strain, and no load remains as a scale of the residual.
#[test]
fn a_drawn_bar_springs_back_when_it_is_let_go() {
    let (young, yield_stress, hardening) = (200e9, 400e6, 2e9);
    let steel = J2::new(young, 0.3, yield_stress, hardening).unwrap();
    let model = bar(Element::T4, steel.into());
    let loaded = |table: Vec<[f64; 2]>| {
        let mut boundary = symmetric(&model);
        let traction = Vector3::new(450e6, 0.0, 0.0);
        let end = plane(0, LENGTH);
        boundary
            .pull(&model, &end, traction, Curve::Table(table))
            .unwrap();
        boundary
    };
    let options = StaticOptions {
        steps: 8,
        path: LoadPath::InTime,
        ..newton(1e-9)
    };
    let whole = loaded(vec![[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]]);
    let whole = solve_static(&model, &whole, &options).unwrap();
    // The same in two calls: the second starts with nothing holding the bar at its length.
    let up = loaded(vec![[0.0, 0.0], [1.0, 1.0]]);
    let up = solve_static(&model, &up, &options).unwrap();
    let release = solve_static_from(&model, &symmetric(&model), &up.state, &newton(1e-9));
    // All points have the same strain.
    let strains = model.plastic_strains(&whole.state.history).unwrap();
    let alpha = strains.unwrap()[0];
    assert!(alpha > 0.02, "{alpha}");
    for solution in [whole, release.unwrap()] {
        let longest = solution.state.x.iter().map(|x| x.x).fold(0.0, f64::max);
        assert!((longest / (LENGTH * alpha.exp()) - 1.0).abs() < 1e-9);
        let left = solution.reactions.iter().map(|f| f.norm()).sum::<f64>();
        // Compared with 450 MN.
        assert!(left < 10.0, "{left}");
        assert!(solution.report.residual() < 1e-9);
    }
}

/// A column of 10 x 1 x 1 compressed by 3 %, nearly four times the strain at which it buckles: the
/// straight state is an equilibrium too, but not a stable one, and the tangent is indefinite on the way.
#[cfg(feature = "implicit")]
#[test]
fn a_slender_column_buckles_sideways() {
    let (length, young) = (10.0, 1e6);
    let mesh = TetMesh::block([10, 1, 1], &Vector3::new(length, 1.0, 1.0)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(young, 0.3).unwrap().into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, Element::T10, vec![region], None).unwrap();
    let mut boundary = Boundary::default();
    boundary.fix(&model, &plane(0, 0.0), [true; 3]).unwrap();
    let drive = shift(Vector3::new(-0.03 * length, 0.0, 0.0));
    boundary
        .drive(&model, &plane(0, length), [true, false, false], drive)
        .unwrap();
    boundary
        .pull(&model, &plane(0, length), Vector3::z(), 0.01)
        .unwrap();
    let options = StaticOptions {
        steps: 4,
        ..newton(1e-7)
    };
    let solution = solve_static(&model, &boundary, &options).unwrap();
    let moves = solution.state.x.iter().zip(model.nodes());
    let sway = moves.map(|(x, r)| x.z - r.z).fold(0.0, f64::max);
    assert!(sway > 0.1 * length, "{sway}");
    // Euler, one end clamped and the other guided: pi^2 E I / L^2. Straight, 3 % take 30 kN.
    let euler = std::f64::consts::PI.powi(2) * young / 12.0 / length.powi(2);
    let ends = model.nodes().iter().zip(&solution.reactions);
    let ends = ends.filter(|(x, _)| x.x == length);
    let axial = -ends.map(|(_, f)| f.x).sum::<f64>();
    assert!((axial / euler - 1.0).abs() < 0.1, "{axial} {euler}");
}
