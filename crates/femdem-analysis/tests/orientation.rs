//! Stereonets and order parameters of known directions and of random ones.

use crate::common::{Random, body, cube, solid};
use femdem_analysis::*;
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Pose, Rotation, Vector3};

fn uniform(random: &mut Random, count: usize) -> Vec<[f64; 3]> {
    (0..count)
        .map(|_| (random.rotation() * Vector3::z()).into())
        .collect()
}

/// Bodies of shape 0 on a lattice, turned as given.
fn turned(rotations: impl Iterator<Item = Rotation>) -> Vec<PosedBody> {
    rotations
        .zip(0_u32..)
        .map(|(rotation, i)| {
            let at = [i % 20, i / 20 % 20, i / 400].map(f64::from);
            body(
                0,
                Pose::from_parts(Translation3::new(at[0], at[1], at[2]), rotation),
            )
        })
        .collect()
}

/// Density of uniform directions is 1 within the noise that is stated, at every node.
#[test]
fn uniform_directions_are_flat() {
    let mut random = Random(77);
    for (count, least_circle) in [(200, 0.001), (20_000, 0.01)] {
        let options = StereonetOptions {
            least_circle,
            ..StereonetOptions::default()
        };
        let mut squares = Vec::new();
        for _ in 0..6 {
            let net = stereonet(&uniform(&mut random, count), &options).unwrap();
            let kamb = 9.0 / (count as f64 + 9.0);
            assert!((net.circle - kamb.max(least_circle)).abs() < 1e-15);
            for node in &net.nodes {
                let off = (node.density - 1.0) / net.noise;
                assert!(
                    (off - node.sigmas).abs() < 1e-9 && off.abs() < 6.0,
                    "{node:?}"
                );
                squares.push(off * off);
            }
        }
        let spread = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        // Nodes share directions: from 6 nets the spread is known to about 5 %.
        assert!(
            (spread - 1.0).abs() < 0.15,
            "{count}: {spread} of the stated noise"
        );
    }
}

/// The net's counts agree with counting one by one, also across the equator; up and down are the same.
#[test]
fn circles_hold_what_they_should() {
    let mut random = Random(5);
    let mut directions = uniform(&mut random, 500);
    let net = stereonet(
        &directions,
        &StereonetOptions {
            least_circle: 0.05,
            nodes_across: 15,
            ..StereonetOptions::default()
        },
    )
    .unwrap();
    for node in &net.nodes {
        let centre = Vector3::from(node.direction);
        assert!((centre.norm() - 1.0).abs() < 1e-12 && centre.z <= 1e-12);
        let near = directions
            .iter()
            .filter(|d| Vector3::from(**d).dot(&centre).abs().clamp(0.0, 1.0).acos() <= net.angle);
        assert_eq!(near.count(), node.count as usize, "{node:?}");
        let place = schmidt(node.direction);
        // On the rim both ends of an axis are on the net.
        let rim = centre.z.abs() < 1e-9;
        assert!(rim || (0..2).all(|k| (place[k] - node.place[k]).abs() < 1e-12));
    }
    for d in &mut directions {
        *d = d.map(|x| -7.0 * x);
    }
    let opposite = stereonet(
        &directions,
        &StereonetOptions {
            least_circle: 0.05,
            nodes_across: 15,
            ..StereonetOptions::default()
        },
    )
    .unwrap();
    assert_eq!(opposite.nodes, net.nodes);
}

/// Equal areas of the net hold equal numbers of uniform directions.
#[test]
fn the_projection_keeps_areas() {
    let mut random = Random(6);
    let places: Vec<[f64; 2]> = uniform(&mut random, 40_000)
        .into_iter()
        .map(schmidt)
        .collect();
    for (radius, share) in [(0.5, 0.25), (0.8, 0.64), (1.0, 1.0)] {
        let inside = places
            .iter()
            .filter(|[x, y]| x * x + y * y <= radius * radius + 1e-12)
            .count();
        assert!((inside as f64 / 40_000.0 - share).abs() < 0.01, "{radius}");
    }
}

/// Axes on a cone of opening angle b about a direction: nematic order P2(cos b) about it.
#[test]
fn order_of_a_cone() {
    let shapes = [cube(1.0)];
    for opening in [0.0_f64, 0.3, 0.7] {
        let tilt = Rotation::from_euler_angles(0.4, -0.8, 0.3);
        let turn = |i: i32| {
            let about =
                Rotation::from_axis_angle(&Vector3::z_axis(), f64::from(i) * 0.0157079632679);
            tilt * about * Rotation::from_axis_angle(&Vector3::x_axis(), opening)
        };
        let bodies = turned((0..400).map(turn));
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let axes = BodyAxes::Fixed(vec![[0.0, 0.0, 3.0]]);
        let order = orientation_order(&pack, &axes, None, &OrientationOptions::default()).unwrap();
        let expected = 1.5 * opening.cos().powi(2) - 0.5;
        assert!((order.nematic.value - expected).abs() < 1e-6, "{order:?}");
        let director = Vector3::from(order.nematic.director).dot(&(tilt * Vector3::z()));
        assert!(director.abs() > 1.0 - 1e-6);
        assert!((order.fabric.principal[0] - opening.cos().powi(2)).abs() < 1e-6);
    }
}

/// Bodies turned at random have the order of the baseline, within its own scatter.
#[test]
fn random_orientations_are_the_baseline() {
    let shapes = [solid("A10", 1.0)];
    let mut random = Random(12);
    let cases = [
        BodyAxes::Fixed(vec![[0.0, 0.0, 1.0]]),
        BodyAxes::Fixed(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        BodyAxes::FaceNormals { sides: Some(10) },
    ];
    for axes in cases {
        let mut offs = Vec::new();
        for _ in 0..12 {
            let bodies = turned((0..1200).map(|_| random.rotation()));
            let pack = Pack::new(&shapes, &bodies).unwrap();
            let order =
                orientation_order(&pack, &axes, None, &OrientationOptions::default()).unwrap();
            for found in [order.nematic, order.cubatic] {
                // By symmetry the axes of an icosahedron have no moments of degree 2 and 4 at all.
                if found.random_mean > 1e-9 {
                    offs.push((found.value - found.random_mean) / found.random_deviation);
                } else {
                    assert!(found.value < 1e-9);
                }
            }
        }
        if offs.is_empty() {
            continue;
        }
        let n = offs.len() as f64;
        let mean = offs.iter().sum::<f64>() / n;
        let spread = (offs.iter().map(|o| o * o).sum::<f64>() / n).sqrt();
        assert!(
            mean.abs() < 4.0 / n.sqrt() && (0.5..1.6).contains(&spread),
            "{axes:?}: {mean} {spread}"
        );
    }
}

/// The standard error of an order parameter is its scatter from pack to pack.
#[test]
fn errors_of_order() {
    let shapes = [cube(1.0)];
    let mut random = Random(31);
    let (mut values, mut errors) = (Vec::new(), Vec::new());
    for _ in 0..16 {
        // About half of the bodies stand upright.
        let rotations = (0..800).map(|_| {
            if random.uniform(0.0, 1.0) < 0.5 {
                Rotation::identity()
            } else {
                random.rotation()
            }
        });
        let bodies = turned(rotations);
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let axes = BodyAxes::Fixed(vec![[0.0, 0.0, 1.0]]);
        let found = orientation_order(&pack, &axes, None, &OrientationOptions::default())
            .unwrap()
            .nematic;
        values.push(found.value);
        errors.push(found.standard_error.unwrap());
    }
    let mean = values.iter().sum::<f64>() / 16.0;
    let scatter = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 15.0).sqrt();
    let stated = errors.iter().sum::<f64>() / 16.0;
    assert!((mean - 0.5).abs() < 0.02, "{mean}");
    assert!(
        (0.5..2.0).contains(&(stated / scatter)),
        "stated {stated}, scatter {scatter}"
    );
}

#[test]
fn axes_of_bodies() {
    // A square prism of height 1 and side 3: the short axis is upright.
    let shapes = [crate::common::prism(&[
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 2.5],
        [0.0, 2.5],
    ])];
    let bodies = turned([Rotation::identity()].into_iter());
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let only = |axes| {
        body_directions(&pack, &axes, None).unwrap()[0]
            .direction
            .map(f64::abs)
    };
    assert_eq!(only(BodyAxes::Short), [0.0, 0.0, 1.0]);
    assert_eq!(only(BodyAxes::Long), [1.0, 0.0, 0.0]);
    assert_eq!(
        body_directions(&pack, &BodyAxes::Principal, None)
            .unwrap()
            .len(),
        3
    );
    let faces = |sides| body_directions(&pack, &BodyAxes::FaceNormals { sides }, Some(&[0, 0]));
    assert_eq!(faces(None).unwrap().len(), 6);
    let refused = faces(Some(5)).unwrap_err();
    let words = "no body has a face of 5 sides; there are faces of 4 sides";
    assert_eq!(refused.to_string(), words);
    let fixed = |v| body_directions(&pack, &BodyAxes::Fixed(vec![v]), None);
    assert!(matches!(
        fixed([0.0; 3]),
        Err(AnalysisError::Direction { index: 0, .. })
    ));
    assert!(fixed([1e300, 0.0, -1e300]).is_ok() && fixed([f64::NAN, 0.0, 1.0]).is_err());
    assert!(matches!(
        body_directions(&pack, &BodyAxes::Long, Some(&[1])),
        Err(AnalysisError::BodyIndex { .. })
    ));
    assert_eq!(
        stereonet(&[], &StereonetOptions::default()),
        Err(AnalysisError::NoDirections)
    );
    // The circle would be the hemisphere.
    let wide = StereonetOptions {
        sigmas: 1e10,
        ..StereonetOptions::default()
    };
    assert!(stereonet(&[[0.3, 0.1, 0.2]], &wide).is_err());
}
