//! Structured tetrahedral meshes of bodies that are not convex.

use femdem_mesh::nalgebra::Point3;
use femdem_mesh::{TetMesh, Vector3};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

type Node = [i32; 3];

/// The six tetrahedra of every cell of an integer grid; `place` gives the position and may identify several
/// nodes.
fn of_cells(
    cells: impl IntoIterator<Item = Node>,
    name: impl Fn(Node) -> Node,
    place: impl Fn(Node) -> Vector3,
) -> TetMesh {
    const PATHS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ];
    let mut points: Vec<Vector3> = Vec::new();
    let mut known: BTreeMap<Node, u32> = BTreeMap::new();
    let mut tets = Vec::new();
    for cell in cells {
        for path in PATHS {
            let mut node = cell;
            let mut corners = [0; 4];
            for c in 0..4 {
                let key = name(node);
                corners[c] = *known.entry(key).or_insert_with(|| {
                    points.push(place(key));
                    points.len() as u32 - 1
                });
                if c < 3 {
                    node[path[c]] += 1;
                }
            }
            let [a, b, c, d] = corners.map(|i| points[i as usize]);
            let distinct = (0..4).all(|m| !corners[m + 1..].contains(&corners[m]));
            if distinct {
                if (b - a).dot(&(c - a).cross(&(d - a))) < 0.0 {
                    corners.swap(1, 2);
                }
                tets.push(corners);
            }
        }
    }
    TetMesh::new(points.into_iter().map(Point3::from).collect(), tets).unwrap()
}

/// Boxes between the given coordinates, for the cells that are listed.
pub fn boxes(cells: &[Node], x: &[f64], y: &[f64], z: &[f64]) -> TetMesh {
    let at = |list: &[f64], i: i32| list[i as usize];
    of_cells(
        cells.iter().copied(),
        |n| n,
        |[i, j, k]| Vector3::new(at(x, i), at(y, j), at(z, k)),
    )
}

/// A full block of `n` cells a side between two corners.
pub fn block(low: Vector3, high: Vector3, n: i32) -> TetMesh {
    let cells = (0..n.pow(3)).map(|i| [i % n, i / n % n, i / (n * n)]);
    let side = high - low;
    of_cells(
        cells,
        |c| c,
        |c| low + side.component_mul(&Vector3::from(c.map(|i| f64::from(i) / f64::from(n)))),
    )
}

/// A dolos of square bars, `a` thick and 3 `a` long: a stem along z between a bar along x and
/// one along y.
pub fn dolos(a: f64) -> TetMesh {
    let cubes: [Node; 7] = [
        [0, 0, 0],
        [-1, 0, 1],
        [0, 0, 1],
        [1, 0, 1],
        [0, -1, -1],
        [0, 0, -1],
        [0, 1, -1],
    ];
    let halves = cubes.into_iter().flat_map(|c| {
        (0..8).map(move |i| [2 * c[0] + i % 2, 2 * c[1] + i / 2 % 2, 2 * c[2] + i / 4])
    });
    of_cells(
        halves,
        |n| n,
        |n| Vector3::from(n.map(|i| 0.5 * a * f64::from(i - 1))),
    )
}

/// A cylinder with a hole along z, two cells thick and high.
pub fn pellet(inner: f64, outer: f64, height: f64, sides: i32) -> TetMesh {
    let cells = (0..sides).flat_map(|k| (0..4).map(move |i| [i % 2, k, i / 2]));
    of_cells(
        cells,
        |[i, k, j]| [i, k % sides, j],
        |[i, k, j]| {
            let r = inner + 0.5 * (outer - inner) * f64::from(i);
            let (sin, cos) = (TAU * f64::from(k) / f64::from(sides)).sin_cos();
            Vector3::new(r * cos, r * sin, height * (0.5 * f64::from(j) - 0.5))
        },
    )
}

/// A ring in the plane across z: a bar with `sides` sides and inscribed in a circle of radius
/// `bar`, bent to a polygon of `pieces` corners at `radius`.
pub fn ring(radius: f64, bar: f64, pieces: i32, sides: i32) -> TetMesh {
    let cells = (0..pieces).flat_map(|k| (0..sides).map(move |s| [0, k, s]));
    of_cells(
        cells,
        // The inner nodes of a cross-section are its centre.
        |[i, k, s]| [i, k % pieces, if i == 0 { 0 } else { s % sides }],
        |[i, k, s]| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(pieces)).sin_cos();
            let (up, out) = (TAU * f64::from(s) / f64::from(sides)).sin_cos();
            let r = radius + bar * f64::from(i) * out;
            Vector3::new(r * cos, r * sin, bar * f64::from(i) * up)
        },
    )
}
