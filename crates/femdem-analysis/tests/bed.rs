//! Void fraction of whole beds.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::common::{at, comb, cube};
use femdem_analysis::{AnalysisError, Pack, Region, Vessel, measure_bed};
use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

/// Of the lines that find the top, over d: a quarter of a cube's side.
const SPACING: f64 = 0.144_337_567_297_406_43;

/// A square funnel with walls of 0.1 m thickness, horizontally: 1 m wide inside at z = 0, 3 m at z = 2 m.
fn funnel() -> Polyhedron {
    let ring = |half: f64, z: f64| {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[x, y]| Point3::new(half * x, half * y, z))
    };
    // Inner and outer border below, then above.
    let points: Vec<Point3> = [(0.5, 0.0), (0.6, 0.0), (1.5, 2.0), (1.6, 2.0)]
        .into_iter()
        .flat_map(|(half, z)| ring(half, z))
        .collect();
    let mut faces = Vec::new();
    for k in 0..4 {
        let n = (k + 1) % 4;
        let [inner, outer, high_inner, high_outer] =
            [0, 4, 8, 12].map(|first| [first + k, first + n]);
        faces.push(vec![outer[0], outer[1], high_outer[1], high_outer[0]]);
        faces.push(vec![inner[1], inner[0], high_inner[0], high_inner[1]]);
        faces.push(vec![inner[0], inner[1], outer[1], outer[0]]);
        faces.push(vec![
            high_inner[1],
            high_inner[0],
            high_outer[0],
            high_outer[1],
        ]);
    }
    Polyhedron::new(points, faces).unwrap()
}

#[test]
fn bodies_that_the_top_cuts_count_with_their_parts_below_it() {
    // Unit cubes: two columns of one, one of two. The mean top is at 4/3.
    let shapes = [cube(1.0)];
    let places = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
    let bodies = at(places.map(|[x, z]| Vector3::new(x + 0.5, 0.5, z + 0.5)));
    let pack = Pack::new(&shapes, &bodies).unwrap();
    let container = Region::Box {
        min: Point3::origin(),
        max: Point3::new(3.0, 1.0, 5.0),
    };
    let bed = measure_bed(&pack, &Vessel::Upright(container), SPACING).unwrap();
    assert!((bed.top - 4.0 / 3.0).abs() < 1e-12, "{bed:?}");
    // Three cubes and a third of one in 4 m3.
    assert!((bed.bodies - 10.0 / 3.0).abs() < 1e-12);
    assert!((bed.solid - 10.0 / 3.0).abs() < 1e-12 && (bed.volume - 4.0).abs() < 1e-12);
    assert!((bed.void_fraction - 1.0 / 6.0).abs() < 1e-12);
    assert!((bed.bodies_per_volume - 10.0 / 12.0).abs() < 1e-12);
    assert!((bed.area_per_volume - 5.0).abs() < 1e-12);
    // A lower lid bounds the bed.
    let lid = container.slab(0.0, 1.0).unwrap();
    let bed = measure_bed(&pack, &Vessel::Upright(lid), SPACING).unwrap();
    assert!(bed.top == 1.0 && bed.void_fraction.abs() < 1e-12, "{bed:?}");
}

/// A cone of 45° from its tip to a radius of 2 m, and a cylinder above.
#[test]
fn a_cone_is_a_part_of_the_bed() {
    let silo = Vessel::Silo {
        centre: [5.0, 7.0],
        radius: 2.0,
        outlet_radius: 0.0,
        floor: -1.0,
        waist: 1.0,
    };
    let shapes = [cube(0.5)];
    let void_up_to = |top: f64| {
        let bodies = at([Vector3::new(5.0, 7.0, top - 0.25)]);
        let bed = measure_bed(&Pack::new(&shapes, &bodies).unwrap(), &silo, SPACING).unwrap();
        assert!((bed.top - top).abs() < 1e-12 && bed.floor == -1.0);
        bed.void_fraction
    };
    let pi = std::f64::consts::PI;
    assert!((void_up_to(0.0) - (1.0 - 0.125 / (pi / 3.0))).abs() < 1e-12);
    assert!((void_up_to(2.5) - (1.0 - 0.125 / (pi * 8.0 / 3.0 + 6.0 * pi))).abs() < 1e-12);
    let wrong = Vessel::Silo {
        centre: [5.0, 7.0],
        radius: 2.0,
        outlet_radius: 2.5,
        floor: -1.0,
        waist: 1.0,
    };
    let bodies = at([Vector3::new(5.0, 7.0, 0.0)]);
    let refused = measure_bed(&Pack::new(&shapes, &bodies).unwrap(), &wrong, SPACING);
    assert!(
        refused
            .unwrap_err()
            .to_string()
            .contains("outlet_radius = 2.5")
    );
}

#[test]
fn the_hollow_of_a_solid_is_measured_exactly() {
    let shapes = [cube(0.5)];
    let measure = |surface: &Polyhedron, place: Vector3| {
        let bodies = at([place]);
        let vessel = Vessel::Solid {
            surface: Box::new(surface.clone()),
            floor: 0.0,
        };
        measure_bed(&Pack::new(&shapes, &bodies).unwrap(), &vessel, SPACING)
    };
    // Up to z = 1 the funnel is 1 m to 2 m wide: a frustum of (1 + 2 + 4)/3 m3.
    let bed = measure(&funnel(), Vector3::new(0.1, -0.2, 0.75)).unwrap();
    assert!((bed.volume - 7.0 / 3.0).abs() < 1e-12, "{bed:?}");
    assert!((bed.void_fraction - (1.0 - 0.125 * 3.0 / 7.0)).abs() < 1e-12);
    // The same at an angle to the axes.
    let turned = Pose::rotation(Vector3::z() * 0.3);
    let bed = measure(
        &funnel().transformed(&turned).unwrap(),
        Vector3::new(0.1, -0.2, 0.75),
    );
    assert!((bed.unwrap().volume - 7.0 / 3.0).abs() < 1e-12);
    // Above the rim, outside, and in a solid that is open at a side nothing is known.
    let heaped = measure(&funnel(), Vector3::new(0.0, 0.0, 2.0));
    assert!(
        matches!(heaped, Err(AnalysisError::AboveRim { rim: 2.0, .. })),
        "{heaped:?}"
    );
    let outside = measure(&funnel(), Vector3::new(2.5, 0.0, 1.0));
    assert!(
        matches!(outside, Err(AnalysisError::NotEnclosed { body: 0 })),
        "{outside:?}"
    );
    let (open, _) = comb();
    let between = measure(&open, Vector3::new(1.5, 1.5, 0.5));
    assert!(
        matches!(between, Err(AnalysisError::NotEnclosed { body: 0 })),
        "{between:?}"
    );
}
