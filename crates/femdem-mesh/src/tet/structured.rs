//! Structured meshes of simple bodies.

use super::{TetMesh, oriented};
use crate::{MeshError, Point3, Vector3};

/// Most points and tetrahedra of a mesh; about 1 GB.
const MOST: u64 = 20_000_000;

/// The six paths along the edges of a cell from its first corner to the opposite one, as the two
/// corners between; bit i of a corner is its place along axis i.
const PATHS: [[u32; 2]; 6] = [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]];

/// Six tetrahedra about the diagonal of each cell, mirrored from cell to cell (the triangulation J1
/// of M. J. Todd, The Computation of Fixed Points and Applications, 1976): the mesh has the mirror
/// planes of the block if the numbers of cells are even.
pub(super) fn block(cells: [u32; 3], size: &Vector3) -> Result<TetMesh, MeshError> {
    for (axis, &length) in size.iter().enumerate() {
        let what = ["length along x", "length along y", "length along z"][axis];
        positive(what, length)?;
        at_least_one("number of cells along an axis", cells[axis])?;
    }
    let along = cells.map(|n| u64::from(n) + 1);
    let points = checked_product(&along)?;
    checked_product(&[6, cells[0].into(), cells[1].into(), cells[2].into()])?;

    let place = |at: [u32; 3]| {
        Point3::from(std::array::from_fn::<f64, 3, _>(|i| {
            size[i] * f64::from(at[i]) / f64::from(cells[i])
        }))
    };
    let [nx, ny, nz] = cells;
    let index = |at: [u32; 3]| at[0] + (nx + 1) * (at[1] + (ny + 1) * at[2]);
    let mut nodes = Vec::with_capacity(points);
    for k in 0..=nz {
        for j in 0..=ny {
            nodes.extend((0..=nx).map(|i| place([i, j, k])));
        }
    }
    let mut tets = Vec::new();
    for (i, j, k) in
        (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (i, j, k))))
    {
        let corner = |bits: u32| {
            let mirrored = [i, j, k].map(|c| c & 1);
            let step = |axis: usize| (bits >> axis & 1) ^ mirrored[axis];
            index([i + step(0), j + step(1), k + step(2)])
        };
        for [a, b] in PATHS {
            tets.push(oriented([0, a, b, 7].map(corner), &nodes));
        }
    }
    TetMesh::new(nodes, tets)
}

/// The eighth of a hollow sphere in x, y, z >= 0: layers of triangular prisms, three tetrahedra
/// each. The diagonals of shared sides run from the lower to the higher direction on both sides.
pub(super) fn shell_octant(
    inner: f64,
    outer: f64,
    around: u32,
    through: u32,
) -> Result<TetMesh, MeshError> {
    positive("inner radius", inner)?;
    positive("outer radius", outer)?;
    positive("outer radius less the inner", outer - inner)?;
    at_least_one("number of cells around", around)?;
    at_least_one("number of cells through", through)?;
    let (n, layers) = (u64::from(around), u64::from(through));
    let on_sphere = checked_product(&[(n + 1), (n + 2)])? / 2;
    checked_product(&[3, n, n, layers])?;
    checked_product(&[on_sphere as u64, layers + 1])?;

    // Directions i + j <= around on the triangle between the axes, row by row.
    let row = |i: u32| i * (2 * around + 3 - i) / 2;
    let mut directions = Vec::with_capacity(on_sphere);
    for i in 0..=around {
        for j in 0..=around - i {
            directions.push(direction([i, j, around - i - j], around));
        }
    }
    let mut nodes = Vec::with_capacity(on_sphere * (through as usize + 1));
    for layer in 0..=through {
        let radius = inner + (outer - inner) * f64::from(layer) / f64::from(through);
        nodes.extend(directions.iter().map(|d| Point3::from(d * radius)));
    }
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..around - i {
            let [here, right, up] = [row(i) + j, row(i) + j + 1, row(i + 1) + j];
            triangles.push([here, right, up]);
            if i + j + 1 < around {
                triangles.push([right, up, up + 1]);
            }
        }
    }
    let count = on_sphere as u32;
    let mut tets = Vec::new();
    for layer in 0..through {
        for &[a, b, c] in &triangles {
            let [a, b, c] = [a, b, c].map(|v| v + layer * count);
            let [d, e, f] = [a, b, c].map(|v| v + count);
            for tet in [[a, b, c, f], [a, b, e, f], [a, d, e, f]] {
                tets.push(oriented(tet, &nodes));
            }
        }
    }
    TetMesh::new(nodes, tets)
}

/// A unit vector; equal steps are equal angles along the edges of the octant.
fn direction(steps: [u32; 3], around: u32) -> Vector3 {
    let quarter = std::f64::consts::FRAC_PI_2 / f64::from(around);
    let sines = steps.map(|s| {
        // Exact at both ends, so that the faces of the octant are planes.
        if s == 0 {
            0.0
        } else {
            (quarter * f64::from(s)).sin()
        }
    });
    Vector3::from(sines).normalize()
}

fn positive(what: &'static str, value: f64) -> Result<(), MeshError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(MeshError::OutOfRange {
        what,
        value,
        allowed: "finite numbers above 0, in m",
    })
}

fn at_least_one(what: &'static str, value: u32) -> Result<(), MeshError> {
    if value >= 1 {
        return Ok(());
    }
    Err(MeshError::OutOfRange {
        what,
        value: f64::from(value),
        allowed: "1 and more",
    })
}

/// The product, if it is at most [`MOST`].
fn checked_product(factors: &[u64]) -> Result<usize, MeshError> {
    let product = factors.iter().fold(1_u64, |p, &f| p.saturating_mul(f));
    if product <= MOST {
        return Ok(product as usize);
    }
    Err(MeshError::TooMany {
        what: "points or tetrahedra",
        count: usize::try_from(product).unwrap_or(usize::MAX),
        allowed: MOST as usize,
    })
}
