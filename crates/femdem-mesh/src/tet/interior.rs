//! The rule for fields: every tetrahedron has a point inside the body.

use super::quality::radius_ratio;
use super::{EDGES, TetMesh};
use crate::Point3;

/// A split of some tetrahedra by one new point.
struct Split {
    point: Point3,
    /// The tetrahedra that are replaced.
    old: Vec<u32>,
    /// Their replacement; the new point has the index that `new_index` returned.
    new: Vec<[u32; 4]>,
}

pub(super) fn with_interior_points(mesh: &TetMesh) -> TetMesh {
    let mut mesh = mesh.clone();
    // Every round cuts at least one tetrahedron and makes none that needs cutting.
    while !mesh.every_tet_has_interior_point() {
        let next = round(&mesh);
        match TetMesh::new(next.points, next.tets) {
            Ok(split) => mesh = split,
            // The parts of a valid tetrahedron are flat only at the limit of the tolerance.
            Err(_) => return mesh,
        }
    }
    mesh
}

struct Round {
    points: Vec<Point3>,
    tets: Vec<[u32; 4]>,
}

/// Splits the tetrahedra without interior point, as far as their splits affect different tetrahedra.
fn round(mesh: &TetMesh) -> Round {
    let inner_edges = InnerEdges::of(mesh);
    let mut gone = vec![false; mesh.tets.len()];
    let mut points = mesh.points.clone();
    let mut added = Vec::new();
    for (i, tet) in mesh.tets.iter().enumerate() {
        if !is_dead(mesh, tet) || gone[i] {
            continue;
        }
        let index = points.len() as u32;
        let edges = EDGES.map(|[a, b]| [tet[a].min(tet[b]), tet[a].max(tet[b])]);
        let splits = edges
            .iter()
            .filter_map(|edge| edge_split(mesh, *edge, inner_edges.ring(*edge), index));
        let mut best: Option<(f64, Split)> = None;
        for split in splits.chain([centroid_split(mesh, i as u32, index)]) {
            let quality = worst(mesh, &split);
            if best.as_ref().is_none_or(|(q, _)| quality > *q) {
                best = Some((quality, split));
            }
        }
        let Some((_, split)) = best else { continue };
        if split.old.iter().any(|&t| gone[t as usize]) {
            continue;
        }
        split.old.iter().for_each(|&t| gone[t as usize] = true);
        points.push(split.point);
        added.extend(split.new);
    }
    let kept = mesh.tets.iter().zip(&gone).filter(|(_, gone)| !**gone);
    let tets = kept.map(|(tet, _)| *tet).chain(added).collect();
    Round { points, tets }
}

fn is_dead(mesh: &TetMesh, tet: &[u32; 4]) -> bool {
    tet.iter().all(|&i| mesh.on_skin[i as usize])
}

/// Edges through the body that join two points of the skin, with the tetrahedra around them.
struct InnerEdges {
    /// Sorted by edge, then tetrahedron.
    owners: Vec<([u32; 2], u32)>,
}

impl InnerEdges {
    fn of(mesh: &TetMesh) -> Self {
        let mut skin: Vec<[u32; 2]> = mesh
            .skin
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        skin.sort_unstable();
        let mut owners: Vec<([u32; 2], u32)> = mesh
            .tets
            .iter()
            .enumerate()
            .flat_map(|(i, tet)| EDGES.map(|[a, b]| (tet[a], tet[b], i as u32)))
            .filter(|&(a, b, _)| mesh.on_skin[a as usize] && mesh.on_skin[b as usize])
            .map(|(a, b, i)| ([a.min(b), a.max(b)], i))
            .filter(|(edge, _)| skin.binary_search(edge).is_err())
            .collect();
        owners.sort_unstable();
        Self { owners }
    }

    fn ring(&self, edge: [u32; 2]) -> &[([u32; 2], u32)] {
        let start = self.owners.partition_point(|(e, _)| *e < edge);
        let end = self.owners.partition_point(|(e, _)| *e <= edge);
        &self.owners[start..end]
    }
}

/// Cuts all tetrahedra around an edge in two at its middle; none if the edge is not inside.
fn edge_split(
    mesh: &TetMesh,
    [a, b]: [u32; 2],
    ring: &[([u32; 2], u32)],
    index: u32,
) -> Option<Split> {
    let old: Vec<u32> = ring.iter().map(|&(_, tet)| tet).collect();
    let halves = |&tet: &u32| [a, b].map(|end| replaced(mesh.tets[tet as usize], end, index));
    (!old.is_empty()).then(|| Split {
        point: nalgebra::center(&mesh.points[a as usize], &mesh.points[b as usize]),
        new: old.iter().flat_map(halves).collect(),
        old,
    })
}

fn centroid_split(mesh: &TetMesh, tet: u32, index: u32) -> Split {
    let corners = mesh.tets[tet as usize];
    let sum = mesh
        .corners(corners)
        .iter()
        .fold(crate::Vector3::zeros(), |s, p| s + p.coords);
    Split {
        point: Point3::from(sum / 4.0),
        old: vec![tet],
        new: corners
            .map(|corner| replaced(corners, corner, index))
            .to_vec(),
    }
}

fn replaced(tet: [u32; 4], old: u32, new: u32) -> [u32; 4] {
    tet.map(|i| if i == old { new } else { i })
}

/// Smallest radius ratio among the new tetrahedra.
fn worst(mesh: &TetMesh, split: &Split) -> f64 {
    let point = |i: u32| mesh.points.get(i as usize).copied().unwrap_or(split.point);
    let ratios = split.new.iter().map(|tet| radius_ratio(tet.map(point)));
    ratios.fold(f64::INFINITY, f64::min)
}
