//! Tetrahedra prepared for the general kernel.

use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::tet::FACES;
use femdem_mesh::{Point3, TetMesh, Vector3};

/// "No tetrahedron": the face lies on the skin.
pub(crate) const NONE: u32 = u32::MAX;

/// A tetrahedron with an affine field, in the axes of its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    pub corners: [Vector3; 4],
    /// Outward unit normals of the faces opposite corners 0 to 3.
    pub normals: [Vector3; 4],
    /// Gradient of the field, 1/m, and its value at corner 0.
    pub gradient: Vector3,
    pub level: f64,
    /// Tetrahedra across the faces, or [`NONE`].
    pub neighbours: [u32; 4],
}

impl Cell {
    pub fn new(corners: [Vector3; 4], values: [f64; 4], neighbours: [u32; 4]) -> Self {
        let area = |f: [usize; 3]| {
            let [x, y, z] = f.map(|i| corners[i]);
            (y - x).cross(&(z - x))
        };
        let areas = FACES.map(area);
        let six_volumes = (corners[1] - corners[0])
            .cross(&(corners[2] - corners[0]))
            .dot(&(corners[3] - corners[0]));
        // grad lambda_k = -(area vector of the face opposite k) / (3 volume). The gradients add up to zero,
        // so only differences of values enter.
        let gradient = (1..4)
            .map(|k| areas[k] * ((values[0] - values[k]) / six_volumes))
            .sum();
        Self {
            corners,
            normals: areas.map(|a| a.normalize()),
            gradient,
            level: values[0],
            neighbours,
        }
    }

    /// The field at a point in body axes.
    pub fn field(&self, x: &Vector3) -> f64 {
        self.level + self.gradient.dot(&(x - self.corners[0]))
    }

    /// Whether a point lies in the tetrahedron.
    pub fn holds(&self, x: &Vector3) -> bool {
        (0..4).all(|k| self.normals[k].dot(&(x - self.corners[(k + 1) % 4])) <= 0.0)
    }

    pub fn aabb(&self) -> Aabb {
        Aabb::of_points(self.corners.map(Point3::from))
    }
}

/// The tetrahedra of one solid, with a tree over them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cells {
    pub list: Vec<Cell>,
    pub boxes: Vec<Aabb>,
    pub tree: Bvh,
    /// Largest distance of a corner from the origin, m.
    pub radius: f64,
}

impl Cells {
    /// The tetrahedra of a mesh about `origin` with the nodal values of a field.
    pub fn new(mesh: &TetMesh, origin: &Vector3, values: &[f64]) -> Self {
        let cell = |(tet, next): (&[u32; 4], &[Option<u32>; 4])| {
            Cell::new(
                tet.map(|i| mesh.points()[i as usize].coords - origin),
                tet.map(|i| values[i as usize]),
                next.map(|n| n.unwrap_or(NONE)),
            )
        };
        Self::of(
            mesh.tets()
                .iter()
                .zip(mesh.neighbours())
                .map(cell)
                .collect(),
        )
    }

    fn of(list: Vec<Cell>) -> Self {
        let boxes: Vec<Aabb> = list.iter().map(Cell::aabb).collect();
        let corners = list.iter().flat_map(|c| &c.corners);
        Self {
            radius: corners.fold(0.0, |r, x| x.norm().max(r)),
            tree: Bvh::new(&boxes),
            boxes,
            list,
        }
    }
}
