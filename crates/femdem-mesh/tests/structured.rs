//! Structured meshes and meshes of ten-node tetrahedra.

use femdem_mesh::tet::{MID_EDGES, QuadraticMesh};
use femdem_mesh::{MeshError, TetMesh, Vector3};
use std::f64::consts::PI;

#[test]
fn a_block_fills_its_box() {
    let size = Vector3::new(2.0, 1.0, 0.5);
    let mesh = TetMesh::block([4, 2, 3], &size).unwrap();
    assert_eq!(mesh.points().len(), 5 * 3 * 4);
    assert_eq!(mesh.tets().len(), 6 * 4 * 2 * 3);
    assert!((mesh.volume() - 1.0).abs() < 1e-14);
    // Euler: the skin of a ball; two triangles on every outer face of a cell.
    assert_eq!(mesh.skin().len(), 4 * (4 * 2 + 2 * 3 + 4 * 3));
    assert_eq!(mesh.surface().unwrap().euler_characteristic(), 2);
    // Kuhn's tetrahedra of a cube have dihedral angles of 45, 60 and 90 degrees.
    let cube = TetMesh::block([3, 3, 3], &Vector3::repeat(1.0)).unwrap();
    assert!((cube.quality().min_dihedral.to_degrees() - 45.0).abs() < 1e-9);
}

#[test]
fn a_block_of_even_cells_is_its_own_mirror_image() {
    let mesh = TetMesh::block([2, 2, 2], &Vector3::new(1.0, 1.0, 1.0)).unwrap();
    let key = |mirror: bool| {
        let mut tets: Vec<Vec<[i64; 3]>> = mesh
            .tets()
            .iter()
            .map(|tet| {
                let mut corners: Vec<[i64; 3]> = tet
                    .iter()
                    .map(|&i| {
                        let p = mesh.points()[i as usize] * 2.0;
                        let x = if mirror { 2.0 - p.x } else { p.x };
                        [x, p.y, p.z].map(|c| c.round() as i64)
                    })
                    .collect();
                corners.sort_unstable();
                corners
            })
            .collect();
        tets.sort();
        tets
    };
    assert_eq!(key(false), key(true));
}

/// The volume comes near the octant's from below, with the second order of the cells.
#[test]
fn a_shell_octant_converges_to_the_sphere() {
    let exact = PI / 6.0 * (8.0 - 1.0);
    let error = |n: u32| {
        let mesh = TetMesh::shell_octant(1.0, 2.0, n, n).unwrap();
        for p in mesh.points() {
            let r = p.coords.norm();
            assert!(r > 1.0 - 1e-14 && r < 2.0 + 1e-14);
            assert!(p.iter().all(|&c| c >= 0.0));
        }
        assert!(mesh.quality().min_radius_ratio > 0.1);
        1.0 - mesh.volume() / exact
    };
    let (coarse, fine) = (error(6), error(12));
    assert!(coarse > 0.0 && coarse < 0.05, "{coarse}");
    assert!((coarse / fine - 4.0).abs() < 0.3, "{coarse} {fine}");
}

#[test]
fn sizes_that_mean_nothing_are_refused_by_name() {
    let one = Vector3::new(1.0, 1.0, 1.0);
    assert!(TetMesh::block([1, 1, 1], &one).is_ok());
    let refused = [
        TetMesh::block([0, 1, 1], &one),
        TetMesh::block([1, 1, 1], &Vector3::new(1.0, -1.0, 1.0)),
        TetMesh::block([1, 1, 1], &Vector3::new(1.0, f64::NAN, 1.0)),
        TetMesh::shell_octant(2.0, 1.0, 2, 2),
        TetMesh::shell_octant(0.0, 1.0, 2, 2),
        TetMesh::shell_octant(1.0, 2.0, 0, 2),
    ];
    for result in refused {
        assert!(
            matches!(result, Err(MeshError::OutOfRange { .. })),
            "{result:?}"
        );
    }
    let many = TetMesh::block([1 << 20, 1 << 20, 1 << 20], &one);
    assert!(matches!(many, Err(MeshError::TooMany { .. })));
    let many = TetMesh::shell_octant(1.0, 2.0, u32::MAX, u32::MAX);
    assert!(matches!(many, Err(MeshError::TooMany { .. })));
}

#[test]
fn ten_nodes_per_tetrahedron() {
    let mesh = TetMesh::block([2, 1, 1], &Vector3::new(2.0, 1.0, 1.0)).unwrap();
    let quadratic = QuadraticMesh::new(&mesh).unwrap();
    let nodes = quadratic.nodes();
    // Nodes of two cubes halved: a grid of 5 x 3 x 3.
    assert_eq!(nodes.len(), 45);
    assert_eq!(quadratic.mid_edges().len() + mesh.points().len(), 45);
    for element in quadratic.elements() {
        for (k, [i, j]) in MID_EDGES.iter().enumerate() {
            let at = |n: usize| nodes[element[n] as usize].coords;
            assert_eq!(at(4 + k), (at(*i) + at(*j)) / 2.0);
        }
    }
    let at = |n: u32| nodes[n as usize].coords;
    for face in quadratic.skin() {
        for k in 0..3 {
            assert_eq!(at(face[3 + k]), (at(face[k]) + at(face[(k + 1) % 3])) / 2.0);
        }
    }
    // Owners hold the corners of their triangles.
    for (triangle, owner) in mesh.skin().iter().zip(mesh.skin_owners()) {
        let tet = mesh.tets()[owner as usize];
        assert!(triangle.iter().all(|i| tet.contains(i)));
    }
}
