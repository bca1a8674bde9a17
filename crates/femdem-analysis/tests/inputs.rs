//! Meaningless numbers from callers are refused by name, and nothing is written as -0.

use crate::common::forces::{between, body as weight_at};
use crate::common::{at, body, cube};
use femdem_analysis::*;
use femdem_mesh::nalgebra::{Quaternion, UnitQuaternion};
use femdem_mesh::{Point3, Pose, Vector3};

fn box_of(size: f64) -> Region {
    Region::Box {
        min: Point3::origin(),
        max: Point3::from([size; 3]),
    }
}

/// A pose whose quaternion has the length given.
fn of_length(length: f64) -> Pose {
    let turn = UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5);
    let mut pose = Pose::translation(2.0, 2.0, 2.0);
    pose.rotation = UnitQuaternion::new_unchecked(Quaternion::from(turn.coords * length));
    pose
}

#[test]
fn radial_distributions_need_a_region_and_bins_with_meaning() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::repeat(1.0), Vector3::repeat(2.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let endless = Region::Box {
        min: Point3::origin(),
        max: Point3::new(4.0, 4.0, f64::INFINITY),
    };
    let refused = radial_distribution(&pack, &endless, &RadialOptions::default()).unwrap_err();
    assert!(matches!(
        refused,
        AnalysisError::Region { name: "max.z", .. }
    ));
    let says = |width_over_d, reach_over_d| {
        let options = RadialOptions {
            width_over_d,
            reach_over_d,
            ..RadialOptions::default()
        };
        radial_distribution(&pack, &box_of(4.0), &options)
            .unwrap_err()
            .to_string()
    };
    assert!(says(0.05, f64::NAN).contains("reach_over_d = NaN"));
    assert!(says(0.05, -1.0).contains("reach_over_d = -1"));
    assert!(says(f64::INFINITY, 5.0).contains("width_over_d = inf"));
    // The error names the number at fault, not a valid one.
    let many = says(0.05, 5e6);
    assert!(
        many.contains("= 100000000 ") && many.contains("10000"),
        "{many}"
    );
    // Lengths whose powers overflow.
    assert!(says(1.0, 1e100).contains("reach_over_d"));
    assert!(says(1e-320, 1e-318).contains("width_over_d"));
}

#[test]
fn widths_without_end_are_refused() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::repeat(1.0), Vector3::repeat(2.5)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let region = box_of(4.0);
    let name = |found: AnalysisError| match found {
        AnalysisError::Option { name, value, .. } => {
            assert_eq!(value, f64::INFINITY);
            name
        }
        other => panic!("{other}"),
    };
    let cells = SetVoronoiOptions {
        leaf_over_d: f64::INFINITY,
        ..SetVoronoiOptions::default()
    };
    let found = set_voronoi(&pack, &region, &cells).unwrap_err();
    assert_eq!(name(found), "leaf_over_d");
    let map = DensityMapOptions {
        cell_over_d: f64::INFINITY,
        ..DensityMapOptions::default()
    };
    let found = density_map(&pack, &region, &map).unwrap_err();
    assert_eq!(name(found), "cell_over_d");
    let profile = ProfileOptions {
        width_over_d: f64::INFINITY,
        ..ProfileOptions::default()
    };
    let found = height_profile(&pack, &region, &profile).unwrap_err();
    assert_eq!(name(found), "width_over_d");
}

/// A quaternion that is a little too long or short is still a rotation, and turns without stretching.
#[test]
fn quaternions_are_made_of_unit_length() {
    let shapes = [cube(1.0)];
    let inside = |length| volume_inside(&shapes[0], &of_length(length), &box_of(4.0)).unwrap();
    let shared = |length| {
        let pose = of_length(length);
        intersection_volume(
            (&shapes[0], &pose),
            (&shapes[0], &Pose::translation(2.3, 2.0, 2.0)),
        )
        .unwrap()
    };
    let directions = |length| {
        let bodies = [body(0, of_length(length))];
        let pack = Pack::new(&shapes, &bodies).unwrap();
        body_directions(&pack, &BodyAxes::FaceNormals { sides: None }, None).unwrap()
    };
    let half = Region::Box {
        min: Point3::origin(),
        max: Point3::new(2.1, 4.0, 4.0),
    };
    let cut = |length| volume_inside(&shapes[0], &of_length(length), &half).unwrap();
    for length in [1.0 - 9e-7, 1.0 + 9e-7] {
        assert!((inside(length) - 1.0).abs() < 1e-13);
        assert!((cut(length) - cut(1.0)).abs() < 1e-13);
        assert!((shared(length) - shared(1.0)).abs() < 1e-13);
        for found in directions(length) {
            assert!((Vector3::from(found.direction).norm() - 1.0).abs() < 1e-13);
        }
    }
    for length in [0.0, 0.5, 1.0 + 2e-6, f64::NAN] {
        let bodies = [body(0, of_length(1.0)), body(0, of_length(length))];
        let refused = Pack::new(&shapes, &bodies).unwrap_err();
        assert!(matches!(refused, AnalysisError::Pose { body: 1, .. }));
        assert!(refused.to_string().contains("length"), "{refused}");
    }
}

/// A force below zero cannot hold bodies apart, so no threshold lies there.
#[test]
fn thresholds_below_zero_are_refused() {
    let bodies = [weight_at(0.0, 0.0, 0.0), weight_at(1.0, 0.0, 0.0)];
    for threshold in [-1.0, -1e-300, f64::NAN, f64::INFINITY] {
        let refused = ForceNetwork::new(&bodies, &[], threshold).unwrap_err();
        let counted = contact_counts(2, &[], threshold).unwrap_err();
        for error in [refused, counted] {
            assert!(
                matches!(error, AnalysisError::Option { name: "force_threshold", value, .. }
                    if value.to_bits() == threshold.to_bits()),
                "{error}"
            );
        }
    }
    assert!(ForceNetwork::new(&bodies, &[], 0.0).is_ok());
}

/// Patches of a pair that touches count, however weak each may be; those of a pair that does not touch do not.
#[test]
fn fabric_goes_by_touching_pairs() {
    let bodies = [
        weight_at(0.0, 0.0, 0.0),
        weight_at(1.0, 0.0, 0.0),
        weight_at(0.0, 1.0, 0.0),
    ];
    let mut contacts = vec![between(&bodies, 0, 1, 0.6), between(&bodies, 1, 0, 0.6)];
    // One patch pushes, one pulls: together they are below the threshold.
    contacts.extend([between(&bodies, 0, 2, 1.5), between(&bodies, 0, 2, -1.0)]);
    let network = ForceNetwork::new(&bodies, &contacts, 1.0).unwrap();
    let fabric = contact_fabric(&network);
    assert_eq!((fabric.normals.count, fabric.branches.count), (2, 1));
    assert_eq!(fabric.forces.count, 2);
    assert_eq!(fabric.normals.principal, [1.0, 0.0, 0.0]);
    assert_eq!(fabric.forces.principal, [1.0, 0.0, 0.0]);
    assert_eq!(fabric.mean_branch, 1.0);
}

/// A body that its patches grip from two sides touches, though their forces cancel.
#[test]
fn bodies_whose_forces_cancel_touch_all_the_same() {
    let bodies = [
        weight_at(0.0, 0.0, 0.0),
        weight_at(1.0, 0.0, 0.0),
        weight_at(2.0, 0.0, 0.0),
        weight_at(9.0, 0.0, 0.0),
    ];
    let grip = between(&bodies, 0, 1, 3.0);
    let mut other = grip;
    other.normal = -grip.normal;
    let contacts = [grip, other, between(&bodies, 1, 2, 2.0)];
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let found = force_maxima(&network, BlockBootstrap::default()).unwrap();
    assert_eq!(found.bodies, [0.0, 2.0, 2.0, 0.0]);
    assert_eq!((found.mean.count, found.mean.mean), (3, 4.0 / 3.0));
    assert_eq!((found.median, found.largest), (2.0, 2.0));
}

/// The Schmidt net depends on directions, not on lengths.
#[test]
fn the_net_is_the_same_for_vectors_of_any_length() {
    let axis = [0.3, -0.4, -0.6];
    let expected = schmidt(axis);
    for size in [1e-310, 1e-200, 1e-6, 1e6, 1e200, 1e308] {
        let found = schmidt(axis.map(|x| x * size));
        for (a, b) in found.into_iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{size}: {a} {b}");
        }
    }
    assert_eq!(schmidt([0.0; 3]), [0.0; 2]);
}

/// Sums over nothing are 0, not -0.
#[test]
fn nothing_is_written_as_minus_zero() {
    let shapes = [cube(1.0)];
    let bodies = at([Vector3::repeat(20.0)]);
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let plus = |x: f64| x == 0.0 && x.is_sign_positive();
    assert!(plus(pair_overlaps(&pack).total()));
    let exact = exact_density(&pack, &box_of(4.0)).unwrap();
    assert!(plus(exact.density) && plus(exact.body_volume));
    assert!(plus(exact.overlap_volume));
    let grid = grid_density(&pack, &box_of(4.0), 0.5).unwrap();
    assert!(plus(grid.density) && plus(grid.error), "{grid:?}");
    let cells = set_voronoi(&pack, &box_of(4.0), &SetVoronoiOptions::default()).unwrap();
    assert!(plus(cells.deviation), "{}", cells.deviation);
    let bodies = [weight_at(0.0, 0.0, 0.0)];
    let network = ForceNetwork::new(&bodies, &[], 0.0).unwrap();
    let stresses = body_stresses(&network);
    assert!(!stresses.to_csv().contains("-0.0"), "{}", stresses.to_csv());
    let profile = stress_profile(&network, &box_of(4.0), 2).unwrap();
    assert!(!profile.to_csv().contains("-0.0"), "{}", profile.to_csv());
    let balance = vertical_balance(&network, &[1.0]).unwrap();
    assert!(!balance.to_csv().contains("-0.0"), "{}", balance.to_csv());
}

/// A misspelt key is refused wherever it is.
#[test]
fn unknown_keys_are_refused() {
    let bad_region = r#"{"kind":"sphere","centre":[0,0,0],"radius":1,"radios":2}"#;
    assert!(serde_json::from_str::<Region>(bad_region).is_err());
    let bad_rule = r#"{"kind":"constraints","friction":true,"fricton":false}"#;
    assert!(serde_json::from_str::<SupportRule>(bad_rule).is_err());
    let bad_axes = r#"{"face_normals":{"sides":null,"side":10}}"#;
    assert!(serde_json::from_str::<BodyAxes>(bad_axes).is_err());
    let contact = between(
        &[weight_at(0.0, 0.0, 0.0), weight_at(1.0, 0.0, 0.0)],
        0,
        1,
        1.0,
    );
    let text = serde_json::to_string(&contact).unwrap();
    assert!(serde_json::from_str::<ForceContact>(&text).is_ok());
    let bad_contact = text.replace("\"class\"", "\"clas\"");
    assert!(serde_json::from_str::<ForceContact>(&bad_contact).is_err());
}

#[test]
fn what_is_wrong_with_a_body_or_contact_is_said_with_its_value() {
    let mut bodies = [weight_at(0.0, 0.0, 0.0), weight_at(1.0, 0.0, 0.0)];
    let good = between(&bodies, 0, 1, 1.0);
    let mut bad = good;
    bad.normal *= 1.5;
    let says = |bodies: &[ForceBody], contact| {
        ForceNetwork::new(bodies, &[contact], 0.0)
            .unwrap_err()
            .to_string()
    };
    assert!(says(&bodies, bad).contains("1.5"), "{}", says(&bodies, bad));
    let mut bad = good;
    bad.normal_force = f64::INFINITY;
    assert!(says(&bodies, bad).contains("inf"), "{}", says(&bodies, bad));
    // Its square would not be a number.
    bad.normal_force = 1e200;
    assert!(
        says(&bodies, bad).contains("1e100"),
        "{}",
        says(&bodies, bad)
    );
    bodies[1].volume = -2.5;
    assert!(says(&bodies, good).contains("-2.5"));
}
