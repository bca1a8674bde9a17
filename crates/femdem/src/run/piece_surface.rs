//! Surfaces of the pieces of a body that has cracked.

use femdem_mesh::tet::FACES;
use femdem_mesh::{MeshError, Point3, Polyhedron, Vector3, convex_hull};
use std::collections::BTreeMap;

use super::pieces::{BreakableBody, Piece};

impl BreakableBody<'_> {
    /// The present surface of a piece about its centre of mass. Cracks that do not separate it are closed: a point of the mesh
    /// lies at the mean of the nodes that it has become.
    ///
    /// Where more than two faces of the skin meet at an edge, those belong together between which there are tetrahedra, and where
    /// several parts of the surface meet at a point, each has a corner of its own; so each edge has two faces. Of a piece
    /// around a hole the outside is taken, and of one whose surface still passes an edge twice, or has no volume, the hull.
    ///
    /// # Errors
    ///
    /// [`MeshError`] if the piece has no hull either.
    pub fn surface(&self, piece: &Piece) -> Result<Polyhedron, MeshError> {
        let faces = self.skin(piece);
        let places = self.places(piece);
        let place = |point: u32| places[&point];
        let (corners, shells) = self.joined(&faces);
        let volume = |shell: usize| -> f64 {
            let own = faces.iter().zip(&shells).filter(|(_, s)| **s == shell);
            own.map(|(&(t, k), _)| {
                let [a, b, c] = FACES[k].map(|i| place(self.point(t, i)).coords);
                a.dot(&b.cross(&c))
            })
            .sum()
        };
        let count = shells.iter().max().map_or(0, |last| last + 1);
        let outside = (0..count).max_by(|a, b| volume(*a).total_cmp(&volume(*b)));
        let (mut vertices, mut numbers) = (Vec::new(), BTreeMap::new());
        let mut triangles = Vec::new();
        for (f, &(t, k)) in faces.iter().enumerate() {
            if Some(shells[f]) != outside {
                continue;
            }
            let vertex = |c: usize| {
                *numbers.entry(corners[3 * f + c]).or_insert_with(|| {
                    vertices.push(place(self.point(t, FACES[k][c])));
                    vertices.len() as u32 - 1
                })
            };
            triangles.push([0, 1, 2].map(vertex).to_vec());
        }
        Polyhedron::new(vertices, triangles).or_else(|_| {
            let points: Vec<Point3> = places.into_values().collect();
            convex_hull(&points)
        })
    }

    /// Where the points of a piece are now, about its centre of mass \[m\].
    pub fn places(&self, piece: &Piece) -> BTreeMap<u32, Point3> {
        let mut nodes = BTreeMap::new();
        for &t in &piece.tets {
            for (i, node) in self.body.model().mesh().tets()[t as usize]
                .into_iter()
                .enumerate()
            {
                nodes.insert(node, self.point(t, i));
            }
        }
        let mut sums: BTreeMap<u32, (Vector3, f64)> = BTreeMap::new();
        for (node, point) in nodes {
            let (sum, count) = sums.entry(point).or_default();
            *sum += self.body.positions()[node as usize] - piece.centre;
            *count += 1.0;
        }
        let mean = |(point, (sum, count)): (u32, (Vector3, f64))| (point, (sum / count).into());
        sums.into_iter().map(mean).collect()
    }

    /// For each corner of the faces of a skin a number, equal for corners that are one vertex; and for each face that of the part
    /// of the surface to which it belongs.
    fn joined(&self, faces: &[(u32, usize)]) -> (Vec<usize>, Vec<usize>) {
        let mut corners = Classes::new(3 * faces.len());
        let mut shells = Classes::new(faces.len());
        for (f, &(t, k)) in faces.iter().enumerate() {
            for m in (0..4).filter(|m| *m != k) {
                // The edge of this face that is opposite to corner m of the tetrahedron.
                let ends: Vec<u32> = FACES[k]
                    .into_iter()
                    .filter(|i| *i != m)
                    .map(|i| self.point(t, i))
                    .collect();
                let Ok(g) = faces.binary_search(&self.turned(faces, t, k, &ends)) else {
                    continue;
                };
                shells.join(f, g);
                for end in ends {
                    let corner = |f: usize| {
                        let (t, k) = faces[f];
                        (0..3).find(|c| self.point(t, FACES[k][*c]) == end)
                    };
                    if let (Some(a), Some(b)) = (corner(f), corner(g)) {
                        corners.join(3 * f + a, 3 * g + b);
                    }
                }
            }
        }
        let numbers = (0..corners.0.len()).map(|c| corners.first(c)).collect();
        let mut known = BTreeMap::new();
        let shells = (0..faces.len()).map(|f| {
            let next = known.len();
            *known.entry(shells.first(f)).or_insert(next)
        });
        (numbers, shells.collect())
    }

    /// The face of the skin that is met by turning about an edge of face `k` of a tetrahedron through the piece.
    fn turned(&self, faces: &[(u32, usize)], tet: u32, k: usize, ends: &[u32]) -> (u32, usize) {
        let (mut t, mut k) = (tet, k);
        loop {
            let is_end = |i: usize| ends.contains(&self.point(t, i));
            let other = (0..4).find(|i| *i != k && !is_end(*i)).unwrap_or(k);
            if faces.binary_search(&(t, other)).is_ok() {
                return (t, other);
            }
            let Some(next) = self.across(t, other) else {
                return (t, other);
            };
            let back = (0..4).find(|i| self.across(next, *i) == Some(t));
            (t, k) = (next, back.unwrap_or(0));
        }
    }
}

/// Numbers that are joined into classes.
struct Classes(Vec<usize>);

impl Classes {
    fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// The lowest number of a class.
    fn first(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first(a), self.first(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high] = low;
    }
}
