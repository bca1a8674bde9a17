//! Meaningless numbers in a job are refused by name, before anything is computed.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_pack::{
    Container, PackError, PackShape, PackSpec, Packing, Penalty, Pour, Protocol, Release,
};

fn cubes(count: u32) -> PackSpec {
    let cube = CatalogueShape::from(Solid::P5).polyhedron(0.02).unwrap();
    PackSpec {
        shapes: vec![PackShape::new("cube", cube)],
        count,
        ..PackSpec::default()
    }
}

/// The refusal of a changed job.
fn says(change: impl FnOnce(&mut PackSpec)) -> String {
    let mut spec = cubes(4);
    change(&mut spec);
    let text = spec.validate().unwrap_err().to_string();
    assert_eq!(Packing::new(spec).unwrap_err().to_string(), text);
    text
}

/// Limits that are never reached would let a job go on for ever, or never pass.
#[test]
fn limits_of_settling_are_positive_numbers() {
    for limit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let residual = says(|s| s.settling.residual = limit);
        assert!(residual.contains(&format!("settling residual = {limit}")));
        let energy = says(|s| s.settling.kinetic_energy = limit);
        assert!(energy.contains(&format!("settling kinetic_energy = {limit}")));
        let longest = says(|s| s.settling.longest = limit);
        assert!(longest.contains(&format!("settling longest = {limit}")));
    }
}

/// The limit of the step is checked as given, not as falling bodies bound it.
#[test]
fn the_largest_step_is_a_positive_number() {
    for largest in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let text = says(|s| s.time_step.largest = Some(largest));
        let value = format!("time_step.largest = {largest}");
        assert!(text.contains(&value), "{text}");
    }
}

/// Shares whose sum leaves the range of numbers, or whose parts vanish.
#[test]
fn shares_have_a_sum() {
    for share in [1e308, 1e-320, f64::NAN, -1.0] {
        let text = says(|s| {
            s.shapes[0].share = share;
            s.shapes.push(s.shapes[0].clone());
        });
        assert!(text.contains("share of a shape"), "{text}");
    }
    let mut spec = cubes(4);
    spec.shapes.push(spec.shapes[0].clone());
    for share in [1e-100, 1e100] {
        spec.shapes.iter_mut().for_each(|s| s.share = share);
        spec.validate().unwrap();
        assert!((spec.diameter() - 0.02).abs() < 1e-15);
    }
}

/// A container as wide as its bodies holds them, though rounding makes it one ulp too narrow.
#[test]
fn bodies_that_fit_exactly_fit() {
    let mut spec = cubes(2);
    let width = spec.largest_diameter() * (1.0 - 1e-12);
    for container in [
        Container::Box {
            width,
            depth: width,
        },
        Container::Cylinder { diameter: width },
    ] {
        for protocol in [
            Protocol::default(),
            Protocol::Pour(Pour::default()),
            Protocol::Release(Release::default()),
        ] {
            spec.container = container.clone();
            spec.protocol = protocol;
            Packing::new(spec.clone()).unwrap();
        }
    }
    let width = 0.02 * (1.0 - 1e-8);
    spec.container = Container::Cylinder { diameter: width };
    assert!(matches!(
        spec.validate(),
        Err(PackError::ContainerTooNarrow { .. })
    ));
}

/// In a round container a layer consists of the sites within the circle; if there are none, the specified rows
/// are refused.
#[test]
fn layers_asked_for_fit_round_containers() {
    let release = |nx, ny| {
        Protocol::Release(Release {
            per_layer: Some([nx, ny]),
            ..Release::default()
        })
    };
    // Two rows of two fit along the axes, and no body within the circle.
    let mut spec = cubes(4);
    spec.container = Container::Cylinder { diameter: 0.042 };
    spec.protocol = release(2, 2);
    let refused = Packing::new(spec.clone()).unwrap_err().to_string();
    assert!(refused.contains("2 by 2"), "{refused}");
    spec.protocol = release(2, 1);
    Packing::new(spec.clone()).unwrap();
    spec.protocol = release(3, 1);
    let refused = Packing::new(spec).unwrap_err().to_string();
    assert!(refused.contains("at most 2"), "{refused}");
}

/// A floor for more bodies than there are does not exhaust the memory.
#[test]
fn layers_over_huge_floors_are_refused() {
    for width in [1e6, 1e12, 1e100] {
        let mut spec = cubes(4);
        spec.container = Container::Box {
            width,
            depth: width,
        };
        spec.penalty = Penalty::Given { pressure: 1e6 };
        spec.protocol = Protocol::Release(Release::default());
        let refused = Packing::new(spec.clone()).unwrap_err().to_string();
        assert!(refused.contains("per_layer"), "{refused}");
        spec.protocol = Protocol::Release(Release {
            per_layer: Some([2, 2]),
            ..Release::default()
        });
        assert!(Packing::new(spec).is_ok(), "{width}");
    }
}

#[test]
fn unknown_keys_are_refused() {
    for text in [
        r#"{"automatic":{"penetration":0.0035,"penetraton":1}}"#,
        r#"{"given":{"pressure":1e6,"presure":1}}"#,
    ] {
        assert!(serde_json::from_str::<Penalty>(text).is_err(), "{text}");
    }
    let text = r#"{"cylinder":{"diameter":0.2,"hieght":1}}"#;
    assert!(serde_json::from_str::<Container>(text).is_err());
    let text = r#"{"cylinder":{"diameter":0.2}}"#;
    assert!(serde_json::from_str::<Container>(text).is_ok());
}

/// A report of no contacts has no -0.
#[test]
fn an_empty_report_has_no_minus_zero() {
    let packing = Packing::new(cubes(2)).unwrap();
    let report = packing.report().unwrap();
    let plus = |x: f64| x == 0.0 && x.is_sign_positive();
    assert!(plus(report.penetration_mean_over_d));
    assert!(plus(report.penetration_max_over_d));
}
