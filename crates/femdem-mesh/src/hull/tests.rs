use super::*;
use crate::Vector3;
use crate::strategies::{poses, vectors};
use parry3d_f64::transformation::try_convex_hull;
use proptest::prelude::*;

fn points(coordinates: &[[f64; 3]]) -> Vec<Point3> {
    coordinates.iter().map(|&c| Point3::from(c)).collect()
}

/// The hull holds every point, its vertices are points, and it is a valid convex surface.
fn check(points: &[Point3]) -> Result<Polyhedron, TestCaseError> {
    let hull = match convex_hull(points) {
        Ok(hull) => hull,
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    check_hull(points, &hull)?;
    Ok(hull)
}

fn check_hull(points: &[Point3], hull: &Polyhedron) -> Result<(), TestCaseError> {
    let extent = check_coordinates(points).unwrap();
    let largest = points.iter().map(|p| p.coords.amax()).fold(0.0, f64::max);
    let allowed = 3.0 * (RESOLUTION * extent + 2.0 * f64::EPSILON * largest);
    prop_assert!(hull.is_convex());
    prop_assert_eq!(hull.euler_characteristic(), 2);
    for v in hull.vertices() {
        prop_assert!(points.contains(v));
    }
    for (i, face) in hull.faces().enumerate() {
        let on_plane = hull.vertices()[face[0] as usize];
        for p in points {
            let height = hull.face_normal(i).dot(&(p - on_plane));
            prop_assert!(
                height <= allowed,
                "{p} lies {height:e} above face {i}: {face:?}"
            );
        }
    }
    Ok(())
}

/// Volume of the hull by parry, an independent implementation.
fn volume_by_parry(points: &[Point3]) -> Option<f64> {
    let glam: Vec<_> = points
        .iter()
        .map(|p| parry3d_f64::math::Vector::new(p.x, p.y, p.z))
        .collect();
    let (vertices, triangles) = try_convex_hull(&glam).ok()?;
    let apex = vertices.first().copied()?;
    let tetrahedra = triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| vertices[i as usize] - apex);
        a.dot(b.cross(c)) / 6.0
    });
    Some(tetrahedra.sum())
}

fn cloud(size: std::ops::RangeInclusive<usize>) -> impl Strategy<Value = Vec<Point3>> {
    prop::collection::vec(vectors(1.0).prop_map(Point3::from), size)
}

/// Points of a small integer grid: full of coplanar, collinear and coincident ones.
fn grid_cloud() -> impl Strategy<Value = Vec<Point3>> {
    let coordinate = prop::array::uniform3(0..4_i8);
    prop::collection::vec(
        coordinate.prop_map(|c| Point3::from(c.map(f64::from))),
        4..60,
    )
}

#[test]
fn a_grid_of_points_is_a_cube() {
    let axis = [0.0, 0.1, 0.2, 0.3, 0.7, 1.0];
    let grid: Vec<Point3> = axis
        .into_iter()
        .flat_map(|x| {
            axis.into_iter()
                .flat_map(move |y| axis.map(|z| Point3::new(x, y, z)))
        })
        .collect();
    let hull = convex_hull(&grid).unwrap();
    assert_eq!((hull.vertices().len(), hull.face_count()), (8, 6));
    assert!((hull.mass_properties().volume - 1.0).abs() < 1e-15);
}

#[test]
fn flat_points_are_refused_by_name() {
    let span = |coordinates: &[[f64; 3]]| match convex_hull(&points(coordinates)) {
        Err(MeshError::FlatPoints { span, .. }) => span,
        other => panic!("{other:?}"),
    };
    let line: Vec<[f64; 3]> = (0..9).map(|i| [f64::from(i) / 3.0, 0.1, 0.7]).collect();
    let plane: Vec<[f64; 3]> = (0..16)
        .map(|i| [f64::from(i % 4) / 3.0, f64::from(i / 4) / 7.0, 0.1])
        .collect();
    assert_eq!(span(&line), "lie on a line");
    assert_eq!(span(&plane), "lie in a plane");
    let one_place = points(&[[1.0, 2.0, 3.0]; 5]);
    assert_eq!(span(&[[1.0, 2.0, 3.0]; 5]), "coincide");
    for few in [&one_place[..3], &[]] {
        let says = convex_hull(few).unwrap_err().to_string();
        assert!(says.contains(&format!("{} points", few.len())), "{says}");
        assert!(!says.contains("face"), "{says}");
    }
}

/// Squares of such sizes overflow or vanish; the message states the size all the same.
#[test]
fn sizes_out_of_range_are_named() {
    let corners = [[0., 0., 0.], [3., 0., 0.], [0., 4., 0.], [0., 0., 12.]];
    for (scale, size) in [(1e200, "e201 m"), (1e-200, "e-199 m")] {
        let refused = convex_hull(&points(&corners.map(|c| c.map(|x| x * scale)))).unwrap_err();
        let says = refused.to_string();
        assert!(says.contains(size), "{says}");
    }
}

#[test]
fn coordinates_that_are_not_numbers_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let tetrahedron = points(&[[0., 0., 0.], [1., 0., 0.], [0., bad, 0.], [0., 0., 1.]]);
        assert!(matches!(
            convex_hull(&tetrahedron),
            Err(MeshError::NotFinite { vertex: 2, .. })
        ));
    }
}

#[test]
fn a_sphere_of_many_points_is_quick_and_whole() {
    // A spiral of even density (golden angle).
    let n = 4000;
    let sphere: Vec<Point3> = (0..n)
        .map(|i| {
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
            let angle = 2.399_963_229_728_653 * f64::from(i);
            let r = (1.0 - z * z).sqrt();
            Point3::new(r * angle.cos(), r * angle.sin(), z)
        })
        .collect();
    let hull = convex_hull(&sphere).unwrap();
    assert_eq!(hull.vertices().len(), sphere.len());
    let volume = hull.mass_properties().volume;
    assert!((volume / (std::f64::consts::PI * 4.0 / 3.0) - 1.0).abs() < 3e-3);
}

/// Clouds hardly thicker than the resolution: a corner beyond a sharp rim lies hardly above any plane.
#[test]
fn thin_clouds_keep_their_corners() {
    let mut state = 7_u64;
    let mut draw = |count: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) % count
    };
    let mut hulls = 0;
    for _ in 0..20_000 {
        let thickness = 1e-9 * (1 + draw(20)) as f64;
        let count = 6 + draw(6);
        let cloud: Vec<Point3> = (0..count)
            .map(|_| {
                let [x, y] = [0, 1].map(|_| draw(7) as f64 - 3.0);
                Point3::new(x, y, thickness * (draw(5) as f64 - 2.0))
            })
            .collect();
        if let Ok(hull) = convex_hull(&cloud) {
            hulls += 1;
            check_hull(&cloud, &hull).unwrap();
        }
    }
    assert!(hulls > 5_000, "{hulls}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    #[test]
    fn random_clouds_have_a_valid_hull(
        cloud in cloud(5..=60),
        scale in prop::sample::select(vec![1e-9, 1e-3, 1.0, 1e6]),
        offset in prop::sample::select(vec![0.0, 1.0, 1e3, 1e6]),
    ) {
        let cloud: Vec<Point3> = cloud
            .iter()
            .map(|p| p * scale + Vector3::new(1.0, -0.7, 0.3) * (offset * scale))
            .collect();
        check(&cloud)?;
    }

    #[test]
    fn the_volume_is_that_of_parry(cloud in cloud(8..=60)) {
        let hull = check(&cloud)?;
        if let Some(expected) = volume_by_parry(&cloud) {
            prop_assert!((hull.mass_properties().volume / expected - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn grids_have_a_valid_hull_or_are_flat(cloud in grid_cloud(), pose in poses(1.0)) {
        let turned: Vec<Point3> = cloud.iter().map(|p| pose * p).collect();
        match convex_hull(&cloud) {
            Ok(straight) => {
                check_hull(&cloud, &straight)?;
                // Rounding of the turned coordinates must not change the faces.
                let turned = check(&turned)?;
                prop_assert_eq!(turned.face_count(), straight.face_count());
                prop_assert_eq!(turned.vertices().len(), straight.vertices().len());
            }
            Err(_) => prop_assert!(convex_hull(&turned).is_err()),
        }
    }

    #[test]
    fn almost_flat_and_almost_equal_points_give_a_hull_or_an_error(
        cloud in cloud(4..=40),
        noise in cloud(40..=40),
        exponent in 3..17_i32,
        flat in any::<bool>(),
        offset in prop::sample::select(vec![0.0, 1.0, 1e6]),
    ) {
        let small = 10_f64.powi(-exponent);
        let shift = Vector3::new(offset, 0.3 * offset, 0.0);
        let cloud: Vec<Point3> = if flat {
            cloud.iter().map(|p| Point3::new(p.x, p.y, p.z * small) + shift).collect()
        } else {
            let near = cloud.iter().zip(&noise).map(|(p, n)| p + n.coords * small);
            cloud.iter().copied().chain(near).map(|p| p + shift).collect()
        };
        match convex_hull(&cloud) {
            Ok(hull) => {
                prop_assert!(hull.is_convex());
                prop_assert!(hull.mass_properties().volume > 0.0);
            }
            Err(MeshError::FlatPoints { .. }) => prop_assert!(flat),
            Err(error) => prop_assert!(false, "{error}"),
        }
    }

    #[test]
    fn the_hull_of_a_hull_is_itself(cloud in cloud(6..=60)) {
        let hull = check(&cloud)?;
        prop_assert_eq!(&convex_hull(hull.vertices()).unwrap(), &hull);
    }

    #[test]
    fn any_numbers_give_a_hull_or_an_error(
        numbers in prop::collection::vec(prop::array::uniform3(any::<f64>()), 0..20)
    ) {
        if let Ok(hull) = convex_hull(&points(&numbers)) {
            prop_assert!(hull.is_convex());
        }
    }
}
