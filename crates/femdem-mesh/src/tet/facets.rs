//! The inner triangles of a tetrahedral mesh.

use super::{FACES, TetMesh};

/// An inner triangle of a mesh, with a tetrahedron on either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Its points, counter-clockwise seen from the second tetrahedron: its normal points from the first to the second.
    pub points: [u32; 3],
    /// The tetrahedra beside it, the lower number first.
    pub tets: [u32; 2],
}

/// The inner triangles of a mesh, numbered in the order of their first tetrahedra and of these' [`FACES`].
///
/// ```
/// use femdem_mesh::tet::Facets;
/// use femdem_mesh::{TetMesh, Vector3};
///
/// // A cube of six tetrahedra about a diagonal has six triangles inside.
/// let cube = TetMesh::block([1, 1, 1], &Vector3::repeat(1.0))?;
/// assert_eq!(Facets::new(&cube).all().len(), 6);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Facets {
    all: Vec<Facet>,
    of_tets: Vec<[Option<u32>; 4]>,
}

impl Facets {
    /// The facets of a mesh.
    #[must_use]
    pub fn new(mesh: &TetMesh) -> Self {
        Self::between(mesh.tets(), mesh.neighbours())
    }

    /// Those of tetrahedra with their neighbours.
    pub(super) fn between(tets: &[[u32; 4]], neighbours_of: &[[Option<u32>; 4]]) -> Self {
        let mut all = Vec::new();
        let mut of_tets = vec![[None; 4]; tets.len()];
        let both = tets.iter().zip(neighbours_of);
        for (t, (corners, neighbours)) in both.enumerate() {
            for (f, neighbour) in neighbours.iter().enumerate() {
                let Some(other) = neighbour.filter(|&other| other as usize > t) else {
                    continue;
                };
                let number = all.len() as u32;
                all.push(Facet {
                    points: FACES[f].map(|i| corners[i]),
                    tets: [t as u32, other],
                });
                of_tets[t][f] = Some(number);
                let back = neighbours_of[other as usize];
                if let Some(g) = back.iter().position(|&n| n == Some(t as u32)) {
                    of_tets[other as usize][g] = Some(number);
                }
            }
        }
        Self { all, of_tets }
    }

    /// All facets.
    #[must_use]
    pub fn all(&self) -> &[Facet] {
        &self.all
    }

    /// For each tetrahedron the numbers of the facets opposite its points; `None` on the skin.
    #[must_use]
    pub fn of_tets(&self) -> &[[Option<u32>; 4]] {
        &self.of_tets
    }
}
