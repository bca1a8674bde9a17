use super::*;
use crate::catalogue::CatalogueShape;
use crate::shapes::{Shape, Sphere};
use crate::strategies::{catalogue_shapes, convex_polyhedra, poses};
use crate::{Polyhedron, Vector3, convex_hull};
use proptest::prelude::*;
use std::collections::BTreeSet;

fn points(coordinates: &[[f64; 3]]) -> Vec<Point3> {
    coordinates.iter().map(|&c| c.into()).collect()
}

/// Two triangles of six points of their own.
fn apart(coordinates: [[f64; 3]; 6]) -> bool {
    let vertices = points(&coordinates);
    let forward = meet(&vertices, [0, 1, 2], [3, 4, 5]);
    for (t, u) in [([1, 2, 0], [3, 5, 4]), ([2, 1, 0], [5, 3, 4])] {
        assert_eq!(meet(&vertices, t, u), forward);
        assert_eq!(meet(&vertices, u, t), forward);
    }
    forward
}

const FLOOR: [[f64; 3]; 3] = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.]];

fn with_floor(other: [[f64; 3]; 3]) -> bool {
    let [a, b, c] = FLOOR;
    let [d, e, f] = other;
    apart([a, b, c, d, e, f])
}

#[test]
fn triangles_without_a_common_vertex() {
    // Through the inside, beside it, above it.
    assert!(with_floor([[1., 1., -1.], [1., 1., 1.], [2., 1., 1.]]));
    assert!(!with_floor([[3., 3., -1.], [3., 3., 1.], [4., 3., 1.]]));
    assert!(!with_floor([[1., 1., 1e-300], [1., 2., 1.], [2., 1., 1.]]));
    // Touching by a corner, by an edge in the plane, corner on corner.
    assert!(with_floor([[1., 1., 0.], [1., 1., 1.], [2., 1., 1.]]));
    assert!(with_floor([[1., 1., 0.], [9., 9., 0.], [2., 1., 1.]]));
    assert!(with_floor([[0., 0., 0.], [-1., -1., 1.], [-2., 0., 1.]]));
    // An edge in the plane but outside; an edge across the whole triangle.
    assert!(!with_floor([[3., 3., 0.], [9., 9., 0.], [2., 1., 1.]]));
    assert!(with_floor([[-1., 1., 0.], [9., 1., 0.], [2., 1., 1.]]));
    // In one plane: apart, crossing, one in the other either way, sharing part of an edge.
    assert!(!with_floor([[3., 3., 0.], [4., 3., 0.], [4., 4., 0.]]));
    assert!(with_floor([[1., -1., 0.], [2., -1., 0.], [1., 9., 0.]]));
    assert!(with_floor([[1., 1., 0.], [1.5, 1., 0.], [1., 1.5, 0.]]));
    assert!(with_floor([[-9., -9., 0.], [90., -9., 0.], [-9., 90., 0.]]));
    assert!(with_floor([[1., 0., 0.], [2., 0., 0.], [1., -1., 0.]]));
    assert!(!with_floor([[5., 0., 0.], [6., 0., 0.], [5., -1., 0.]]));
}

#[test]
fn triangles_with_a_common_vertex() {
    let fans = |other: [[f64; 3]; 2]| {
        let [a, b, c] = FLOOR;
        let vertices = points(&[a, b, c, other[0], other[1]]);
        let forward = meet(&vertices, [0, 1, 2], [3, 0, 4]);
        assert_eq!(meet(&vertices, [4, 3, 0], [2, 0, 1]), forward);
        forward
    };
    assert!(!fans([[1., 1., 1.], [2., 1., 1.]]));
    assert!(!fans([[-1., -1., 0.], [-1., -2., 0.]]));
    // The side opposite to the common vertex passes through, reaches over, lies in the plane.
    assert!(fans([[1., 1., -1.], [1., 1., 1.]]));
    assert!(fans([[9., 9., -1.], [9., 9., 1.]]));
    assert!(!fans([[9., -9., -1.], [9., -9., 1.]]));
    assert!(fans([[1., 1., 0.], [1., 1., 1.]]));
    assert!(fans([[9., 9., 0.], [1., 1., 1.]]));
    assert!(fans([[1., 1., 0.], [1., 2., 0.]]));
    assert!(fans([[9., 8., 0.], [8., 9., 0.]]));
    assert!(fans([[2., 0., 0.], [1., -1., 0.]]));
    assert!(!fans([[-1., 1., 0.], [-1., 2., 0.]]));
}

#[test]
fn triangles_with_a_common_edge() {
    let hinge = |other: [f64; 3]| {
        let [a, b, c] = FLOOR;
        let vertices = points(&[a, b, c, other]);
        let forward = meet(&vertices, [0, 1, 2], [1, 0, 3]);
        assert_eq!(meet(&vertices, [3, 1, 0], [2, 0, 1]), forward);
        forward
    };
    assert!(!hinge([1., -1., 0.]));
    assert!(!hinge([1., 1., 1e-300]));
    assert!(hinge([1., 1., 0.]));
    assert!(hinge([9., 9., 0.]));
    assert!(meet(&points(&FLOOR), [0, 1, 2], [2, 1, 0]));
}

/// A surface of two parts joined as one list of faces would be disconnected, so that bodies that
/// cut themselves are made by pulling a vertex of a body through its other side.
fn pulled_through(body: &Polyhedron, vertex: usize, to: Vector3) -> Option<Polyhedron> {
    let mut vertices = body.vertices().to_vec();
    vertices[vertex] += to;
    let triangles = body.triangles().iter().map(|t| t.to_vec()).collect();
    Polyhedron::new(vertices, triangles).ok()
}

#[test]
fn solids_do_not_cut_themselves() {
    for shape in CatalogueShape::all_with_mirror_images() {
        let body = shape.polyhedron(0.02).unwrap();
        assert_eq!(body.self_intersections(10), [[0_usize; 2]; 0]);
    }
}

#[test]
fn a_spike_through_the_far_side_names_the_faces() {
    let corners = points(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.4, 0.3, 1.0]]);
    let body = convex_hull(&corners).unwrap();
    let faces: Vec<Vec<u32>> = body.faces().map(<[u32]>::to_vec).collect();
    // The face opposite to vertex 0, raised to a vertex that lies below the base.
    let slanted = faces.iter().position(|f| !f.contains(&0)).unwrap();
    let mut vertices = body.vertices().to_vec();
    vertices.push(Point3::new(0.2, 0.2, -0.1));
    let mut with_spike = faces.clone();
    let [a, b, c] = faces[slanted][..] else {
        panic!()
    };
    with_spike[slanted] = vec![a, b, 4];
    with_spike.extend([vec![b, c, 4], vec![c, a, 4]]);
    let body = Polyhedron::new(vertices, with_spike.clone()).unwrap();
    let base = faces.iter().position(|f| !f.contains(&3)).unwrap();
    let found = body.self_intersections(100);
    assert!(!found.is_empty());
    assert!(found.iter().all(|pair| pair.contains(&base)), "{found:?}");
    assert_eq!(body.self_intersections(1).len(), 1);
    assert_eq!(body.self_intersections_within(100, 3), None);
}

/// Of triangles of one size each has so many near it, however many there are.
#[test]
fn comparisons_grow_as_the_triangles_do() {
    for level in [2, 3, 4] {
        let body = Shape::from(Sphere { level }).polyhedron(1.0).unwrap();
        let budget = 12 * body.face_count() as u64;
        assert_eq!(body.self_intersections_within(1, budget), Some(Vec::new()));
    }
}

#[test]
fn needless_vertices_on_edges_are_no_contact() {
    // A box whose upper and lower faces have a vertex in the middle of each side.
    let ring = |z: f64| {
        [[0., 0.], [1., 0.], [2., 0.], [2., 2.], [1., 2.], [0., 2.]].map(|[x, y]| [x, y, z])
    };
    let vertices = points(&[ring(0.0), ring(1.0)].concat());
    let mut faces = vec![(0..6).rev().collect::<Vec<u32>>(), (6..12).collect()];
    faces.extend((0..6).map(|i| vec![i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6]));
    for turned in [0.0, 0.3] {
        let pose = crate::Pose::rotation(Vector3::new(turned, 2.0 * turned, turned));
        let body = Polyhedron::new(vertices.clone(), faces.clone())
            .unwrap()
            .transformed(&pose)
            .unwrap();
        assert_eq!(body.self_intersections(9), [[0_usize; 2]; 0]);
    }
}

proptest! {
    #[test]
    fn convex_bodies_do_not_cut_themselves(body in convex_polyhedra(), pose in poses(3.0)) {
        prop_assert!(body.self_intersections(1).is_empty());
        let triangles = body.triangles().iter().map(|t| t.to_vec()).collect();
        let triangles = Polyhedron::new(body.vertices().to_vec(), triangles).unwrap();
        prop_assert!(triangles.self_intersections(1).is_empty());
        let moved = triangles.transformed(&pose).unwrap();
        // Coplanar triangles may be folded by rounding, never by more.
        for [i, j] in moved.self_intersections(9) {
            prop_assert!(moved.face_normal(i).dot(&moved.face_normal(j)).abs() > 1.0 - 1e-9);
        }
    }

    #[test]
    fn agrees_with_parry_away_from_touching(
        shape in catalogue_shapes(),
        vertex in 0..12_usize,
        to in crate::strategies::vectors(3.0),
    ) {
        let body = shape.polyhedron(2.0).unwrap();
        let Some(body) = pulled_through(&body, vertex % body.vertices().len(), to) else {
            return Ok(());
        };
        let found: BTreeSet<[usize; 2]> = body.self_intersections(usize::MAX).into_iter().collect();
        let triangles = body.triangles();
        for j in 0..triangles.len() {
            for i in 0..j {
                let shared = triangles[i].iter().filter(|v| triangles[j].contains(v)).count();
                if shared > 0 {
                    continue;
                }
                let corners = |t: [u32; 3]| t.map(|v| {
                    let p = body.vertices()[v as usize];
                    parry3d_f64::math::Vector::new(p.x, p.y, p.z)
                });
                let [a, b, c] = corners(triangles[i]);
                let [d, e, f] = corners(triangles[j]);
                let one = parry3d_f64::shape::Triangle::new(a, b, c);
                let other = parry3d_f64::shape::Triangle::new(d, e, f);
                let at = parry3d_f64::math::Pose::identity();
                let distance = parry3d_f64::query::distance(&at, &one, &at, &other).unwrap().distance;
                if found.contains(&[i, j]) {
                    prop_assert!(distance < 1e-6, "{i} {j} {distance}");
                } else {
                    prop_assert!(distance > 0.0, "{i} {j}");
                }
            }
        }
    }
}
