//! No slivers, and the symmetry of the shape.

use super::{assert_near, body, smallest_altitude};
use femdem_mesh::shapes::{BOULDER_SMALLEST_ALTITUDE, Boulder, Shape};
use femdem_mesh::{Matrix3, Point3, Polyhedron};
use std::f64::consts::PI;

#[test]
fn boulders_keep_the_floor_for_many_seeds() {
    for seed in 0..1500 {
        let step = |k: u64| (seed / k % 5) as f64 / 4.0;
        let boulder = Boulder {
            seed,
            angularity: step(1),
            elongation: 0.4 + 0.6 * step(5),
            flatness: 0.4 + 0.6 * step(25),
        };
        let (elongation, flatness) = (boulder.elongation, boulder.flatness);
        let body = Shape::from(boulder).polyhedron(1.0).unwrap();
        assert!(
            body.is_convex() && body.vertices().len() >= 8,
            "seed {seed}"
        );
        let altitude = smallest_altitude(&body);
        assert!(
            altitude >= BOULDER_SMALLEST_ALTITUDE * (1.0 - 1e-9),
            "seed {seed}: {altitude}"
        );
        assert_near("volume", body.mass_properties().volume, PI / 6.0, 1e-12);
        let extent = |axis: usize| {
            let along = |v: &Point3| v[axis];
            body.vertices().iter().map(along).fold(f64::MIN, f64::max)
                - body.vertices().iter().map(along).fold(f64::MAX, f64::min)
        };
        assert_near("elongation", extent(1) / extent(0), elongation, 1e-12);
        assert_near("flatness", extent(2) / extent(1), flatness, 1e-12);
    }
}

#[test]
fn angular_boulders_are_sharper_and_seeds_differ() {
    // Sphericity: area of the sphere of the same volume over the area.
    let sphericity = |angularity: f64| -> f64 {
        (0..40)
            .map(|seed| {
                let text =
                    format!("boulder:seed={seed},angularity={angularity},elongation=1,flatness=1");
                PI / body(&text, 1.0).area() / 40.0
            })
            .sum()
    };
    let values = [0.0, 0.5, 1.0].map(sphericity);
    assert!(
        values[0] > values[1] + 0.01 && values[1] > values[2] + 0.01,
        "{values:?}"
    );
    assert_eq!(body("boulder:seed=3", 1.0), body("boulder:seed=3", 1.0));
    assert_ne!(body("boulder:seed=3", 1.0), body("boulder:seed=4", 1.0));
}

#[test]
fn defaults_have_no_slivers() {
    // Smallest altitude in sizes. The caps of cylinder and tetrapod are single polygons.
    for (text, floor) in [
        ("sphere", 0.05),
        ("ellipsoid", 0.03),
        ("superquadric", 0.04),
        ("superquadric:n1=20,n2=20,cells=16", 0.04),
        ("superquadric:n1=20,n2=2", 0.008),
        ("superquadric:n1=3,n2=13", 0.04),
        ("superquadric:n1=12,n2=12", 0.04),
        ("rounded_cube", 0.028),
        ("hollow_cylinder", 0.045),
        ("pellet", 0.035),
        ("lobed", 0.01),
        ("antifer", 0.03),
        ("dolos", 0.03),
        ("tetrapod", 0.02),
        ("clump", 0.01),
    ] {
        let altitude = smallest_altitude(&body(text, 1.0));
        assert!(altitude >= floor, "{text}: {altitude}");
    }
}

#[test]
fn clumps_have_no_slivers() {
    // A tenth of the lattice cell, which is the smallest radius over 2.5.
    for (spheres, cell) in [
        ("0 0 0 0.5", 0.2),
        ("-0.45 0 0 0.5/0.45 0 0 0.5", 0.2),
        ("-0.3 0 0 0.25/0.2 0 0 0.5", 0.1),
        (
            "0 0 0 0.3/0.4 0.05 0 0.3/0.2 0.35 0.1 0.3/0.2 0.1 0.4 0.25",
            0.1,
        ),
        (
            "0 0 0 0.3/0.3 0.3 0.3 0.3/-0.3 -0.3 0.3 0.3/0.3 -0.3 -0.3 0.3/-0.3 0.3 -0.3 0.3",
            0.12,
        ),
    ] {
        let body = body(&format!("clump:spheres={spheres}"), 1.0);
        let altitude = smallest_altitude(&body);
        assert!(altitude >= 0.099 * cell, "{spheres}: {altitude}");
        assert_eq!(body.euler_characteristic(), 2, "{spheres}");
    }
}

/// Whether a linear map takes the set of vertices to itself.
fn is_symmetric(body: &Polyhedron, map: &Matrix3) -> bool {
    body.vertices().iter().all(|v| {
        let image = map * v;
        body.vertices().iter().any(|w| (w - image).amax() < 1e-14)
    })
}

#[test]
fn shapes_are_as_symmetric_as_they_should_be() {
    let mirror = |axis: usize| {
        let mut map = Matrix3::identity();
        map[(axis, axis)] = -1.0;
        map
    };
    let turn = |n: f64| {
        let (sin, cos) = (2.0 * PI / n).sin_cos();
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
    };
    let (x, y, z) = (mirror(0), mirror(1), mirror(2));
    for (text, maps) in [
        ("sphere", vec![x, y, z]),
        ("ellipsoid", vec![x, y, z]),
        ("superquadric:n1=7,n2=3", vec![x, y, z, turn(4.0)]),
        ("superquadric:n1=20,n2=20", vec![x, y, z, turn(4.0)]),
        ("box", vec![x, y, z]),
        ("rounded_cube", vec![x, y, z, turn(4.0)]),
        ("cylinder", vec![y, z, turn(32.0)]),
        ("hollow_cylinder", vec![y, z, turn(32.0)]),
        ("pellet", vec![y, z, turn(6.0)]),
        ("trilobe", vec![y, z, turn(3.0)]),
        ("quadrilobe", vec![x, y, z, turn(4.0)]),
        ("antifer", vec![x, y, turn(4.0)]),
        ("dolos", vec![x, y, z * turn(4.0)]),
        ("tetrapod", vec![y, turn(3.0)]),
        ("clump:spheres=-0.25 0 0 0.5/0.25 0 0 0.5", vec![x, y, z]),
    ] {
        let body = body(text, 1.0);
        for map in maps {
            assert!(is_symmetric(&body, &map), "{text}: {map}");
        }
    }
}
