//! A mesh along whose facets cracks run: which tetrahedra share nodes.

use super::{FACES, Facets, TetMesh, topology};
use crate::{MeshError, Point3};
use serde::{Deserialize, Serialize};

/// A node that a crack has split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// The node that was there; it stays with the tetrahedra around it that hold the lowest number.
    pub node: u32,
    /// The new node, of other tetrahedra, at the same place.
    pub new: u32,
}

/// The tetrahedra of a mesh and its nodes, where some of the facets are cut. The tetrahedra never change; a node is split
/// where cut facets separate the tetrahedra around it.
///
/// Where the tetrahedra around each point of the mesh are joined by facets, as in all but pinched meshes, two of them share a node
/// exactly if facets that contain it, and are not cut, lead from one to the other around it. So
/// what is shared depends on the set of cut facets alone, not on their order, and a split changes neither volumes nor masses
/// summed over tetrahedra. A cut facet whose nodes all hold together around its rim has no effect yet.
///
/// ```
/// use femdem_mesh::tet::CrackedMesh;
/// use femdem_mesh::{TetMesh, Vector3};
///
/// // A bar of two cubes breaks in the middle.
/// let bar = TetMesh::block([2, 1, 1], &Vector3::new(2.0, 1.0, 1.0))?;
/// let mut cracked = CrackedMesh::new(&bar);
/// let middle = |i: u32| bar.points()[i as usize].x == 1.0;
/// let facets = cracked.facets().all().iter().zip(0..);
/// let plane: Vec<u32> = facets.filter(|(f, _)| f.points.into_iter().all(middle)).map(|(_, i)| i).collect();
/// assert_eq!(cracked.cut(&plane)?.len(), 4);
/// assert_eq!(cracked.parts().iter().max(), Some(&1));
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
///
/// Serialised outright: the numbers of the nodes depend on the order of the cuts.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Stored", into = "Stored")]
pub struct CrackedMesh {
    facets: Facets,
    is_cut: Vec<bool>,
    tets: Vec<[u32; 4]>,
    /// Points of the mesh by node.
    points: Vec<u32>,
    /// Tetrahedra of each node, ascending.
    around: Vec<Vec<u32>>,
}

/// Its stored form.
#[derive(Serialize, Deserialize)]
#[serde(rename = "CrackedMesh", deny_unknown_fields)]
struct Stored {
    is_cut: Vec<bool>,
    tets: Vec<[u32; 4]>,
    points: Vec<u32>,
}

impl From<CrackedMesh> for Stored {
    fn from(mesh: CrackedMesh) -> Self {
        Self {
            is_cut: mesh.is_cut,
            tets: mesh.tets,
            points: mesh.points,
        }
    }
}

impl TryFrom<Stored> for CrackedMesh {
    type Error = MeshError;

    fn try_from(stored: Stored) -> Result<Self, MeshError> {
        let Stored {
            is_cut,
            tets,
            points,
        } = stored;
        Self::of(tets, points, is_cut)
    }
}

/// The tetrahedra of each node, ascending.
fn around(nodes: usize, tets: &[[u32; 4]]) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); nodes];
    for (corners, t) in tets.iter().zip(0..) {
        for &node in corners {
            around[node as usize].push(t);
        }
    }
    around
}

impl CrackedMesh {
    /// Tetrahedra with their nodes, by node the points of the mesh without cracks, and which facets are cut.
    pub(super) fn of(
        tets: Vec<[u32; 4]>,
        points: Vec<u32>,
        is_cut: Vec<bool>,
    ) -> Result<Self, MeshError> {
        topology::check_indices(points.len(), &tets)?;
        // Without its cracks: nodes are the points again.
        let whole = tets.iter().map(|tet| tet.map(|node| points[node as usize]));
        let whole: Vec<[u32; 4]> = whole.collect();
        let count = points.iter().max().map_or(0, |most| *most as usize + 1);
        topology::check_indices(count, &whole)?;
        let (neighbours, _) = topology::connect(&whole)?;
        let facets = Facets::between(&whole, &neighbours);
        if facets.all().len() != is_cut.len() {
            return Err(MeshError::OutOfRange {
                what: "number of marks of cut facets",
                value: is_cut.len() as f64,
                allowed: "the number of inner facets of the mesh",
            });
        }
        Ok(Self {
            around: around(points.len(), &tets),
            facets,
            is_cut,
            tets,
            points,
        })
    }

    /// A mesh without cracks: its nodes are its points.
    #[must_use]
    pub fn new(mesh: &TetMesh) -> Self {
        let facets = Facets::new(mesh);
        Self {
            is_cut: vec![false; facets.all().len()],
            facets,
            tets: mesh.tets().to_vec(),
            points: (0..mesh.points().len() as u32).collect(),
            around: around(mesh.points().len(), mesh.tets()),
        }
    }

    /// The inner facets of the mesh.
    #[must_use]
    pub fn facets(&self) -> &Facets {
        &self.facets
    }

    /// Which facets are cut.
    #[must_use]
    pub fn is_cut(&self) -> &[bool] {
        &self.is_cut
    }

    /// Nodes of the tetrahedra.
    #[must_use]
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// For each node the point of the mesh that it was at first.
    #[must_use]
    pub fn points(&self) -> &[u32] {
        &self.points
    }

    /// The tetrahedra around a node, ascending; none for a node that does not exist.
    #[must_use]
    pub fn around(&self, node: u32) -> &[u32] {
        self.around.get(node as usize).map_or(&[], Vec::as_slice)
    }

    /// Cuts facets, and splits the nodes that they no longer hold together: nodes in ascending order, and the parts of each in
    /// the order of their lowest tetrahedra. Facets that are cut already, or given twice, change nothing.
    ///
    /// # Errors
    ///
    /// [`MeshError::OutOfRange`] for a number that is no facet; nothing is cut then.
    pub fn cut(&mut self, facets: &[u32]) -> Result<Vec<Split>, MeshError> {
        let count = self.is_cut.len();
        if let Some(&beyond) = facets.iter().find(|&&facet| facet as usize >= count) {
            return Err(MeshError::OutOfRange {
                what: "number of a facet",
                value: f64::from(beyond),
                allowed: "below the number of inner facets of the mesh",
            });
        }
        let mut nodes = Vec::new();
        for &facet in facets {
            self.is_cut[facet as usize] = true;
            nodes.extend(self.sides(facet).into_iter().flatten().flatten());
        }
        nodes.sort_unstable();
        nodes.dedup();
        let mut splits = Vec::new();
        for node in nodes {
            self.split(node, &mut splits);
        }
        Ok(splits)
    }

    /// Nodes of a facet in the first and in the second of its tetrahedra, in the order of its points; `None` for a number that is
    /// no facet. Where the two differ, the crack is open.
    #[must_use]
    pub fn sides(&self, facet: u32) -> Option<[[u32; 3]; 2]> {
        let facet = self.facets.all().get(facet as usize)?;
        Some(facet.tets.map(|t| {
            let nodes = self.tets[t as usize];
            let of = |point: u32| {
                nodes
                    .into_iter()
                    .find(|&n| self.points[n as usize] == point)
            };
            // Both tetrahedra have the three points.
            facet.points.map(|point| of(point).unwrap_or(point))
        }))
    }

    /// Gives the tetrahedra around a node that are no longer joined to the lowest one nodes of their own.
    fn split(&mut self, node: u32, splits: &mut Vec<Split>) {
        let mut rest = std::mem::take(&mut self.around[node as usize]);
        let kept = self.joined(node, &mut rest);
        self.around[node as usize] = kept;
        while !rest.is_empty() {
            let part = self.joined(node, &mut rest);
            let new = self.points.len() as u32;
            for &t in &part {
                for corner in &mut self.tets[t as usize] {
                    if *corner == node {
                        *corner = new;
                    }
                }
            }
            self.points.push(self.points[node as usize]);
            self.around.push(part);
            splits.push(Split { node, new });
        }
    }

    /// Takes the lowest of some tetrahedra around a node, and those joined to it by facets with that node, out of the list;
    /// both lists are ascending.
    fn joined(&self, node: u32, rest: &mut Vec<u32>) -> Vec<u32> {
        let mut part: Vec<u32> = rest.first().copied().into_iter().collect();
        let mut seen = 0;
        while let Some(&t) = part.get(seen) {
            seen += 1;
            let corners = self.tets[t as usize];
            for (k, facet) in self.facets.of_tets()[t as usize].iter().enumerate() {
                let Some(facet) = facet.filter(|&f| corners[k] != node && !self.is_cut[f as usize])
                else {
                    continue;
                };
                let [a, b] = self.facets.all()[facet as usize].tets;
                let other = if a == t { b } else { a };
                if !part.contains(&other) {
                    part.push(other);
                }
            }
        }
        part.sort_unstable();
        rest.retain(|t| part.binary_search(t).is_err());
        part
    }

    /// The number of the part that each tetrahedron belongs to: those that facets without a cut join are one part. Parts are
    /// numbered from 0 by their lowest tetrahedra.
    #[must_use]
    pub fn parts(&self) -> Vec<u32> {
        let mut parts = vec![None; self.tets.len()];
        let mut count = 0;
        for start in 0..self.tets.len() {
            let mut open = vec![start];
            let mut is_new = false;
            while let Some(t) = open.pop() {
                if parts[t].is_some() {
                    continue;
                }
                (parts[t], is_new) = (Some(count), true);
                let uncut = self.facets.of_tets()[t].into_iter().flatten();
                let uncut = uncut.filter(|&f| !self.is_cut[f as usize]);
                open.extend(
                    uncut.flat_map(|f| self.facets.all()[f as usize].tets.map(|t| t as usize)),
                );
            }
            count += u32::from(is_new);
        }
        parts.into_iter().flatten().collect()
    }

    /// The tetrahedra with their nodes as a mesh of its own, in which both sides of a crack are skin where it is open.
    /// `points` are the places of the points of the mesh without cracks, m.
    ///
    /// # Errors
    ///
    /// As [`TetMesh::in_pieces`], and [`MeshError::OutOfRange`] if there are too few places.
    pub fn mesh(&self, points: &[Point3]) -> Result<TetMesh, MeshError> {
        let place = |point: &u32| points.get(*point as usize).copied();
        let nodes: Option<Vec<Point3>> = self.points.iter().map(place).collect();
        let nodes = nodes.ok_or(MeshError::OutOfRange {
            what: "number of places of points",
            value: points.len() as f64,
            allowed: "the number of points of the mesh",
        })?;
        TetMesh::in_pieces(nodes, self.tets.clone())
    }

    /// The triangles of the skin and of both sides of the cut facets, counter-clockwise seen from outside, by tetrahedron.
    #[must_use]
    pub fn skin(&self) -> Vec<[u32; 3]> {
        let mut skin = Vec::new();
        for (corners, facets) in self.tets.iter().zip(self.facets.of_tets()) {
            for (face, facet) in FACES.iter().zip(facets) {
                if facet.is_none_or(|f| self.is_cut[f as usize]) {
                    skin.push(face.map(|i| corners[i]));
                }
            }
        }
        skin
    }
}
