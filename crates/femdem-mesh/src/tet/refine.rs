//! Red refinement: every tetrahedron into eight.

use super::quality::radius_ratio;
use super::{EDGES, TetMesh, oriented};
use crate::{MeshError, Point3};

/// Per diagonal of the inner octahedron: its two ends and the ring around it, as edges of the
/// tetrahedron (indices of [`EDGES`]).
const DIAGONALS: [([usize; 2], [usize; 4]); 3] = [
    ([0, 5], [1, 3, 4, 2]),
    ([1, 4], [0, 3, 5, 2]),
    ([2, 3], [0, 1, 5, 4]),
];

/// Per point of a tetrahedron the three edges that end there.
const EDGES_AT: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 4], [1, 3, 5], [2, 4, 5]];

/// Cuts all edges at their middles, and tetrahedra into four at the corners and four around that
/// diagonal of the octahedron between them that gives the best shapes (S. Zhang, Houston J. Math.
/// 21 (1995) 541-556: the shortest diagonal keeps shapes bounded).
pub(super) fn refined(mesh: &TetMesh) -> Result<TetMesh, MeshError> {
    let edges = mesh.edges();
    let count = mesh.points.len() + edges.len();
    if u32::try_from(count).is_err() || mesh.tets.len() > u32::MAX as usize / 8 {
        return Err(MeshError::TooMany {
            what: "points",
            count,
            allowed: u32::MAX as usize,
        });
    }
    let mut points = mesh.points.clone();
    let middle =
        |&[a, b]: &[u32; 2]| nalgebra::center(&mesh.points[a as usize], &mesh.points[b as usize]);
    points.extend(edges.iter().map(middle));

    let mut tets = Vec::with_capacity(8 * mesh.tets.len());
    for tet in &mesh.tets {
        let middles = EDGES.map(|[i, j]| {
            let edge = sorted(tet[i], tet[j]);
            let place = edges.partition_point(|x| *x < edge);
            debug_assert_eq!(edges.get(place), Some(&edge), "an edge of the mesh");
            (mesh.points.len() + place) as u32
        });
        for (corner, ends) in EDGES_AT.iter().enumerate() {
            let [a, b, c] = ends.map(|edge| middles[edge]);
            tets.push(oriented([tet[corner], a, b, c], &points));
        }
        tets.extend(best_octahedron(middles, &points));
    }
    TetMesh::new(points, tets)
}

fn best_octahedron(middles: [u32; 6], points: &[Point3]) -> [[u32; 4]; 4] {
    let cut = |&([p, q], ring): &([usize; 2], [usize; 4])| {
        [0, 1, 2, 3].map(|i| {
            let [p, q, r, s] = [p, q, ring[i], ring[(i + 1) % 4]].map(|edge| middles[edge]);
            oriented([p, q, r, s], points)
        })
    };
    let worst = |tets: &[[u32; 4]; 4]| {
        let ratios = tets
            .iter()
            .map(|tet| radius_ratio(tet.map(|i| points[i as usize])));
        ratios.fold(f64::INFINITY, f64::min)
    };
    let [first, second, third] = DIAGONALS.each_ref().map(cut);
    let better = |a, b| if worst(&b) > worst(&a) { b } else { a };
    better(better(first, second), third)
}

fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
