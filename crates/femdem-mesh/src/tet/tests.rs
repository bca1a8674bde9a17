use super::*;
use crate::catalogue::{CatalogueShape, Solid};
use crate::strategies::{convex_polyhedra, poses};
use proptest::prelude::*;

/// The cube from 0 to 1 as six tetrahedra about a diagonal (Kuhn): no interior point.
fn kuhn_cube() -> (Vec<Point3>, Vec<[u32; 4]>) {
    let point = |i: u32| Point3::from([i & 1, i >> 1 & 1, i >> 2 & 1].map(f64::from));
    let paths = [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]];
    let tets = paths.map(|[a, b]| [0, a, b, 7]).to_vec();
    ((0..8).map(point).collect(), tets)
}

#[test]
fn a_cube_of_six_tetrahedra() {
    let (points, tets) = kuhn_cube();
    let mesh = TetMesh::new(points, tets).unwrap();
    assert!((mesh.volume() - 1.0).abs() < 1e-15);
    assert_eq!(mesh.skin().len(), 12);
    assert_eq!(mesh.surface().unwrap().with_merged_faces().face_count(), 6);
    // All six share the diagonal: a ring of neighbours.
    for (i, neighbours) in mesh.neighbours().iter().enumerate() {
        let found: Vec<u32> = neighbours.iter().flatten().copied().collect();
        assert_eq!(found.len(), 2);
        for j in found {
            assert!(mesh.neighbours()[j as usize].contains(&Some(i as u32)));
        }
    }
    // The rule cuts the diagonal in the middle, at distance 1/2 from the skin.
    assert!(!mesh.every_tet_has_interior_point());
    let split = mesh.with_interior_points();
    assert!(split.every_tet_has_interior_point());
    assert_eq!(split.tets().len(), 12);
    assert_eq!(split.points()[8], Point3::new(0.5, 0.5, 0.5));
    assert!((split.distance_to_skin()[8] - 0.5).abs() < 1e-15);
}

/// Spoils a mesh.
type Change<'a> = &'a dyn Fn(&mut Vec<Point3>, &mut Vec<[u32; 4]>);

#[test]
fn defects_are_named() {
    let (points, tets) = kuhn_cube();
    let with = |change: Change| {
        let (mut points, mut tets) = (points.clone(), tets.clone());
        change(&mut points, &mut tets);
        TetMesh::new(points, tets).unwrap_err()
    };
    assert!(matches!(with(&|_, t| t.clear()), MeshError::NoTetrahedra));
    assert!(matches!(
        with(&|_, t| t[2][1] = 8),
        MeshError::TetrahedronIndex {
            tet: 2,
            index: 8,
            count: 8
        }
    ));
    assert!(matches!(
        with(&|_, t| t[2][1] = 0),
        MeshError::TetrahedronIndex {
            tet: 2,
            index: 0,
            ..
        }
    ));
    assert!(matches!(
        with(&|p, _| p.push(Point3::origin())),
        MeshError::UnusedPoint { point: 8 }
    ));
    assert!(matches!(
        with(&|_, t| t[3].swap(0, 1)),
        MeshError::FlatTetrahedron { tet: 3, volume } if (volume + 1.0 / 6.0).abs() < 1e-12
    ));
    assert!(matches!(
        with(&|p, _| p[0].x = f64::NAN),
        MeshError::NotFinite { vertex: 0, .. }
    ));
    assert!(matches!(
        with(&|_, t| t.push(t[0])),
        MeshError::NonManifoldTriangle { .. }
    ));
    // Without two opposite ones of the ring, the rest touch in the diagonal only.
    assert!(matches!(
        with(&|_, t| {
            t.remove(3);
            t.remove(0);
        }),
        MeshError::SeveralPieces { pieces: 2 }
    ));
}

#[test]
fn serialised_meshes_are_checked_again() {
    let (points, tets) = kuhn_cube();
    let mesh = TetMesh::new(points, tets).unwrap();
    let text = serde_json::to_string(&mesh).unwrap();
    assert_eq!(serde_json::from_str::<TetMesh>(&text).unwrap(), mesh);
    let broken = text.replace("[0,1,3,7]", "[1,0,3,7]");
    assert!(serde_json::from_str::<TetMesh>(&broken).is_err());
}

#[test]
fn the_regular_tetrahedron_is_perfect() {
    let corners = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]].map(Point3::from);
    let mesh = TetMesh::new(corners.to_vec(), vec![[0, 1, 3, 2]])
        .or_else(|_| TetMesh::new(corners.to_vec(), vec![[0, 1, 2, 3]]))
        .unwrap();
    let quality = mesh.quality();
    let edge = 8_f64.sqrt();
    assert!((quality.min_radius_ratio - 1.0).abs() < 1e-14);
    assert!((quality.min_dihedral - (1.0_f64 / 3.0).acos()).abs() < 1e-14);
    assert!((quality.max_dihedral - (1.0_f64 / 3.0).acos()).abs() < 1e-14);
    assert!((quality.smallest_height - edge * (2.0_f64 / 3.0).sqrt()).abs() < 1e-14);
}

#[test]
fn fans_of_the_catalogue() {
    for shape in CatalogueShape::all_with_mirror_images() {
        let body = shape.polyhedron(0.02).unwrap();
        for mesh in [
            TetMesh::centroid_fan(&body).unwrap(),
            TetMesh::star_fan(&body).unwrap(),
        ] {
            assert_eq!(
                mesh.surface().unwrap().triangles().len(),
                body.triangles().len()
            );
            let relative = mesh.volume() / body.mass_properties().volume - 1.0;
            assert!(relative.abs() < 1e-13, "{shape}: {relative:e}");
            // The largest sphere about a centre of symmetry is that of the catalogue.
            let depth = mesh.distance_to_skin().into_iter().fold(0.0, f64::max);
            assert!((depth / body.inradius() - 1.0).abs() < 1e-12, "{shape}");
        }
    }
}

#[test]
fn bodies_that_are_not_convex_have_no_centroid_fan() {
    let body = CatalogueShape::from(Solid::P5).polyhedron(1.0).unwrap();
    let mut vertices = body.vertices().to_vec();
    vertices[0] = Point3::origin() + vertices[0].coords * 0.2;
    let faces = body.triangles().iter().map(|t| t.to_vec()).collect();
    let dented = Polyhedron::new(vertices, faces).unwrap();
    assert!(matches!(
        TetMesh::centroid_fan(&dented),
        Err(MeshError::NotConvex)
    ));
    let mesh = TetMesh::star_fan(&dented).unwrap();
    assert!((mesh.volume() / dented.mass_properties().volume - 1.0).abs() < 1e-13);
}

proptest! {
    #[test]
    fn fans_fill_convex_bodies(body in convex_polyhedra(), pose in poses(1.0)) {
        let body = body.transformed(&pose).unwrap();
        let volume = body.mass_properties().volume;
        let centroid = TetMesh::centroid_fan(&body).unwrap();
        let star = TetMesh::star_fan(&body).unwrap();
        prop_assert!((centroid.volume() / volume - 1.0).abs() < 1e-12);
        prop_assert!((star.volume() / volume - 1.0).abs() < 1e-12);
        // No point of a convex body is deeper than the centre of its kernel's largest sphere.
        let depth = |mesh: &TetMesh| mesh.distance_to_skin().into_iter().fold(0.0, f64::max);
        prop_assert!(depth(&star) >= depth(&centroid) * (1.0 - 1e-9));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    #[test]
    fn refinement_keeps_volume_skin_and_shapes(body in convex_polyhedra()) {
        let mesh = TetMesh::centroid_fan(&body).unwrap();
        let once = mesh.refined().unwrap();
        let twice = once.refined().unwrap();
        prop_assert_eq!(twice.tets().len(), 64 * mesh.tets().len());
        prop_assert_eq!(twice.skin().len(), 16 * mesh.skin().len());
        prop_assert!((twice.volume() / mesh.volume() - 1.0).abs() < 1e-12);
        prop_assert!(once.every_tet_has_interior_point());
        // The children at the corners are similar to their parents: shapes get no better at the
        // worst, and with the right diagonal not much worse.
        let [before, after] = [&mesh, &twice].map(|mesh| mesh.quality().min_radius_ratio);
        prop_assert!(after <= before * (1.0 + 1e-9) && after > 0.2 * before, "{before} {after}");
        // Points of the refined fan lie in the body.
        let depth = twice.distance_to_skin().into_iter().fold(0.0, f64::max);
        prop_assert!((depth / body.inradius() - 1.0).abs() < 1e-9 || depth > body.inradius());
    }

    #[test]
    fn the_field_rule_keeps_the_body(keep in 1..6_usize, turn in poses(1.0)) {
        // Parts of the cube of six tetrahedra: wedges without any interior point.
        let (points, tets) = kuhn_cube();
        let mut used: Vec<u32> = tets[..keep].iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let index = |i: u32| used.binary_search(&i).unwrap() as u32;
        let points = used.iter().map(|&i| turn * points[i as usize]).collect();
        let tets = tets[..keep].iter().map(|tet| tet.map(index)).collect();
        let mesh = TetMesh::new(points, tets).unwrap();
        let split = mesh.with_interior_points();
        prop_assert!(split.every_tet_has_interior_point());
        prop_assert!((split.volume() / mesh.volume() - 1.0).abs() < 1e-12);
        prop_assert_eq!(split.skin().len(), mesh.skin().len());
    }
}

#[test]
fn the_nearest_point_of_a_triangle_is_that_of_a_fine_grid() {
    let triangle = [[0.1, 0.2, 0.3], [1.4, -0.2, 0.5], [0.3, 1.1, -0.4]].map(Point3::from);
    let grid: Vec<Point3> = (0..=300)
        .flat_map(|i| (0..=300 - i).map(move |j| (f64::from(i) / 300.0, f64::from(j) / 300.0)))
        .map(|(u, v)| {
            triangle[0] + (triangle[1] - triangle[0]) * u + (triangle[2] - triangle[0]) * v
        })
        .collect();
    for k in 0..200 {
        let p = Point3::from([1.0, 1.7, 2.3].map(|f| 2.0 * (f64::from(k) * f).sin()));
        let exact = (crate::closest_point(&triangle, &p) - p).norm();
        let sampled = grid
            .iter()
            .map(|q| (q - p).norm())
            .fold(f64::INFINITY, f64::min);
        assert!(
            exact <= sampled + 1e-12 && sampled < exact + 5e-3,
            "{k}: {exact} {sampled}"
        );
    }
}
