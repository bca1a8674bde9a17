//! Problems that cannot be solved are refused by name.

use super::planes::plane;
use super::{solvers, with};
use femdem_fem::element::Element;
use femdem_fem::material::{AnyMaterial, Hencky, J2, MooneyRivlin, NeoHookean};
use femdem_fem::statics::{LoadPath, StaticOptions, solve_static, solve_static_from};
use femdem_fem::{Boundary, Curve, DeformableModel, DeformableState, MaterialRegion, Selection};
use femdem_fem::{Drive, FemError};
use femdem_mesh::{Rotation, TetMesh, Vector3};

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
    let mut boundary = Boundary::default();
    boundary
        .pull(&model, &plane(2, 1.0), Vector3::z(), 1.0)
        .unwrap();
    for linear in solvers() {
        let error = solve_static(&model, &boundary, &with(linear, 1e-6)).unwrap_err();
        assert!(matches!(error, FemError::NotConverged { .. }), "{error}");
    }
}

/// A body without load is at rest at once: held, rotated and of any law, with loads that only begin later.
#[test]
fn what_bears_nothing_yet_is_at_rest() {
    let turn = Rotation::from_euler_angles(0.3, -0.7, 1.1);
    let mesh = TetMesh::block([2, 2, 2], &Vector3::repeat(0.1)).unwrap();
    let points = mesh.points().iter().map(|p| turn * p).collect();
    let turned = TetMesh::new(points, mesh.tets().to_vec()).unwrap();
    let laws: [AnyMaterial; 4] = [
        NeoHookean::new(1e6, 0.3).unwrap().into(),
        Hencky::new(1e6, 0.3).unwrap().into(),
        MooneyRivlin::new(1e6, 0.3, 0.4).unwrap().into(),
        J2::new(1e6, 0.3, 1e4, 1e5).unwrap().into(),
    ];
    for (mesh, element) in [
        (&mesh, Element::T4),
        (&turned, Element::T4),
        (&turned, Element::T10),
    ] {
        for material in &laws {
            let region = MaterialRegion {
                material: material.clone(),
                density: 1000.0,
            };
            let model = DeformableModel::new(mesh, element, vec![region], None).unwrap();
            let mut boundary = Boundary::default();
            let ends = Selection::Nodes(vec![0, 1, 2]);
            boundary.fix(&model, &ends, [true; 3]).unwrap();
            let later = Curve::Table(vec![[0.0, 0.0], [0.5, 0.0], [1.0, 100.0]]);
            boundary.press(&model, &Selection::Skin, later).unwrap();
            let options = StaticOptions {
                path: LoadPath::InTime,
                steps: 4,
                ..StaticOptions::default()
            };
            let solution = solve_static(&model, &boundary, &options).unwrap();
            let moved = solution.state.x.iter().zip(model.nodes());
            let most = moved
                .map(|(x, start)| (x - start).norm())
                .fold(0.0, f64::max);
            assert!(most > 1e-7, "{element:?} {material:?} {most}");
            let unloaded = solve_static(&model, &Boundary::default(), &StaticOptions::default());
            assert_eq!(unloaded.unwrap().state.x, model.nodes());
        }
    }
}

#[test]
fn a_body_under_no_load_stays() {
    let model = cube();
    for linear in solvers() {
        let solution = solve_static(&model, &Boundary::default(), &with(linear, 1e-6)).unwrap();
        assert_eq!(solution.state.x, model.nodes());
    }
}

#[test]
fn crushing_a_body_to_nothing_stops_with_an_error() {
    let model = cube();
    let mut boundary = Boundary::default();
    boundary.fix(&model, &plane(0, 0.0), [true; 3]).unwrap();
    let drive = Drive::Linear {
        velocity: Vector3::new(-1.5, 0.0, 0.0),
        start: 0.0,
        end: 1.0,
    };
    boundary
        .drive(&model, &plane(0, 1.0), [true; 3], drive)
        .unwrap();
    for linear in solvers() {
        let error = solve_static(&model, &boundary, &with(linear, 1e-6)).unwrap_err();
        let is_named = matches!(error, FemError::NotConverged { .. } | FemError::Element(_));
        assert!(is_named, "{error}");
    }
}

#[test]
fn boundaries_and_states_of_another_body_and_bad_options_are_refused() {
    let (model, usual) = (cube(), StaticOptions::default());
    let mesh = TetMesh::block([3, 3, 3], &Vector3::new(1.0, 1.0, 1.0)).unwrap();
    let larger = DeformableModel::new(&mesh, Element::T4, model.regions().to_vec(), None).unwrap();
    let mut boundary = Boundary::default();
    boundary.fix(&larger, &plane(2, 1.0), [true; 3]).unwrap();
    let error = solve_static(&model, &boundary, &usual).unwrap_err();
    assert!(matches!(error, FemError::NoSuch { .. }), "{error}");

    let start = DeformableState::reference(&larger);
    let error = solve_static_from(&model, &Boundary::default(), &start, &usual).unwrap_err();
    assert!(matches!(error, FemError::Element(_)), "{error}");

    for bad in [
        StaticOptions {
            steps: 0,
            ..usual.clone()
        },
        StaticOptions {
            time: f64::NAN,
            ..usual.clone()
        },
    ] {
        let error = solve_static(&model, &Boundary::default(), &bad).unwrap_err();
        assert!(matches!(error, FemError::Parameter { .. }), "{error}");
    }
}
