use super::*;
use crate::strategies::{convex_polyhedra, poses, rotations};
use crate::{Polyhedron, Pose, convex_hull};
use proptest::prelude::*;

/// A box with one corner at `low` and sides `size`.
fn cuboid(low: [f64; 3], size: [f64; 3]) -> Polyhedron {
    let corners: Vec<Point3> = (0..8)
        .map(|i| {
            Point3::from(std::array::from_fn(|k| {
                low[k] + size[k] * f64::from(i >> k & 1)
            }))
        })
        .collect();
    convex_hull(&corners).unwrap()
}

/// Closed form for a cuboid: volume and moments about its centroid.
fn cuboid_moments([a, b, c]: [f64; 3]) -> (f64, Vector3) {
    let volume = a * b * c;
    (
        volume,
        volume / 12.0 * Vector3::new(b * b + c * c, c * c + a * a, a * a + b * b),
    )
}

fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value} instead of {expected}"
    );
}

#[test]
fn an_l_shaped_prism_is_the_sum_of_two_cuboids() {
    // Outline 0..3 by 0..1 and 0..1 by 1..4, from z = 0 to 2.
    let outline = [[0., 0.], [3., 0.], [3., 1.], [1., 1.], [1., 4.], [0., 4.]];
    let vertices = [0.0, 2.0]
        .into_iter()
        .flat_map(|z| outline.map(|[x, y]| Point3::new(x, y, z)))
        .collect();
    let mut faces: Vec<Vec<u32>> = vec![(0..6).rev().collect(), (6..12).collect()];
    faces.extend((0..6).map(|i| vec![i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6]));
    let body = Polyhedron::new(vertices, faces).unwrap();
    assert!(!body.is_convex());

    let parts = [([0., 0., 0.], [3., 1., 2.]), ([0., 1., 0.], [1., 3., 2.])];
    let total: f64 = parts.iter().map(|(_, size)| cuboid_moments(*size).0).sum();
    let middle = |low: [f64; 3], size: [f64; 3]| Vector3::from(low) + Vector3::from(size) / 2.0;
    let centroid = parts
        .iter()
        .map(|&(low, size)| cuboid_moments(size).0 / total * middle(low, size))
        .sum::<Vector3>();
    // Parallel axes (Huygens and Steiner).
    let inertia = parts
        .iter()
        .map(|&(low, size)| {
            let (volume, moments) = cuboid_moments(size);
            let r = middle(low, size) - centroid;
            Matrix3::from_diagonal(&moments)
                + volume * (Matrix3::identity() * r.norm_squared() - r * r.transpose())
        })
        .sum::<Matrix3>();

    let mass = body.mass_properties();
    assert_near(mass.volume, total, 1e-13);
    assert!((mass.centroid.coords - centroid).norm() < 1e-13);
    assert!((mass.inertia - inertia).amax() < 1e-12);
    assert_near(body.area(), 2.0 * 6.0 + 14.0 * 2.0, 1e-13);
}

#[test]
fn far_from_the_origin_the_digits_stay() {
    // At 2^20 all corners are exact numbers: only the method could lose digits.
    let far = f64::from(1 << 20);
    let body = cuboid([far, -far, far], [0.5, 0.25, 1.0]);
    let (volume, moments) = cuboid_moments([0.5, 0.25, 1.0]);
    let mass = body.mass_properties();
    assert_near(mass.volume, volume, 1e-15);
    assert_eq!(
        mass.centroid,
        Point3::new(far + 0.25, -far + 0.125, far + 0.5)
    );
    assert!((mass.inertia - Matrix3::from_diagonal(&moments)).amax() < 1e-16);
}

/// Points of the Halton sequence in the cube from -1 to 1: as random points, but more even.
fn halton(count: u32) -> impl Iterator<Item = Point3> {
    let radical_inverse = |mut i: u32, base: u32| {
        let (mut value, mut digit) = (0.0, 1.0);
        while i > 0 {
            digit /= f64::from(base);
            value += digit * f64::from(i % base);
            i /= base;
        }
        value
    };
    (1..=count).map(move |i| Point3::from([2, 3, 5].map(|b| 2.0 * radical_inverse(i, b) - 1.0)))
}

#[test]
fn integrals_agree_with_counting_points_inside() {
    let points: Vec<Point3> = halton(400).skip(350).collect();
    let body = convex_hull(&points).unwrap();
    let inside = |p: &Point3| {
        (0..body.face_count()).all(|i| body.face_normal(i).dot(&p.coords) <= body.face_offset(i))
    };
    let count = 200_000;
    let hits: Vec<Point3> = halton(count).filter(inside).collect();
    let cell = 8.0 / f64::from(count);
    let mass = body.mass_properties();
    assert_near(hits.len() as f64 * cell / mass.volume, 1.0, 2e-3);
    let centroid = hits.iter().map(|p| p.coords).sum::<Vector3>() / hits.len() as f64;
    assert!((centroid - mass.centroid.coords).norm() < 2e-3);
    let inertia = hits
        .iter()
        .map(|p| {
            let r = p - mass.centroid;
            cell * (Matrix3::identity() * r.norm_squared() - r * r.transpose())
        })
        .sum::<Matrix3>();
    assert!((inertia - mass.inertia).amax() < 5e-3 * mass.inertia.amax());
}

#[test]
fn principal_frame_of_an_aligned_or_isotropic_body_is_the_identity() {
    for size in [[3.0, 2.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, 5.0]] {
        let frame = cuboid([-1.0, 4.0, 0.0], size).mass_properties().principal();
        assert_eq!(frame.rotation, Rotation::identity());
        assert!((frame.moments - cuboid_moments(size).1).amax() < 1e-12);
    }
    let turned = Pose::rotation(Vector3::new(0.3, -0.7, 1.1));
    let cube = cuboid([0.0; 3], [2.0; 3]).transformed(&turned).unwrap();
    assert_eq!(
        cube.mass_properties().principal().rotation,
        Rotation::identity()
    );
}

#[test]
fn principal_frame_of_what_is_not_a_number_is_the_identity() {
    let mass = MassProperties {
        volume: 1.0,
        centroid: Point3::origin(),
        inertia: Matrix3::from_element(f64::NAN),
    };
    assert_eq!(mass.principal().rotation, Rotation::identity());
}

proptest! {
    #[test]
    fn rigid_motion_turns_the_inertia_and_moves_the_centroid(
        body in convex_polyhedra(),
        pose in poses(100.0),
    ) {
        let moved = body.transformed(&pose).unwrap();
        let (before, after) = (body.mass_properties(), moved.mass_properties());
        let r = pose.rotation.to_rotation_matrix().into_inner();
        prop_assert!((after.volume / before.volume - 1.0).abs() < 1e-11);
        prop_assert!((after.centroid - pose * before.centroid).norm() < 1e-12);
        let inertia = r * before.inertia * r.transpose();
        prop_assert!((after.inertia - inertia).amax() < 1e-11 * inertia.amax());
        prop_assert!((moved.area() / body.area() - 1.0).abs() < 1e-11);
    }

    #[test]
    fn lengths_scale_volume_by_the_third_and_inertia_by_the_fifth_power(
        body in convex_polyhedra(),
        exponent in -9..6_i32,
    ) {
        let factor = 10_f64.powi(exponent);
        let scaled = body.scaled(factor).unwrap();
        let (one, other) = (body.mass_properties(), scaled.mass_properties());
        prop_assert!((other.volume / factor.powi(3) / one.volume - 1.0).abs() < 1e-12);
        let inertia = other.inertia / factor.powi(5);
        prop_assert!((inertia - one.inertia).amax() < 1e-12 * one.inertia.amax());
        prop_assert!((scaled.inradius() / factor / body.inradius() - 1.0).abs() < 1e-11);
    }

    #[test]
    fn principal_frame_rebuilds_the_inertia(body in convex_polyhedra(), exponent in -9..6_i32) {
        let body = body.scaled(10_f64.powi(exponent)).unwrap();
        let inertia = body.mass_properties().inertia;
        let PrincipalFrame { rotation, moments } = body.mass_properties().principal();
        let r = rotation.to_rotation_matrix().into_inner();
        let rebuilt = r * Matrix3::from_diagonal(&moments) * r.transpose();
        prop_assert!((rebuilt - inertia).amax() < 1e-9 * inertia.amax());
        prop_assert!((r.determinant() - 1.0).abs() < 1e-12);
        // A body's moments are positive and obey the triangle inequality.
        prop_assert!(moments.min() > 0.0);
        prop_assert!(moments.max() < moments.sum() - moments.max());
    }

    #[test]
    fn principal_moments_of_a_turned_cuboid_are_found(rotation in rotations()) {
        let size = [3.0, 2.0, 1.0];
        let body = cuboid([0.0; 3], size).transformed(&Pose::from_parts([7.0, 8.0, 9.0].into(), rotation)).unwrap();
        let frame = body.mass_properties().principal();
        let mut found: Vec<f64> = frame.moments.iter().copied().collect();
        found.sort_by(f64::total_cmp);
        let mut expected: Vec<f64> = cuboid_moments(size).1.iter().copied().collect();
        expected.sort_by(f64::total_cmp);
        for (found, expected) in found.iter().zip(&expected) {
            prop_assert!((found / expected - 1.0).abs() < 1e-10);
        }
    }
}
