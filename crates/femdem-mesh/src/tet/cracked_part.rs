//! Parts of a cracked mesh that hang together, and one of them as a mesh of its own.

use super::CrackedMesh;
use crate::MeshError;

/// Some of the tetrahedra of a cracked mesh as a cracked mesh of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CrackedPart {
    /// The part. Facets to tetrahedra that are not of it are skin; its points are those that cracks inside it have split.
    pub mesh: CrackedMesh,
    /// By node of the part, that of the whole.
    pub nodes: Vec<u32>,
    /// By facet of the part, that of the whole.
    pub facets: Vec<u32>,
}

/// Numbers that are joined into classes, each known by its lowest.
struct Classes(Vec<u32>);

impl Classes {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn lowest(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let next = self.0[i as usize];
            self.0[i as usize] = self.0[next as usize];
            i = next;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.lowest(a), self.lowest(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

impl CrackedMesh {
    /// The number of the part that each tetrahedron belongs to, where those that share a node hang together, and those beside a
    /// facet of `joined`. Parts are numbered from 0 by their lowest tetrahedra; a number that is no facet joins nothing.
    ///
    /// ```
    /// use femdem_mesh::tet::CrackedMesh;
    /// use femdem_mesh::{TetMesh, Vector3};
    ///
    /// // A bar of two cubes is cut in the middle, where one of two triangles still joins its halves.
    /// let bar = TetMesh::block([2, 1, 1], &Vector3::new(2.0, 1.0, 1.0))?;
    /// let mut cracked = CrackedMesh::new(&bar);
    /// let middle = |i: u32| bar.points()[i as usize].x == 1.0;
    /// let facets = cracked.facets().all().iter().zip(0..);
    /// let plane: Vec<u32> = facets.filter(|(f, _)| f.points.into_iter().all(middle)).map(|(_, i)| i).collect();
    /// cracked.cut(&plane)?;
    /// assert_eq!(cracked.hanging(&plane[1..]).iter().max(), Some(&0));
    /// assert_eq!(cracked.hanging(&[]).iter().max(), Some(&1));
    /// # Ok::<(), femdem_mesh::MeshError>(())
    /// ```
    #[must_use]
    pub fn hanging(&self, joined: &[u32]) -> Vec<u32> {
        let mut nodes = Classes::new(self.points().len());
        for [a, rest @ ..] in self.tets() {
            rest.iter().for_each(|b| nodes.join(*a, *b));
        }
        for [one, other] in joined.iter().filter_map(|facet| self.sides(*facet)) {
            nodes.join(one[0], other[0]);
        }
        let mut numbers = vec![None; self.points().len()];
        let mut count = 0;
        let number = |tet: &[u32; 4]| {
            *numbers[nodes.lowest(tet[0]) as usize].get_or_insert_with(|| {
                count += 1;
                count - 1
            })
        };
        self.tets().iter().map(number).collect()
    }

    /// The tetrahedra `tets` of it alone, ascending. What they share, and which facets between them are cut, stays.
    ///
    /// # Errors
    ///
    /// [`MeshError::OutOfRange`] if these are not numbers of tetrahedra, ascending, and as [`TetMesh::in_pieces`](super::TetMesh::in_pieces).
    pub fn part(&self, tets: &[u32]) -> Result<CrackedPart, MeshError> {
        let ascending = tets.is_sorted_by(|a, b| a < b);
        let last = tets.last().copied();
        if !ascending || last.is_none_or(|last| last as usize >= self.tets().len()) {
            return Err(MeshError::OutOfRange {
                what: "numbers of the tetrahedra of a part",
                value: last.map_or(0.0, f64::from),
                allowed: "at least one, ascending, below the number of tetrahedra",
            });
        }
        let is_own = |t: &u32| tets.binary_search(t).is_ok();
        let all = self.facets().all().iter().zip(0_u32..);
        let facets: Vec<u32> = all
            .filter(|(facet, _)| facet.tets.iter().all(is_own))
            .map(|(_, number)| number)
            .collect();
        // Nodes that were one before cracks inside the part.
        let mut classes = Classes::new(self.points().len());
        for [one, other] in facets.iter().filter_map(|facet| self.sides(*facet)) {
            one.iter().zip(other).for_each(|(a, b)| classes.join(*a, b));
        }
        let corners = || tets.iter().flat_map(|t| self.tets()[*t as usize]);
        let mut nodes: Vec<u32> = corners().collect();
        nodes.sort_unstable();
        nodes.dedup();
        // A point has the number of one of its nodes: first that one of each.
        let (mut nodes, copies): (Vec<u32>, Vec<u32>) =
            nodes.into_iter().partition(|i| classes.lowest(*i) == *i);
        let points = nodes.len();
        nodes.extend(copies);
        let mut numbers = vec![0; self.points().len()];
        for (node, number) in nodes.iter().zip(0_u32..) {
            numbers[*node as usize] = number;
        }
        let of_tet = |t: &u32| self.tets()[*t as usize].map(|node| numbers[node as usize]);
        let cuts: Vec<bool> = facets.iter().map(|f| self.is_cut()[*f as usize]).collect();
        let point = |node: &u32| numbers[classes.lowest(*node) as usize];
        let of_nodes: Vec<u32> = nodes.iter().map(point).collect();
        debug_assert!(of_nodes.iter().all(|point| (*point as usize) < points));
        let mesh = CrackedMesh::of(tets.iter().map(of_tet).collect(), of_nodes, cuts)?;
        Ok(CrackedPart {
            mesh,
            nodes,
            facets,
        })
    }

    /// The same without its cracks and cut along `facets` alone; nodes are numbered as these cuts go.
    ///
    /// # Errors
    ///
    /// [`MeshError::OutOfRange`] for a number that is no facet.
    pub fn cut_along(&self, facets: &[u32]) -> Result<Self, MeshError> {
        let whole = self.whole_tets().collect();
        let count = self.points().iter().max().map_or(0, |most| most + 1);
        let mut mesh = Self::of(
            whole,
            (0..count).collect(),
            vec![false; self.is_cut().len()],
        )?;
        mesh.cut(facets)?;
        Ok(mesh)
    }

    /// Points of the tetrahedra: their nodes without cracks.
    pub fn whole_tets(&self) -> impl Iterator<Item = [u32; 4]> + '_ {
        let point = |node: u32| self.points()[node as usize];
        self.tets().iter().map(move |tet| tet.map(point))
    }
}
