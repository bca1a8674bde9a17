//! The body-centred cubic lattice and its tetrahedra.

use crate::{Matrix3, Point3, Polyhedron, Vector3};

/// Normals count as parallel or perpendicular within this sine or cosine.
const ALIGNED: f64 = 1e-6;
/// A direction is followed if faces with this part of the area are normal to it.
const DOMINANT: f64 = 0.02;
/// Layers of cells around the body.
const MARGIN: f64 = 1.2;

/// A node, in halves of a cell: all three even (a corner of a cell) or all odd (a centre).
pub(super) type Node = [i32; 3];

/// A lattice of corners and centres of box-shaped cells around a body.
pub(super) struct Lattice {
    axes: Matrix3,
    origin: Point3,
    /// Edges of a cell \[m\].
    cell: Vector3,
    /// Corners along each axis.
    size: [usize; 3],
}

impl Lattice {
    /// A lattice of cells with edges of about `length` \[m\] that contains the body with a margin.
    ///
    /// It follows the directions of the largest flat faces, and cells are stretched a little so that layers of
    /// nodes lie in the outermost faces where these are flat: prismatic bodies are represented exactly, in any
    /// orientation.
    pub(super) fn around(body: &Polyhedron, length: f64) -> Self {
        let axes = dominant_axes(body);
        let extents = extents(body, &axes);
        let mut cell = Vector3::repeat(length);
        let mut low = Vector3::zeros();
        let mut size = [0; 3];
        for (k, (start, end)) in extents.into_iter().enumerate() {
            // Whole cells: an edge between two such faces is then a row of nodes.
            let cells = (end - start) / length;
            let count = if cells < 1.26 * cells.round() {
                cells.round()
            } else {
                cells.ceil()
            };
            cell[k] = ((end - start) / count.max(1.0)).clamp(0.74 * length, 1.26 * length);
            let layers = MARGIN.ceil();
            low[k] = start - layers * cell[k];
            size[k] = ((end - start) / cell[k] + 1e-6).ceil() as usize + 2 * layers as usize + 1;
        }
        Self {
            axes,
            origin: Point3::from(axes * low),
            cell,
            size,
        }
    }

    /// Number of nodes; ids are below it.
    pub(super) fn len(&self) -> usize {
        2 * self.half()
    }

    /// An upper estimate of the number of nodes of a lattice, before it is made.
    pub(super) fn estimate(body: &Polyhedron, length: f64) -> f64 {
        let layers = 2.0 * MARGIN + 2.0;
        let along = |(low, high): (f64, f64)| (high - low) / (0.74 * length) + layers;
        let counts = extents(body, &dominant_axes(body)).map(along);
        2.0 * counts.iter().product::<f64>()
    }

    fn half(&self) -> usize {
        self.size.iter().product()
    }

    /// The id of a node; none outside the lattice.
    pub(super) fn id(&self, node: Node) -> Option<usize> {
        let odd = node[0] & 1;
        let mut id = 0;
        for (&coordinate, &size) in node.iter().zip(&self.size) {
            let index = usize::try_from((coordinate - odd) / 2).ok()?;
            if coordinate < 0 || index >= size {
                return None;
            }
            id = id * size + index;
        }
        Some(id + odd as usize * self.half())
    }

    /// The node of an id.
    pub(super) fn node(&self, id: usize) -> Node {
        let odd = id >= self.half();
        let rest = if odd { id - self.half() } else { id };
        let [_, ny, nz] = self.size;
        [rest / (ny * nz), rest / nz % ny, rest % nz].map(|i| 2 * i as i32 + i32::from(odd))
    }

    /// The place of a node \[m\].
    pub(super) fn position(&self, node: Node) -> Point3 {
        let halves = Vector3::from(node.map(f64::from));
        self.origin + self.axes * (0.5 * self.cell.component_mul(&halves))
    }

    /// Lattice coordinates of a point, in halves of a cell.
    pub(super) fn coordinates(&self, p: &Point3) -> Vector3 {
        2.0 * (self.axes.transpose() * (p - self.origin)).component_div(&self.cell)
    }

    /// Whether two neighbours are of the same kind: joined by an edge of a cell, not by half a
    /// diagonal.
    pub(super) fn is_long(&self, a: usize, b: usize) -> bool {
        (a < self.half()) == (b < self.half())
    }

    /// The up to 14 nodes joined to one by edges.
    pub(super) fn neighbours(&self, id: usize) -> impl Iterator<Item = usize> + '_ {
        let node = self.node(id);
        let steps = (0..14).map(|i| match i {
            0..8 => [0, 1, 2].map(|k| 2 * (i >> k & 1) - 1),
            _ => [0, 1, 2].map(|k| if (i - 8) / 2 == k { 4 * (i & 1) - 2 } else { 0 }),
        });
        steps.filter_map(move |step| self.id([0, 1, 2].map(|k| node[k] + step[k])))
    }

    /// All tetrahedra: an edge of a cell between two corners, and an edge of the dual cells that
    /// goes around it.
    pub(super) fn tets(&self) -> impl Iterator<Item = [usize; 4]> + '_ {
        (0..self.half()).flat_map(move |id| {
            let corner = self.node(id);
            (0..12).filter_map(move |i| {
                let (axis, turn) = (i / 4, i % 4);
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let around = |turn: usize| {
                    let mut node = corner;
                    node[axis] += 1;
                    node[u] += [1, -1, -1, 1][turn % 4];
                    node[v] += [1, 1, -1, -1][turn % 4];
                    self.id(node)
                };
                let mut end = corner;
                end[axis] += 2;
                Some([id, self.id(end)?, around(turn)?, around(turn + 1)?])
            })
        })
    }
}

/// Where a body begins and ends along each axis \[m\].
fn extents(body: &Polyhedron, axes: &Matrix3) -> [(f64, f64); 3] {
    [0, 1, 2].map(|k| {
        let along = body
            .vertices()
            .iter()
            .map(|v| axes.column(k).dot(&v.coords));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    })
}

/// Three perpendicular directions normal to the largest flat faces; where faces are small, the coordinate axes.
fn dominant_axes(body: &Polyhedron) -> Matrix3 {
    let mut directions: Vec<(Vector3, f64)> = Vec::new();
    let vertices = body.vertices();
    for (i, face) in body.faces().enumerate().take(2000) {
        let normal = body.face_normal(i);
        let area = crate::polyhedron::Plane::through(vertices, face).area;
        match directions
            .iter_mut()
            .find(|(n, _)| n.cross(&normal).norm() < ALIGNED)
        {
            Some((_, sum)) => *sum += area,
            None => directions.push((normal, area)),
        }
    }
    let largest = |allowed: &dyn Fn(&Vector3) -> bool| {
        let candidates = directions.iter().filter(|(n, _)| allowed(n));
        candidates
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, area)| *area > DOMINANT * body.area())
            .map(|(n, _)| *n)
    };
    let Some(first) = largest(&|_| true) else {
        return Matrix3::identity();
    };
    let second = largest(&|n| n.dot(&first).abs() < ALIGNED).unwrap_or_else(|| {
        let mut other = Vector3::zeros();
        other[first.iamin()] = 1.0;
        other
    });
    let second = (second - first * first.dot(&second)).normalize();
    Matrix3::from_columns(&[first, second, first.cross(&second)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{CatalogueShape, Solid};
    use crate::tet::{EDGES, six_volumes};

    #[test]
    fn tetrahedra_tile_the_cells() {
        let body = CatalogueShape::from(Solid::P5).polyhedron(1.0).unwrap();
        let lattice = Lattice::around(&body, 0.2);
        for id in 0..lattice.len() {
            assert_eq!(lattice.id(lattice.node(id)), Some(id));
        }
        // Around an inner corner there are 24 tetrahedra, all alike, joined along lattice edges; the lattice
        // has 12 for each cell.
        let middle = lattice.size.map(|n| n as i32 / 2 * 2);
        let center = lattice.id(middle).unwrap();
        let around: Vec<[usize; 4]> = lattice.tets().filter(|t| t.contains(&center)).collect();
        assert_eq!(around.len(), 24);
        for tet in &around {
            let corners = tet.map(|id| lattice.position(lattice.node(id)));
            let volume = six_volumes(corners) / 6.0;
            assert!((volume / lattice.cell.product() * 12.0 - 1.0).abs() < 1e-12);
            for [i, j] in EDGES {
                assert!(lattice.neighbours(tet[i]).any(|id| id == tet[j]));
                let length = (corners[i] - corners[j]).norm() / lattice.cell.x;
                let expected = if lattice.is_long(tet[i], tet[j]) {
                    1.0
                } else {
                    0.75_f64.sqrt()
                };
                assert!((length - expected).abs() < 1e-12);
            }
        }
        assert_eq!(lattice.neighbours(center).count(), 14);
    }
}
