//! Bad models, bad arrays, bad states.

use super::*;
use femdem_fem::FemError;
use femdem_fem::element::ElementFailure;
use femdem_fem::{Boundary, DeformableBody, DeformableState};
use std::sync::Arc;

fn region(density: f64) -> MaterialRegion {
    MaterialRegion {
        material: neo_hookean(1e6, 0.3),
        density,
    }
}

#[test]
fn models_that_mean_nothing_are_refused_by_name() {
    let mesh = crooked();
    let count = mesh.tets().len();
    let make = |regions: Vec<MaterialRegion>, of: Option<Vec<u32>>| {
        DeformableModel::new(&mesh, Element::T4, regions, of)
            .unwrap_err()
            .to_string()
    };
    for density in [0.0, -1.0, f64::NAN] {
        assert!(make(vec![region(density)], None).contains("density"));
    }
    let large = TetMesh::block([1; 3], &Vector3::repeat(1e3)).unwrap();
    let heavy = DeformableModel::new(&large, Element::T4, vec![region(1e300)], None).err();
    assert!(heavy.unwrap().to_string().contains("mass of the body"));
    assert!(make(vec![], None).contains("number of regions"));
    assert!(make(vec![region(1.0); 2], None).contains("number of regions"));
    assert!(make(vec![region(1.0)], Some(vec![0; count - 1])).contains("region_of_tet"));
    assert!(make(vec![region(1.0)], Some(vec![1; count])).contains("region 1"));
    let unbound = AnyMaterial::Custom(femdem_fem::material::CustomMaterial::named("mine"));
    let unbound = MaterialRegion {
        material: unbound,
        density: 1.0,
    };
    assert!(make(vec![unbound], None).contains("mine"));
}

/// Velocities of a state that are not finite are refused.
#[test]
fn velocities_that_are_not_finite_are_refused() {
    let model = Arc::new(model(&crooked(), Element::T4, neo_hookean(1e6, 0.3)));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut state = DeformableState::reference(&model);
        state.v[3].y = bad;
        let body = DeformableBody::with_state(model.clone(), Boundary::default(), state, 0.0);
        assert!(body.unwrap_err().to_string().contains("velocity"));
    }
}

/// Every element that is inverted is named, with its volume ratio; no NaN is returned.
#[test]
fn inverted_elements_are_named() {
    for element in ELEMENTS {
        let model = model(&crooked(), element, neo_hookean(1e6, 0.3));
        let fails = |change: &dyn Fn(&mut Vec<Vector3>)| {
            let mut x = model.nodes().to_vec();
            change(&mut x);
            let (v, mut f) = (
                vec![Vector3::zeros(); x.len()],
                vec![Vector3::zeros(); x.len()],
            );
            let failure = model
                .internal_forces(&x, &v, &[], &mut [], &mut f, &mut Workspace::default())
                .unwrap_err();
            assert_eq!(
                model.stresses(&x, &[]).unwrap_err().element(),
                failure.element()
            );
            assert!(model.stable_frequency2(&x, &[]).is_err());
            assert!(model.tangent_apply(&x, &[], &v, &mut f).is_err());
            failure
        };
        let mirrored = fails(&|x| x.iter_mut().for_each(|x| x.z = -x.z));
        assert!(mirrored.volume_ratio().unwrap() < 0.0);
        assert_eq!(mirrored.element(), Some(0));
        assert!(mirrored.to_string().contains("element 0"));
        let lost = fails(&|x| x[3].y = f64::NAN);
        assert!(lost.volume_ratio().unwrap().is_nan());
        let far = fails(&|x| x[3].y = f64::INFINITY);
        assert!(matches!(far, ElementFailure::Inverted { .. }));
    }
}

#[test]
fn arrays_of_another_length_are_refused() {
    for element in ELEMENTS {
        let model = model(&crooked(), element, neo_hookean(1e6, 0.3));
        let n = model.nodes().len();
        let ok = vec![Vector3::zeros(); n];
        let short = vec![Vector3::zeros(); n - 1];
        let mut work = Workspace::default();
        let mut f = ok.clone();
        let x = model.nodes();
        let results = [
            model.internal_forces(&short, &ok, &[], &mut [], &mut f, &mut work),
            model.internal_forces(x, &short, &[], &mut [], &mut f, &mut work),
            model.internal_forces(x, &ok, &[0.0], &mut [], &mut f, &mut work),
            model.internal_forces(x, &ok, &[], &mut [0.0], &mut f, &mut work),
            model.internal_forces(x, &ok, &[], &mut [], &mut f[1..], &mut work),
        ];
        for result in results {
            assert!(
                matches!(result, Err(ElementFailure::Length { .. })),
                "{result:?}"
            );
        }
        let wrong = model.tangent_apply(x, &[], &short, &mut f);
        assert!(matches!(
            wrong,
            Err(ElementFailure::Length { what: "dx", .. })
        ));
    }
}

#[test]
fn failures_become_errors_of_the_crate() {
    let failure = ElementFailure::Inverted {
        element: 7,
        volume_ratio: -0.5,
    };
    let error = FemError::from(failure);
    assert!(error.to_string().contains("element 7"));
}

/// Lists of another length than the nodes.
#[test]
fn bounds_and_energies_of_too_few_nodes_are_refused() {
    let mesh = TetMesh::block([2, 1, 1], &Vector3::new(2.0, 1.0, 1.0)).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e6, 0.3).unwrap().into(),
        density: 1000.0,
    };
    let model = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let (x, weights) = (model.nodes(), model.frequency_weights());
    let mut out = Vec::new();
    assert!(model.apply_stiffness_bound(weights, &mut out).is_ok());
    assert!(out.iter().all(|bound| *bound > 0.0));
    assert!(
        model
            .apply_stiffness_bound(&weights[1..], &mut out)
            .is_err()
    );
    let state = InternalState {
        energy: f64::NAN,
        ..InternalState::default()
    };
    assert!(model.with_energy(state, x).energy.abs() < 1e-9);
    assert!(model.with_energy(state, &x[1..]).energy.is_nan());
}
