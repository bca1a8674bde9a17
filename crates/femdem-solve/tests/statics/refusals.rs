//! What cannot be solved is said by name.

use crate::loads::hold;
use crate::{solvers, with};
use femdem_mesh::{TetMesh, Vector3};
use femdem_solve::SolveError;
use femdem_solve::deformable::{DeformableModel, MaterialRegion};
use femdem_solve::element::Element;
use femdem_solve::material::NeoHookean;
use femdem_solve::statics::{Loading, Method, RelaxOptions, StaticOptions, solve_static};

fn cube() -> DeformableModel {
    let mesh = TetMesh::block([2, 2, 2], &Vector3::new(1.0, 1.0, 1.0)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e6, 0.3).unwrap().into(),
        density: 1000.0,
    };
    DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap()
}

#[test]
fn a_body_that_nothing_holds_is_told_from_one_at_rest() {
    let model = cube();
    let mut loading = Loading::free(&model);
    loading.forces[0].z = -1.0;
    for linear in solvers() {
        let error = solve_static(&model, &loading, &with(linear, 1e-6)).unwrap_err();
        assert!(matches!(error, SolveError::NotConverged { .. }), "{error}");
    }
}

#[test]
fn a_body_under_no_load_stays() {
    let model = cube();
    for linear in solvers() {
        let solution = solve_static(&model, &Loading::free(&model), &with(linear, 1e-6)).unwrap();
        assert_eq!(solution.positions, model.nodes());
    }
}

#[test]
fn crushing_a_body_to_nothing_stops_with_an_error() {
    let model = cube();
    let mut loading = Loading::free(&model);
    for axis in 0..3 {
        hold(&mut loading, &model, axis, |x| x.x == 0.0 || x.x == 1.0);
    }
    for (motion, x) in loading.motion.iter_mut().zip(model.nodes()) {
        motion.x = if x.x == 1.0 { -1.5 } else { 0.0 };
    }
    let mut all: Vec<StaticOptions> = solvers().into_iter().map(|l| with(l, 1e-6)).collect();
    all.push(StaticOptions {
        method: Method::Relax(RelaxOptions {
            max_steps: 2000,
            ..RelaxOptions::default()
        }),
        ..StaticOptions::default()
    });
    for options in all {
        let error = solve_static(&model, &loading, &options).unwrap_err();
        let is_named = matches!(
            error,
            SolveError::NotConverged { .. } | SolveError::Element(_)
        );
        assert!(is_named, "{error}");
    }
}

#[test]
fn loads_of_another_body_and_bad_numbers_are_refused() {
    let model = cube();
    let options = StaticOptions::default();
    let mut short = Loading::free(&model);
    short.forces.pop();
    let error = solve_static(&model, &short, &options).unwrap_err();
    assert!(matches!(error, SolveError::WrongLength { .. }), "{error}");

    let mut bad = Loading::free(&model);
    bad.forces[3].y = f64::NAN;
    let error = solve_static(&model, &bad, &options).unwrap_err();
    assert!(error.to_string().contains("force of a node"), "{error}");

    let none = StaticOptions {
        steps: 0,
        ..options
    };
    assert!(solve_static(&model, &Loading::free(&model), &none).is_err());
}
