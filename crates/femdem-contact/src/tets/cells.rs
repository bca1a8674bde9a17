//! The tetrahedra of a rigid solid, in the axes of its body.

use super::clip::NOISE;
use super::current::Current;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::tet::FACES;
use femdem_mesh::{Point3, TetMesh, Vector3, closest_point};

/// "No tetrahedron": the face lies on the skin.
pub(crate) const NONE: u32 = u32::MAX;

/// A tetrahedron and those beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    pub tet: Current,
    /// Tetrahedra across the faces opposite corners 0 to 3, or [`NONE`].
    pub neighbours: [u32; 4],
    /// For face k on the skin, the tetrahedra behind the skin's next triangles: across its edge on face l.
    pub beside: [[u32; 4]; 4],
}

/// A node inside a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inner {
    pub at: Vector3,
    /// Integral of the node's value times its shape function over the solid, m^3.
    pub field: f64,
    /// Volume of the tetrahedra in which its value is the largest, m^3.
    pub volume: f64,
}

/// The tetrahedra of one solid, with a tree over them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cells {
    pub list: Vec<Cell>,
    pub boxes: Vec<Aabb>,
    pub tree: Bvh,
    /// Nodes where the field is above 0, with a tree over them.
    pub inner: Vec<Inner>,
    pub inner_tree: Bvh,
    /// Largest distance of a corner from the origin, m.
    pub radius: f64,
}

impl Cell {
    /// The field at a point in body axes.
    pub fn field(&self, x: &Vector3) -> f64 {
        self.tet.values[0] + self.tet.gradient.dot(&(x - self.tet.corners[0]))
    }

    /// Whether a point lies in the tetrahedron. One on a face between two lies in both, whatever round-off says.
    pub fn holds(&self, x: &Vector3) -> bool {
        self.tet.gap(x, NOISE) == 0.0
    }
}

impl Cells {
    /// The tetrahedra of a mesh about `origin` with the nodal values of a field.
    pub fn new(mesh: &TetMesh, origin: &Vector3, values: &[f64]) -> Self {
        let at = |i: u32| mesh.points()[i as usize].coords - origin;
        let mut list = Vec::with_capacity(mesh.tets().len());
        for (t, nodes) in mesh.tets().iter().enumerate() {
            let next = mesh.neighbours()[t];
            let skin = (0..4).filter(|k| next[*k].is_none());
            let mut tet = Current::default();
            let values = nodes.map(|i| values[i as usize]);
            // Where the origin is so far away that no volume is left, nothing touches.
            let _ = tet.deform(nodes.map(at), &values, 1.0, skin.fold(0, |s, k| s | 1 << k));
            list.push(Cell {
                tet,
                neighbours: next.map(|n| n.unwrap_or(NONE)),
                beside: beside(mesh, t as u32),
            });
        }
        let mut inner: Vec<Inner> = values
            .iter()
            .zip(0..)
            .map(|(_, i)| Inner {
                at: at(i),
                field: 0.0,
                volume: 0.0,
            })
            .collect();
        for (nodes, cell) in mesh.tets().iter().zip(&list) {
            for (&node, value) in nodes.iter().zip(cell.tet.values) {
                inner[node as usize].field += value * cell.tet.six_volumes / 24.0;
            }
            inner[nodes[cell.tet.pole()] as usize].volume += cell.tet.six_volumes / 6.0;
        }
        inner.retain(|node| node.field > 0.0);
        let points: Vec<Aabb> = inner
            .iter()
            .map(|node| Aabb::of_points([node.at.into()]))
            .collect();
        let boxes: Vec<Aabb> = list
            .iter()
            .map(|cell| Aabb::of_points(cell.tet.corners.map(Point3::from)))
            .collect();
        let corners = list.iter().flat_map(|cell| &cell.tet.corners);
        Self {
            radius: corners.fold(0.0, |r, x| x.norm().max(r)),
            tree: Bvh::new(&boxes),
            boxes,
            inner_tree: Bvh::new(&points),
            inner,
            list,
        }
    }

    /// Distance of a point from the solid, m: 0 inside.
    pub fn distance(&self, x: &Vector3) -> f64 {
        let point = Point3::from(*x);
        let square = |i: u32| {
            let cell = &self.list[i as usize];
            if cell.holds(x) {
                return 0.0;
            }
            let skin = (0..4).filter(|k| cell.neighbours[*k] == NONE);
            let squares = skin.map(|k| {
                let triangle = FACES[k].map(|corner| cell.tet.corners[corner].into());
                (closest_point(&triangle, &point) - point).norm_squared()
            });
            squares.fold(f64::INFINITY, f64::min)
        };
        let nearest = self.tree.nearest(&point, square);
        nearest.map_or(f64::INFINITY, |(_, square)| square.sqrt())
    }
}

/// The tetrahedra behind the next triangles of the skin, by face on the skin and by other face at the edge.
fn beside(mesh: &TetMesh, tet: u32) -> [[u32; 4]; 4] {
    let faces = [0, 1, 2, 3];
    let on_skin = mesh.neighbours()[tet as usize].map(|next| next.is_none());
    faces.map(|face| {
        faces.map(|other| match on_skin[face] && other != face {
            true => around(mesh, tet, face, other),
            false => NONE,
        })
    })
}

/// Turns from face `from` of a tetrahedron about its edge on face `to`, through all the tetrahedra at that edge, to the
/// one that has the next face on the skin.
fn around(mesh: &TetMesh, tet: u32, from: usize, to: usize) -> u32 {
    let (mut at, mut from, mut to) = (tet, from, to);
    // No more than all of them.
    for _ in mesh.tets() {
        let Some(next) = mesh.neighbours()[at as usize][to] else {
            break;
        };
        let (left, entered) = (mesh.tets()[at as usize], mesh.tets()[next as usize]);
        // The corner across the face that is left behind lies on the face ahead, and the other way round.
        let ahead = entered.iter().position(|node| *node == left[from]);
        let behind = entered.iter().position(|node| !left.contains(node));
        let (Some(ahead), Some(behind)) = (ahead, behind) else {
            break;
        };
        (at, from, to) = (next, behind, ahead);
    }
    at
}
