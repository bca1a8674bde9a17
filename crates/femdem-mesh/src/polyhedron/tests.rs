use super::*;
use crate::convex_hull;
use crate::strategies::{catalogue_shapes, convex_polyhedra, poses, vectors};
use proptest::prelude::*;

fn unit_cube() -> (Vec<Point3>, Vec<Vec<u32>>) {
    let vertices = (0..8)
        .map(|i| Point3::from([0, 1, 2].map(|k| f64::from(i >> k & 1))))
        .collect();
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    (vertices, faces.map(|f| f.to_vec()).to_vec())
}

/// The error after a change to the unit cube.
fn error_of(change: impl FnOnce(&mut Vec<Point3>, &mut Vec<Vec<u32>>)) -> MeshError {
    let (mut vertices, mut faces) = unit_cube();
    change(&mut vertices, &mut faces);
    Polyhedron::new(vertices, faces).unwrap_err()
}

#[test]
fn unit_cube_has_the_numbers_of_a_cube() {
    let (vertices, faces) = unit_cube();
    let cube = Polyhedron::new(vertices, faces).unwrap();
    assert_eq!(
        (cube.face_count(), cube.edges().len(), cube.faces().len()),
        (6, 12, 6)
    );
    assert_eq!(cube.area(), 6.0);
    assert_eq!(cube.mass_properties().volume, 1.0);
    assert_eq!(cube.mass_properties().centroid, Point3::new(0.5, 0.5, 0.5));
    assert_eq!(cube.inradius(), 0.5);
    assert_eq!(cube.bounding_radius(), 0.75_f64.sqrt());
    assert_eq!(cube.face_normal(1), Vector3::z());
    assert_eq!((cube.face_offset(0), cube.face_offset(1)), (0.0, 1.0));
    assert_eq!(cube.euler_characteristic(), 2);
    assert_eq!(cube.edges()[..3], [[0, 1], [0, 2], [0, 4]]);
    assert!(cube.is_convex());
}

#[test]
fn bad_coordinates_are_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        let error = error_of(|v, _| v[5].y = bad);
        assert!(
            matches!(error, MeshError::NotFinite { vertex: 5, .. }),
            "{error}"
        );
        assert!(error.to_string().contains("vertex 5"));
    }
    let scale = |factor: f64| error_of(|v, _| v.iter_mut().for_each(|p| *p *= factor));
    assert!(matches!(scale(1e-31), MeshError::Size { .. }));
    assert!(matches!(scale(1e31), MeshError::Size { .. }));
    assert!(matches!(scale(1e200), MeshError::Size { .. }));
    assert!(matches!(scale(0.0), MeshError::Size { .. }));
    let far = error_of(|v, _| v.iter_mut().for_each(|p| p.z += 1e10));
    assert!(matches!(far, MeshError::TooFarFromOrigin { .. }), "{far}");
}

#[test]
fn bad_connectivity_is_refused_where_it_is() {
    let error = error_of(|v, f| (v.clear(), f.clear()).0);
    assert!(matches!(
        error,
        MeshError::TooFew {
            vertices: 0,
            faces: 0
        }
    ));
    let error = error_of(|_, f| f.truncate(3));
    assert!(matches!(
        error,
        MeshError::TooFew {
            vertices: 8,
            faces: 3
        }
    ));
    let error = error_of(|_, f| f[2].truncate(2));
    assert!(matches!(
        error,
        MeshError::FaceTooShort { face: 2, count: 2 }
    ));
    let error = error_of(|_, f| f[3][1] = 8);
    assert!(matches!(
        error,
        MeshError::IndexOutOfRange {
            face: 3,
            index: 8,
            count: 8
        }
    ));
    let error = error_of(|_, f| f[4][2] = 0);
    assert!(matches!(
        error,
        MeshError::RepeatedVertex { face: 4, vertex: 0 }
    ));
    let error = error_of(|v, _| v.push(Point3::origin()));
    assert!(matches!(error, MeshError::UnreferencedVertex { vertex: 8 }));
    let error = error_of(|_, f| f.truncate(5));
    assert!(
        matches!(
            error,
            MeshError::OpenEdge {
                from: 1,
                to: 5,
                face: 2
            }
        ),
        "{error}"
    );
    let error = error_of(|_, f| f[5].reverse());
    assert!(
        matches!(error, MeshError::InconsistentOrientation { second: 5, .. }),
        "{error}"
    );
    let error = error_of(|_, f| f.push(f[0].clone()));
    assert!(
        matches!(error, MeshError::NonManifoldEdge { count: 3, .. }),
        "{error}"
    );
}

#[test]
fn an_inside_out_cube_is_refused_with_advice() {
    let error = error_of(|_, f| f.iter_mut().for_each(|face| face.reverse()));
    assert!(matches!(error, MeshError::InsideOut { volume } if (volume + 1.0).abs() < 1e-15));
    assert!(error.to_string().contains("reverse"), "{error}");
    assert!(error.to_string().contains("repair"), "{error}");
}

#[test]
fn two_bodies_are_refused_apart_and_touching_in_a_vertex() {
    let second = |v: &mut Vec<Point3>, f: &mut Vec<Vec<u32>>| {
        let copies: Vec<_> = v.iter().map(|p| p + Vector3::new(1.0, 1.0, 1.0)).collect();
        let faces: Vec<Vec<u32>> = f
            .iter()
            .map(|c| c.iter().map(|i| i + 8).collect())
            .collect();
        v.extend(copies);
        f.extend(faces);
    };
    let error = error_of(second);
    assert!(
        matches!(error, MeshError::Disconnected { components: 2 }),
        "{error}"
    );

    // Pyramids over two opposite squares of a strip of faces, apexes joined in one vertex.
    let ring = |z: f64| [[1., 0., z], [0., 1., z], [-1., 0., z], [0., -1., z]].map(Point3::from);
    let vertices: Vec<Point3> = ring(-1.0)
        .into_iter()
        .chain(ring(1.0))
        .chain([Point3::origin()])
        .collect();
    let mut faces = Vec::new();
    for i in 0..4 {
        let j = (i + 1) % 4;
        faces.extend([
            vec![i, j, j + 4, i + 4],
            vec![j, i, 8],
            vec![i + 4, j + 4, 8],
        ]);
    }
    let error = Polyhedron::new(vertices, faces).unwrap_err();
    assert!(
        matches!(error, MeshError::NonManifoldVertex { vertex: 8, fans: 2 }),
        "{error}"
    );
}

/// The unit cube with another one: scaled, moved and turned inside out or not.
fn with_second(scale: f64, shift: [f64; 3], inward: bool) -> MeshError {
    error_of(|v, f| {
        let shift = Vector3::from(shift);
        let second: Vec<Point3> = v.iter().map(|p| p * scale + shift).collect();
        let faces: Vec<Vec<u32>> = f
            .iter()
            .map(|face| face.iter().map(|i| i + 8).collect())
            .map(|face: Vec<u32>| {
                if inward {
                    face.into_iter().rev().collect()
                } else {
                    face
                }
            })
            .collect();
        v.extend(second);
        f.extend(faces);
    })
}

#[test]
fn a_shell_inside_another_is_a_hollow_whichever_is_given_first() {
    for inward in [true, false] {
        let error = with_second(0.5, [0.2, 0.3, 0.1], inward);
        assert!(
            matches!(error, MeshError::Hollow { shells: 2, face: 6 }),
            "{error}"
        );
        assert!(error.to_string().contains("hollow"), "{error}");
        let error = with_second(3.0, [-1.0; 3], inward);
        assert!(
            matches!(error, MeshError::Hollow { shells: 2, face: 0 }),
            "{error}"
        );
        // Half of it sticks out.
        for shift in [[0.2, 0.3, 0.8], [0.2, 0.3, 1.8]] {
            let error = with_second(0.5, shift, inward);
            assert!(
                matches!(error, MeshError::Disconnected { components: 2 }),
                "{error}"
            );
        }
    }
}

/// A cube in the notch of a U lies within the box around the U, not inside it.
#[test]
fn a_shell_in_a_notch_is_not_inside() {
    let u = [
        [0., 0.],
        [3., 0.],
        [3., 3.],
        [2., 3.],
        [2., 1.],
        [1., 1.],
        [1., 3.],
        [0., 3.],
    ];
    let u = prism(&u).scaled(3.0).unwrap();
    let (low, high) = bounding_box(u.vertices());
    let at = Point3::new(4.0, 6.0, 0.5 * (low.z + high.z) - 0.5);
    let mut vertices = u.vertices().to_vec();
    let mut faces: Vec<Vec<u32>> = u.faces().map(<[u32]>::to_vec).collect();
    let first = vertices.len() as u32;
    let (cube, squares) = unit_cube();
    vertices.extend(cube.iter().map(|p| p + at.coords));
    faces.extend(
        squares
            .iter()
            .map(|face| face.iter().map(|i| i + first).collect::<Vec<_>>()),
    );
    assert!(low.z < at.z && at.z + 1.0 < high.z);
    let error = Polyhedron::new(vertices, faces).unwrap_err();
    assert!(
        matches!(error, MeshError::Disconnected { components: 2 }),
        "{error}"
    );
}

#[test]
fn faces_must_be_planar_and_have_an_area() {
    let error = error_of(|v, _| v[7].z += 1e-3);
    assert!(matches!(error, MeshError::NotPlanar { .. }), "{error}");
    let (mut vertices, faces) = unit_cube();
    vertices[7].z += 1e-7;
    assert!(Polyhedron::new(vertices, faces).unwrap().is_convex());

    let (mut vertices, mut faces) = unit_cube();
    vertices.push(Point3::new(0.5, 0.0, 0.0));
    faces[0].push(8);
    faces[2].insert(1, 8);
    assert!(Polyhedron::new(vertices.clone(), faces.clone()).is_ok());
    // A triangle without area between the edge and its midpoint.
    faces[0].pop();
    faces.push(vec![0, 1, 8]);
    let error = Polyhedron::new(vertices, faces).unwrap_err();
    assert!(
        matches!(error, MeshError::DegenerateFace { face: 6, .. }),
        "{error}"
    );
}

#[test]
fn a_surface_folded_flat_has_no_volume() {
    let square = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]].map(Point3::from);
    let faces = vec![vec![0, 1, 2], vec![0, 2, 3], vec![1, 0, 3], vec![1, 3, 2]];
    let error = Polyhedron::new(square.to_vec(), faces).unwrap_err();
    assert!(matches!(error, MeshError::NoVolume { .. }), "{error}");
}

/// A prism with the outline of an arrow head, U or comb: not convex.
fn prism(outline: &[[f64; 2]]) -> Polyhedron {
    let n = outline.len() as u32;
    let vertices = [0.0, 1.0]
        .into_iter()
        .flat_map(|z| outline.iter().map(move |&[x, y]| Point3::new(x, y, z)))
        .collect();
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|i| vec![i, (i + 1) % n, (i + 1) % n + n, i + n]));
    Polyhedron::new(vertices, faces).unwrap()
}

fn triangle_area(body: &Polyhedron, triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|i| body.vertices()[i as usize]);
    (b - a).cross(&(c - a)).norm() / 2.0
}

#[test]
fn faces_that_are_not_convex_are_cut_without_overlap() {
    let outlines: [&[[f64; 2]]; 3] = [
        &[[0., 0.], [2., -1.], [1., 0.], [2., 1.]],
        &[
            [0., 0.],
            [3., 0.],
            [3., 3.],
            [2., 3.],
            [2., 1.],
            [1., 1.],
            [1., 3.],
            [0., 3.],
        ],
        &[
            [0., 0.],
            [4., 0.],
            [4., 1.],
            [3.5, 4.],
            [3., 1.],
            [2.5, 4.],
            [2., 1.],
            [1.5, 4.],
            [1., 1.],
        ],
    ];
    for outline in outlines {
        let body = prism(outline);
        assert!(!body.is_convex());
        let triangles = body.triangles();
        assert_eq!(triangles.len(), 2 * (outline.len() - 2) + 2 * outline.len());
        // Triangles that overlapped or left the face would have more area than the face.
        let area: f64 = triangles.iter().map(|&t| triangle_area(&body, t)).sum();
        assert!(
            (area - body.area()).abs() < 1e-12,
            "{area} instead of {}",
            body.area()
        );
        let faces = triangles.iter().map(|t| t.to_vec()).collect();
        let cut = Polyhedron::new(body.vertices().to_vec(), faces).unwrap();
        assert!((cut.mass_properties().volume - body.mass_properties().volume).abs() < 1e-12);
    }
}

/// Corners on a straight side, which rounding moves a little to one side or the other: no ear is cut along that
/// side, which would leave triangles without area.
#[test]
fn faces_with_corners_on_their_sides_are_cut_into_triangles_with_area() {
    let outlines: [&[[f64; 2]]; 3] = [
        &[[1., 1.], [0., 0.], [1., 0.], [2., 0.]],
        &[[0., 3.], [0., 2.], [0., 0.], [1., 0.], [2., 0.], [3., 0.]],
        &[
            [0., 2.],
            [0., 1.],
            [0., 0.],
            [1., 0.],
            [2., 0.],
            [3., 0.],
            [3., 1.],
            [2., 1.],
            [1., 1.],
            [1., 2.],
        ],
    ];
    for (outline, k) in outlines.iter().flat_map(|o| (0..60).map(move |k| (o, k))) {
        let turn = Vector3::new(0.3, 0.1 * f64::from(k), 0.7);
        let body = prism(outline)
            .transformed(&Pose::new(Vector3::zeros(), turn))
            .unwrap();
        let triangles = body.triangles();
        let least = triangles.iter().map(|&t| triangle_area(&body, t));
        let least = least.fold(f64::INFINITY, f64::min);
        assert!(least > 0.1, "{least} in {outline:?}, turn {k}");
        assert_eq!(body.self_intersections(1), [[0; 2]; 0]);
        let mut stl = Vec::new();
        crate::io::stl::write_ascii(&body, &mut stl).unwrap();
        crate::io::stl::parse(&stl).unwrap();
    }
}

#[test]
fn a_ring_has_euler_characteristic_zero() {
    // Square ring: outer and inner square, top and bottom, each quadrant a trapezium.
    let square =
        |r: f64, z: f64| [[r, r, z], [-r, r, z], [-r, -r, z], [r, -r, z]].map(Point3::from);
    let vertices = [
        square(2.0, 0.0),
        square(1.0, 0.0),
        square(1.0, 1.0),
        square(2.0, 1.0),
    ]
    .concat();
    let mut faces = Vec::new();
    for i in 0..4 {
        let j = (i + 1) % 4;
        for [a, b] in [[0, 4], [4, 8], [8, 12], [12, 0]] {
            faces.push(vec![a + i, b + i, b + j, a + j]);
        }
    }
    let ring = Polyhedron::new(vertices, faces).unwrap();
    assert_eq!(ring.euler_characteristic(), 0);
    assert!(!ring.is_convex());
    assert!((ring.mass_properties().volume - 12.0).abs() < 1e-13);
}

#[test]
fn serde_validates() {
    let (vertices, faces) = unit_cube();
    let cube = Polyhedron::new(vertices, faces).unwrap();
    let json = serde_json::to_string(&cube).unwrap();
    assert_eq!(serde_json::from_str::<Polyhedron>(&json).unwrap(), cube);
    let open = json.replace(",[1,3,7,5]", "");
    assert_ne!(open, json);
    let error = serde_json::from_str::<Polyhedron>(&open).unwrap_err();
    assert!(error.to_string().contains("open"), "{error}");
}

#[test]
fn factors_that_are_not_positive_are_refused() {
    let (vertices, faces) = unit_cube();
    let cube = Polyhedron::new(vertices, faces).unwrap();
    for factor in [0.0, -2.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            cube.scaled(factor),
            Err(MeshError::OutOfRange { .. })
        ));
    }
    assert!(matches!(cube.scaled(1e-31), Err(MeshError::Size { .. })));
}

/// A lid whose four corners lie in a plane only within the tolerance is cut along one diagonal,
/// and along the same one in the mirror: the other encloses another volume.
#[test]
fn a_bent_lid_keeps_its_diagonal_in_the_mirror() {
    let (mut vertices, faces) = unit_cube();
    let last = vertices.len() - 1;
    vertices[last].z += 1e-10;
    let body = Polyhedron::new(vertices, faces).unwrap();
    let mirrored = body.mirrored();
    let (one, other) = (body.mass_properties(), mirrored.mass_properties());
    assert!((other.volume / one.volume - 1.0).abs() < 1e-14);
}

proptest! {
    #[test]
    fn mirrored_twice_is_the_same_and_once_keeps_all_measures(body in convex_polyhedra()) {
        let mirrored = body.mirrored();
        prop_assert_eq!(&mirrored.mirrored(), &body);
        let (one, other) = (body.mass_properties(), mirrored.mass_properties());
        prop_assert!((other.volume / one.volume - 1.0).abs() < 1e-12);
        prop_assert!((other.centroid.x + one.centroid.x).abs() < 1e-13);
        prop_assert!((mirrored.area() / body.area() - 1.0).abs() < 1e-12);
        prop_assert!(mirrored.is_convex());
        let parts = Parts::from(mirrored.clone());
        prop_assert_eq!(&Polyhedron::try_from(parts).unwrap(), &mirrored);
    }

    #[test]
    fn planes_turn_with_the_body(body in convex_polyhedra(), pose in poses(10.0)) {
        let moved = body.transformed(&pose).unwrap();
        for i in 0..body.face_count() {
            let normal = pose.rotation * body.face_normal(i);
            prop_assert!((moved.face_normal(i) - normal).norm() < 1e-9);
            let offset = body.face_offset(i) + normal.dot(&pose.translation.vector);
            prop_assert!((moved.face_offset(i) - offset).abs() < 1e-8);
        }
        prop_assert!(moved.is_convex());
        prop_assert!((moved.bounding_radius() - body.bounding_radius()).abs() < 1e-12);
    }

    #[test]
    fn the_area_vector_of_a_closed_surface_is_zero(body in convex_polyhedra()) {
        let mut sum = Vector3::zeros();
        for triangle in body.triangles() {
            let [a, b, c] = triangle.map(|i| body.vertices()[i as usize]);
            sum += (b - a).cross(&(c - a));
        }
        prop_assert!(sum.norm() < 1e-13);
    }

    #[test]
    fn a_dented_body_is_not_convex(shape in catalogue_shapes(), dent in 1e-5..0.2_f64) {
        // Each triangle of one face is moved inwards at a new vertex in its middle.
        let body = shape.polyhedron(2.0).unwrap();
        let mut vertices = body.vertices().to_vec();
        let mut faces: Vec<Vec<u32>> = body.faces().map(<[u32]>::to_vec).collect();
        let face = faces.remove(0);
        let middle = face.iter().map(|&v| vertices[v as usize].coords).sum::<Vector3>()
            / face.len() as f64;
        let apex = vertices.len() as u32;
        vertices.push(Point3::from(middle - body.face_normal(0) * dent));
        faces.extend(sides(&face).map(|[a, b]| vec![a, b, apex]));
        let dented = Polyhedron::new(vertices, faces).unwrap();
        prop_assert!(!dented.is_convex());
        prop_assert!(dented.mass_properties().volume < body.mass_properties().volume);
        prop_assert_eq!(dented.with_merged_faces().face_count(), dented.face_count());
    }

    #[test]
    fn triangles_merge_to_the_faces_they_came_from(
        shape in catalogue_shapes(),
        pose in poses(5.0),
    ) {
        let body = shape.polyhedron(1.0).unwrap().transformed(&pose).unwrap();
        let triangles = body.triangles().iter().map(|t| t.to_vec()).collect();
        let cut = Polyhedron::new(body.vertices().to_vec(), triangles).unwrap();
        let merged = cut.with_merged_faces();
        prop_assert_eq!(merged.vertices(), body.vertices());
        let sorted = |body: &Polyhedron| {
            let mut faces: Vec<Vec<u32>> = body.faces().map(<[u32]>::to_vec).collect();
            for face in &mut faces {
                let start = (0..face.len()).min_by_key(|&k| face[k]).unwrap();
                face.rotate_left(start);
            }
            faces.sort_unstable();
            faces
        };
        prop_assert_eq!(sorted(&merged), sorted(&body));
    }

    #[test]
    fn the_extreme_points_in_any_direction_bound_the_hull(
        body in convex_polyhedra(),
        direction in vectors(1.0),
    ) {
        // The inner sphere fits and the outer one holds all.
        let centroid = body.mass_properties().centroid;
        let support = body
            .vertices()
            .iter()
            .map(|v| direction.dot(&(v - centroid)))
            .fold(f64::NEG_INFINITY, f64::max);
        let length = direction.norm();
        prop_assert!(support >= length * body.inradius() * (1.0 - 1e-12));
        prop_assert!(support <= length * body.bounding_radius() * (1.0 + 1e-12));
    }

    #[test]
    fn no_input_panics(
        coordinates in prop::collection::vec(prop::array::uniform3(-2..3_i8), 0..10),
        faces in prop::collection::vec(prop::collection::vec(0..10_u32, 0..5), 0..12),
    ) {
        let vertices: Vec<Point3> =
            coordinates.iter().map(|c| Point3::from(c.map(f64::from))).collect();
        if let Ok(body) = Polyhedron::new(vertices.clone(), faces) {
            prop_assert!(body.mass_properties().volume > 0.0);
        }
        if let Ok(hull) = convex_hull(&vertices) {
            prop_assert!(hull.mass_properties().volume > 0.0);
        }
    }
}
