//! Sharp edges and corners of a surface, and the smooth patches between them.

use super::distance::Triangles;
use crate::{Point3, Polyhedron};

/// Edges whose faces' normals differ by more than this angle \[rad\] are sharp.
const SHARP: f64 = 0.6;

/// The constraint on a point of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// None: it moves freely.
    Inside,
    /// A smooth patch of the surface.
    Patch(u32),
    /// A chain of sharp edges.
    Chain(u32),
    /// A corner: it does not move.
    Corner(u32),
}

/// The parts of a surface.
pub(super) struct Features {
    pub(super) triangles: Triangles,
    /// The smooth patch of each triangle: patches end at sharp edges.
    patch: Vec<u32>,
    /// Sharp edges, as triangles of no width.
    sharp: Triangles,
    /// The chain of each sharp edge: chains end at corners.
    chain: Vec<u32>,
    /// The two patches that meet in each chain; by chain, as chains are named by their first edge.
    beside_chain: Vec<[u32; 2]>,
    /// Points where other than two sharp edges meet, or two at a sharp angle.
    pub(super) corners: Vec<Point3>,
    /// The patches that meet in each corner, sorted.
    beside_corner: Vec<Vec<u32>>,
}

/// An edge and its two triangles.
#[derive(Clone, Copy)]
struct Edge {
    ends: [u32; 2],
    beside: [usize; 2],
}

impl Features {
    /// Finds the sharp edges that form chains of at least the length `shortest` \[m\].
    pub(super) fn new(polyhedron: &Polyhedron, shortest: f64) -> Self {
        let vertices = polyhedron.vertices();
        let triangles = polyhedron.triangles();
        let (mut sharp, smooth) = edges(vertices, &triangles);
        let lengths = Chains::of(vertices, &sharp).lengths(vertices, &sharp);
        let mut patches: Vec<usize> = (0..triangles.len()).collect();
        for edge in smooth {
            join(&mut patches, edge.beside[0], edge.beside[1]);
        }
        let mut place = 0;
        sharp.retain(|edge| {
            let keep = lengths[place] >= shortest;
            place += 1;
            if !keep {
                join(&mut patches, edge.beside[0], edge.beside[1]);
            }
            keep
        });
        let patch: Vec<u32> = (0..triangles.len())
            .map(|i| root(&mut patches, i) as u32)
            .collect();
        let chains = Chains::of(vertices, &sharp);
        let corner = |i: u32| vertices[i as usize];
        Self {
            beside_chain: sharp
                .iter()
                .map(|edge| edge.beside.map(|i| patch[i]))
                .collect(),
            beside_corner: patches_at(&chains.corners, &triangles, &patch),
            corners: chains.corners.iter().map(|&i| corner(i)).collect(),
            chain: chains.chain,
            sharp: Triangles::new(
                sharp
                    .iter()
                    .map(|&Edge { ends: [a, b], .. }| [a, b, b].map(corner)),
            ),
            triangles: Triangles::new(triangles.iter().map(|t| t.map(corner))),
            patch,
        }
    }

    /// The patches that a point in a place belongs to.
    fn patches<'a>(&'a self, place: &'a Place) -> &'a [u32] {
        match place {
            Place::Inside => &[],
            Place::Patch(patch) => std::slice::from_ref(patch),
            Place::Chain(chain) => &self.beside_chain[*chain as usize],
            Place::Corner(corner) => &self.beside_corner[*corner as usize],
        }
    }

    /// Whether some patch holds both places: an edge between them does not cross a sharp edge.
    pub(super) fn share_patch(&self, a: &Place, b: &Place) -> bool {
        let others = self.patches(b);
        self.patches(a).iter().any(|patch| others.contains(patch))
    }

    /// The nearest point of the surface, and its patch.
    pub(super) fn nearest(&self, p: &Point3) -> (u32, Point3) {
        self.triangles
            .nearest(p)
            .map_or((0, *p), |(i, q)| (self.patch[i], q))
    }

    /// The nearest point of one patch.
    pub(super) fn nearest_on_patch(&self, p: &Point3, patch: u32) -> Option<Point3> {
        let found = self.triangles.nearest_of(p, |i| self.patch[i] == patch);
        found.map(|(_, q)| q)
    }

    /// The nearest point of all sharp edges, and its chain.
    pub(super) fn nearest_sharp(&self, p: &Point3) -> Option<(u32, Point3)> {
        self.sharp.nearest(p).map(|(i, q)| (self.chain[i], q))
    }

    /// The nearest point of one chain of sharp edges.
    pub(super) fn nearest_on_chain(&self, p: &Point3, chain: u32) -> Option<Point3> {
        let found = self.sharp.nearest_of(p, |i| self.chain[i] == chain);
        found.map(|(_, q)| q)
    }

    /// The sharp edges.
    pub(super) fn sharp_edges(&self) -> impl Iterator<Item = [Point3; 2]> + '_ {
        self.sharp.corners.iter().map(|&[a, b, _]| [a, b])
    }

    /// The place of a point of the surface; points nearer than the tolerance to edges and corners lie on them.
    pub(super) fn place(&self, p: &Point3, tolerance: f64) -> Place {
        if let Some(i) = self.corners.iter().position(|c| (c - p).norm() < tolerance) {
            return Place::Corner(i as u32);
        }
        match self.nearest_sharp(p) {
            Some((chain, q)) if (q - p).norm() < tolerance => Place::Chain(chain),
            _ => Place::Patch(self.nearest(p).0),
        }
    }
}

/// The sharp edges, and the others.
fn edges(vertices: &[Point3], triangles: &[[u32; 3]]) -> (Vec<Edge>, Vec<Edge>) {
    let normal = |i: usize| {
        let [a, b, c] = triangles[i].map(|i| vertices[i as usize]);
        (b - a).cross(&(c - a))
    };
    let mut sides: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * triangles.len());
    for (i, &[a, b, c]) in triangles.iter().enumerate() {
        sides.extend([[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], i)));
    }
    sides.sort_unstable();
    let pairs = sides
        .chunk_by(|a, b| a.0 == b.0)
        .filter_map(|pair| match *pair {
            [(ends, i), (_, j)] => Some(Edge {
                ends,
                beside: [i, j],
            }),
            _ => None,
        });
    pairs.partition(|edge| normal(edge.beside[0]).angle(&normal(edge.beside[1])) > SHARP)
}

/// Sharp edges joined to chains.
struct Chains {
    /// The chain of each edge, named by its first one.
    chain: Vec<u32>,
    /// The vertices where chains end.
    corners: Vec<u32>,
}

impl Chains {
    fn of(vertices: &[Point3], sharp: &[Edge]) -> Self {
        let mut ends: Vec<(u32, usize)> = Vec::with_capacity(2 * sharp.len());
        for (i, edge) in sharp.iter().enumerate() {
            ends.extend(edge.ends.map(|end| (end, i)));
        }
        ends.sort_unstable();
        let direction = |&(at, edge): &(u32, usize)| {
            let [a, b] = sharp[edge].ends;
            vertices[(if a == at { b } else { a }) as usize] - vertices[at as usize]
        };
        let mut chains: Vec<usize> = (0..sharp.len()).collect();
        let mut corners = Vec::new();
        for group in ends.chunk_by(|a, b| a.0 == b.0) {
            match group {
                [a, b] if direction(a).angle(&-direction(b)) <= SHARP => {
                    join(&mut chains, a.1, b.1);
                }
                _ => corners.push(group[0].0),
            }
        }
        Self {
            chain: (0..sharp.len())
                .map(|i| root(&mut chains, i) as u32)
                .collect(),
            corners,
        }
    }

    /// The length of the chain of each edge \[m\].
    fn lengths(&self, vertices: &[Point3], sharp: &[Edge]) -> Vec<f64> {
        let mut total = vec![0.0; sharp.len()];
        for (edge, &chain) in sharp.iter().zip(&self.chain) {
            let [a, b] = edge.ends.map(|i| vertices[i as usize]);
            total[chain as usize] += (b - a).norm();
        }
        self.chain
            .iter()
            .map(|&chain| total[chain as usize])
            .collect()
    }
}

/// The patches around each of some vertices, sorted.
fn patches_at(corners: &[u32], triangles: &[[u32; 3]], patch: &[u32]) -> Vec<Vec<u32>> {
    let mut fans: Vec<(u32, u32)> = Vec::with_capacity(3 * triangles.len());
    for (triangle, &patch) in triangles.iter().zip(patch) {
        fans.extend(triangle.map(|vertex| (vertex, patch)));
    }
    fans.sort_unstable();
    fans.dedup();
    let at = |&vertex: &u32| {
        let start = fans.partition_point(|&(v, _)| v < vertex);
        let fan = fans[start..].iter().take_while(|&&(v, _)| v == vertex);
        fan.map(|&(_, patch)| patch).collect()
    };
    corners.iter().map(at).collect()
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

fn join(parent: &mut [usize], i: usize, j: usize) {
    let (i, j) = (root(parent, i), root(parent, j));
    parent[i.max(j)] = i.min(j);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue::{CatalogueShape, Solid};

    fn cube() -> Polyhedron {
        CatalogueShape::from(Solid::P5)
            .polyhedron(3_f64.sqrt())
            .unwrap()
    }

    #[test]
    fn a_cube_has_12_edges_and_8_corners() {
        let features = Features::new(&cube(), 0.9);
        assert_eq!(features.corners.len(), 8);
        assert_eq!(features.chain.len(), 12);
        let mut patches = features.patch.clone();
        patches.sort_unstable();
        patches.dedup();
        assert_eq!(patches.len(), 6);
        assert!(
            features
                .beside_corner
                .iter()
                .all(|patches| patches.len() == 3)
        );
        // Neighbouring faces do not share a patch, but each shares one with the edge between.
        let at = |x: f64, y: f64, z: f64| features.place(&Point3::new(x, y, z), 1e-9);
        let [top, side, edge] = [at(0.1, 0.2, 0.5), at(0.5, 0.1, 0.2), at(0.5, 0.1, 0.5)];
        assert!(matches!(
            (top, side, edge),
            (Place::Patch(_), Place::Patch(_), Place::Chain(_))
        ));
        assert!(matches!(at(0.5, -0.5, 0.5), Place::Corner(_)));
        assert!(!features.share_patch(&top, &side));
        assert!(features.share_patch(&top, &edge) && features.share_patch(&edge, &side));
        assert!(!features.share_patch(&edge, &at(-0.5, 0.0, 0.0)));
    }

    #[test]
    fn short_edges_are_dropped() {
        let features = Features::new(&cube(), 1.1);
        assert!(features.corners.is_empty() && features.chain.is_empty());
        assert!(features.patch.iter().all(|&patch| patch == 0));
    }

    #[test]
    fn an_edge_runs_on_through_slight_bends() {
        // The rims of a prism with 24 sides bend by 15 degrees: two closed chains, no corner.
        let corner = |i: u32| {
            let angle = f64::from(i / 2) / 24.0 * std::f64::consts::TAU;
            Point3::new(angle.cos(), angle.sin(), f64::from(i % 2))
        };
        let prism = crate::convex_hull(&(0..48).map(corner).collect::<Vec<_>>()).unwrap();
        let features = Features::new(&prism, 6.0);
        assert!(features.corners.is_empty());
        assert_eq!(features.chain.len(), 48);
        assert!(Features::new(&prism, 6.3).chain.is_empty());
    }
}
