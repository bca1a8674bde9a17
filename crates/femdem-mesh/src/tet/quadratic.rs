//! Tetrahedra of ten nodes.

use super::TetMesh;
use crate::{MeshError, Point3};

/// The corners at the ends of the six mid-edge nodes of a ten-node tetrahedron, which are its nodes
/// 4 to 9: the order of VTK.
pub const MID_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// A tetrahedral mesh with a node in the middle of every edge: ten nodes per tetrahedron.
///
/// Nodes are the points of the mesh, then the middles of its edges.
///
/// ```
/// use femdem_mesh::tet::QuadraticMesh;
/// use femdem_mesh::{TetMesh, Vector3};
///
/// let linear = TetMesh::block([1, 1, 1], &Vector3::repeat(1.0))?;
/// let quadratic = QuadraticMesh::new(&linear)?;
/// // Corners first, then one node in the middle of each edge.
/// let corners = linear.points().len();
/// assert_eq!(quadratic.nodes().len(), corners + quadratic.mid_edges().len());
/// assert!(quadratic.elements().iter().all(|e| e[4..].iter().all(|&n| n as usize >= corners)));
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct QuadraticMesh {
    mesh: TetMesh,
    edges: Vec<[u32; 2]>,
    elements: Vec<[u32; 10]>,
}

impl QuadraticMesh {
    /// Puts a node on the middle of each edge of `mesh`.
    ///
    /// # Errors
    ///
    /// If there would be more nodes than 32-bit indices can name.
    pub fn new(mesh: &TetMesh) -> Result<Self, MeshError> {
        let edges = mesh.edges();
        let corners = mesh.points.len();
        let count = corners + edges.len();
        if u32::try_from(count).is_err() {
            return Err(MeshError::TooMany {
                what: "nodes",
                count,
                allowed: u32::MAX as usize,
            });
        }
        let elements = mesh
            .tets
            .iter()
            .map(|tet| {
                std::array::from_fn(|k| match k {
                    0..4 => tet[k],
                    _ => (corners + place_of(&edges, MID_EDGES[k - 4].map(|i| tet[i]))) as u32,
                })
            })
            .collect();
        Ok(Self {
            mesh: mesh.clone(),
            edges,
            elements,
        })
    }

    /// The mesh of the corners.
    pub fn corners(&self) -> &TetMesh {
        &self.mesh
    }

    /// The ends of the edge that node `points + k` is the middle of, sorted.
    pub fn mid_edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The ten nodes of each tetrahedron: its corners, then the middles of its edges in the order
    /// of [`MID_EDGES`].
    pub fn elements(&self) -> &[[u32; 10]] {
        &self.elements
    }

    /// Places of all nodes \[m\].
    pub fn nodes(&self) -> Vec<Point3> {
        let points = &self.mesh.points;
        let middle =
            |[a, b]: &[u32; 2]| nalgebra::center(&points[*a as usize], &points[*b as usize]);
        let mut nodes = points.clone();
        nodes.extend(self.edges.iter().map(middle));
        nodes
    }

    /// The skin as triangles of six nodes: three corners, counter-clockwise seen from outside, then
    /// the middles of the sides from corner 0 to 1, 1 to 2 and 2 to 0. In the order of
    /// [`TetMesh::skin`].
    pub fn skin(&self) -> Vec<[u32; 6]> {
        let corners = self.mesh.points.len();
        let middle = |a, b| (corners + place_of(&self.edges, [a, b])) as u32;
        self.mesh
            .skin
            .iter()
            .map(|&[a, b, c]| [a, b, c, middle(a, b), middle(b, c), middle(c, a)])
            .collect()
    }
}

/// Position of an edge of the mesh in the sorted list.
fn place_of(edges: &[[u32; 2]], [a, b]: [u32; 2]) -> usize {
    let edge = [a.min(b), a.max(b)];
    let place = edges.partition_point(|x| *x < edge);
    debug_assert_eq!(edges.get(place), Some(&edge), "an edge of the mesh");
    place
}

impl TetMesh {
    /// The edges, each once as its two points in ascending order, sorted.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let ends =
            |tet: &[u32; 4]| MID_EDGES.map(|[i, j]| [tet[i].min(tet[j]), tet[i].max(tet[j])]);
        let mut edges: Vec<[u32; 2]> = self.tets.iter().flat_map(ends).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// The tetrahedron that owns each triangle of [`TetMesh::skin`].
    pub fn skin_owners(&self) -> Vec<u32> {
        let open = |across: &[Option<u32>; 4]| across.iter().filter(|n| n.is_none()).count();
        let mut owners = Vec::with_capacity(self.skin.len());
        for (tet, across) in self.neighbours.iter().enumerate() {
            owners.extend(std::iter::repeat_n(tet as u32, open(across)));
        }
        owners
    }
}
