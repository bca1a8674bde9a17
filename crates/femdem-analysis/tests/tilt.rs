//! Tilt of bodies and its histogram.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{Random, body, solid};
use femdem_analysis::*;
use femdem_mesh::shapes::Shape;
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

fn shape(text: &str) -> Polyhedron {
    text.parse::<Shape>().unwrap().polyhedron(1.0).unwrap()
}

#[test]
fn rods_go_by_their_length_discs_by_their_axis_and_cubes_have_no_tilt() {
    // A rod along x, a disc about z, a cube.
    let shapes = [
        shape("box:width=0.1,height=0.1"),
        shape("box:width=1,height=0.1"),
        solid("P5", 1.0),
    ];
    let turned = |shape, angle: f64| body(shape, Pose::rotation(Vector3::y() * angle.to_radians()));
    let bodies = [
        turned(0, 0.0),
        turned(0, 90.0),
        turned(0, 120.0),
        turned(1, 0.0),
        turned(1, -25.0),
        turned(1, 155.0),
        turned(2, 10.0),
    ];
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let expected = [
        Some(90.0),
        Some(0.0),
        Some(30.0),
        Some(0.0),
        Some(25.0),
        Some(25.0),
        None,
    ];
    for (found, expected) in tilts(&pack).into_iter().zip(expected) {
        let apart = found.zip(expected).map_or(0.0, |(a, b)| f64::abs(a - b));
        assert!(
            found.is_some() == expected.is_some() && apart < 1e-9,
            "{found:?} for {expected:?}"
        );
    }
}

/// Rods of random direction fill the bins as sin θ tells; those upright at the walls are told apart from those
/// that lie in the core.
#[test]
fn groups_are_compared_with_random_directions() {
    let shapes = [shape("box:width=0.1,height=0.1")];
    let mut random = Random(4);
    let bodies: Vec<PosedBody> = (0..4000)
        .map(|_| {
            let place = random.point(&Point3::new(-4.0, -4.0, 0.0), &Point3::new(4.0, 4.0, 8.0));
            body(0, Pose::from_parts(place.coords.into(), random.rotation()))
        })
        .collect();
    let container = Region::Box {
        min: Point3::new(-4.0, -4.0, 0.0),
        max: Point3::new(4.0, 4.0, 8.0),
    };
    let core = container.inset(2.0).unwrap();
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let found = tilt_histogram(
        &pack,
        Some(&Vessel::Upright(container)),
        Some(&core),
        &TiltOptions::default(),
    )
    .unwrap();
    assert!((found.random.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    for (count, share) in found.all.counts.iter().zip(&found.random) {
        let expected = 4000.0 * share;
        assert!(
            (f64::from(*count) - expected).abs() < 4.0 * expected.sqrt(),
            "{count} for {expected}"
        );
    }
    assert!((found.all.mean.unwrap() - 57.2958).abs() < 1.5);
    assert!(found.all.vertical_order.unwrap().abs() < 0.05);
    // The shell of d within the side walls, and the slab of d on the floor.
    let d = pack.mean_diameter().unwrap();
    let within = |p: &Point3| p.x.abs().max(p.y.abs());
    let near = pack
        .centroids()
        .iter()
        .filter(|p| within(p) >= 4.0 - d)
        .count();
    assert_eq!(found.side_walls.as_ref().unwrap().bodies as usize, near);
    let low = pack.centroids().iter().filter(|p| p.z <= d).count();
    assert_eq!(found.floor.as_ref().unwrap().bodies as usize, low);
    assert_eq!(
        found.core.as_ref().unwrap().bodies as usize,
        pack.bodies_in(&core).unwrap().len()
    );
    let text = found.to_csv();
    assert_eq!(text.lines().count(), 10);
    // In the cone of a silo no wall is upright, and it is no floor.
    let silo = Vessel::Silo {
        centre: [0.0; 2],
        radius: 4.0,
        outlet_radius: 0.5,
        floor: 0.0,
        waist: 3.0,
    };
    let found = tilt_histogram(&pack, Some(&silo), None, &TiltOptions::default()).unwrap();
    let is_near = |p: &&Point3| p.z >= 3.0 && p.coords.xy().norm() >= 4.0 - d;
    let near = pack.centroids().iter().filter(is_near).count();
    assert_eq!(found.side_walls.unwrap().bodies as usize, near);
    assert!(found.floor.is_none() && near > 0);
    // Without a vessel only all bodies are known.
    let all = tilt_histogram(&pack, None, None, &TiltOptions::default()).unwrap();
    assert!(
        all.side_walls.is_none()
            && all.core.is_none()
            && all.to_csv().lines().nth(1).unwrap().ends_with(",,,,,,")
    );
    for (bins, near_over_d, words) in [(0, 1.0, "bins = 0"), (9, 0.0, "near_over_d = 0")] {
        let refused = tilt_histogram(&pack, None, None, &TiltOptions { bins, near_over_d });
        assert!(refused.unwrap_err().to_string().contains(words));
    }
}
