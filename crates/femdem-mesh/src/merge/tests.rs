use super::*;
use crate::Polyhedron;

/// A surface given as a grid of quadrilaterals cut in two, over an outline of unit squares, and
/// the walls and floor below: a plate one thick.
fn plate(squares: &[[u32; 2]]) -> Polyhedron {
    let mut index = BTreeMap::new();
    let mut vertices = Vec::new();
    let mut triangles: Vec<Vec<u32>> = Vec::new();
    let mut add = |corners: [[u32; 3]; 4]| {
        let [a, b, c, d] = corners.map(|p| {
            *index.entry(p).or_insert_with(|| {
                vertices.push(Point3::from(p.map(f64::from)));
                vertices.len() as u32 - 1
            })
        });
        triangles.extend([vec![a, b, c], vec![a, c, d]]);
    };
    for &[x, y] in squares {
        let (x1, y1) = (x + 1, y + 1);
        add([[x, y, 1], [x1, y, 1], [x1, y1, 1], [x, y1, 1]]);
        add([[x, y, 0], [x, y1, 0], [x1, y1, 0], [x1, y, 0]]);
        let ring = [[x, y], [x1, y], [x1, y1], [x, y1]];
        let beyond = [
            [x, y.wrapping_sub(1)],
            [x1, y],
            [x, y1],
            [x.wrapping_sub(1), y],
        ];
        for (i, neighbour) in beyond.iter().enumerate() {
            if !squares.contains(neighbour) {
                let ([ax, ay], [bx, by]) = (ring[i], ring[(i + 1) % 4]);
                add([[ax, ay, 0], [bx, by, 0], [bx, by, 1], [ax, ay, 1]]);
            }
        }
    }
    Polyhedron::new(vertices, triangles).unwrap()
}

#[test]
fn a_plate_of_many_squares_becomes_a_cuboid() {
    let squares: Vec<[u32; 2]> = (0..5).flat_map(|x| (0..3).map(move |y| [x, y])).collect();
    let merged = plate(&squares).with_merged_faces();
    assert_eq!((merged.vertices().len(), merged.face_count()), (8, 6));
    assert!(merged.is_convex());
    assert_eq!(merged.mass_properties().volume, 15.0);
}

#[test]
fn regions_that_are_not_convex_become_convex_faces() {
    // An L, and a ring around a hole.
    let l = [[0, 0], [1, 0], [2, 0], [0, 1], [0, 2]];
    let ring = [
        [0, 0],
        [1, 0],
        [2, 0],
        [0, 1],
        [2, 1],
        [0, 2],
        [1, 2],
        [2, 2],
    ];
    for (squares, euler) in [(&l[..], 2), (&ring[..], 0)] {
        let body = plate(squares);
        let merged = body.with_merged_faces();
        assert!(
            merged.face_count() < body.face_count() / 2,
            "{}",
            merged.face_count()
        );
        assert_eq!(merged.euler_characteristic(), euler);
        assert!((merged.mass_properties().volume - squares.len() as f64).abs() < 1e-13);
        assert!((merged.area() - body.area()).abs() < 1e-12);
        for (i, face) in merged.faces().enumerate() {
            let n = merged.face_normal(i);
            let at = |k: usize| merged.vertices()[face[k % face.len()] as usize];
            for k in 0..face.len() {
                let turn = (at(k + 1) - at(k)).cross(&(at(k + 2) - at(k + 1))).dot(&n);
                assert!(turn > -1e-12, "face {i} is not convex: {face:?}");
            }
        }
    }
}

#[test]
fn an_open_surface_is_an_error() {
    let vertices = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]].map(Point3::from);
    let error = merge_coplanar(&vertices, &[[0, 1, 2]], 1e-9).unwrap_err();
    assert!(matches!(error, MeshError::OpenEdge { .. }));
}
