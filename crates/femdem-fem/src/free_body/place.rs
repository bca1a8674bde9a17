//! Which tetrahedron a point of a body lies in, or next to.

use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::tet::FACES;
use femdem_mesh::{Matrix3, Point3, TetMesh, Vector3, closest_point};

/// A point of a body in one of its tetrahedra.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub tet: usize,
    /// Barycentric coordinates; they sum to 1.
    pub coordinates: [f64; 4],
    pub point: Point3,
}

/// Points at most this far outside a tetrahedron, in barycentric coordinates, count as inside.
const ON_FACE: f64 = 1e-9;

/// Shortest step of the search for the deepest point, over its depth.
const FINEST: f64 = 1e-3;

/// Finds places.
#[derive(Debug)]
pub(super) struct Places {
    tets: Vec<[Point3; 4]>,
    tree: Bvh,
    /// Triangles of the skin with their tetrahedra.
    skin: Vec<([Point3; 3], usize)>,
    skin_tree: Bvh,
}

impl Places {
    pub fn new(mesh: &TetMesh) -> Self {
        let corners = |tet: &[u32; 4]| tet.map(|i| mesh.points()[i as usize]);
        let tets: Vec<[Point3; 4]> = mesh.tets().iter().map(corners).collect();
        let mut skin = Vec::new();
        for (t, (tet, neighbours)) in tets.iter().zip(mesh.neighbours()).enumerate() {
            for (face, neighbour) in FACES.iter().zip(neighbours) {
                if neighbour.is_none() {
                    skin.push((face.map(|i| tet[i]), t));
                }
            }
        }
        let boxes: Vec<Aabb> = tets.iter().map(|tet| Aabb::of_points(*tet)).collect();
        let skin_boxes = skin.iter().map(|(triangle, _)| Aabb::of_points(*triangle));
        Self {
            tree: Bvh::new(&boxes),
            skin_tree: Bvh::new(&skin_boxes.collect::<Vec<_>>()),
            tets,
            skin,
        }
    }

    /// The place of the point of the body nearest to `x`: of `x` itself if it lies inside.
    pub fn nearest(&self, x: &Point3) -> Option<Place> {
        let mut inside: Option<Place> = None;
        let around = Aabb::of_points([*x]);
        self.tree.query(&around, |t| {
            let tet = t as usize;
            let coordinates = self.coordinates(tet, x);
            let is_first = inside.is_none_or(|found| tet < found.tet);
            if is_first && coordinates.iter().all(|c| *c >= -ON_FACE) {
                inside = Some(Place {
                    tet,
                    coordinates,
                    point: *x,
                });
            }
        });
        if inside.is_some() {
            return inside;
        }
        let (face, point) = self.on_skin(x)?;
        let tet = self.skin.get(face as usize)?.1;
        Some(Place {
            tet,
            coordinates: self.coordinates(tet, &point),
            point,
        })
    }

    /// Diameter of the largest ball in the body (m): the deepest node or middle of a tetrahedron, moved along the axes while it
    /// gets deeper.
    pub fn inscribed_diameter(&self) -> f64 {
        let middle =
            |tet: &[Point3; 4]| Point3::from(tet.iter().map(|p| p.coords).sum::<Vector3>() / 4.0);
        let depth = |x: &Point3| self.on_skin(x).map_or(0.0, |(_, on)| (on - x).norm());
        let middles = self.tets.iter().map(middle);
        let mut deepest = (0.0, Point3::origin());
        for x in middles.chain(self.tets.iter().flatten().copied()) {
            let own = depth(&x);
            if own > deepest.0 {
                deepest = (own, x);
            }
        }
        // Steps shorter than the depth do not leave the body.
        let mut step = 0.5 * deepest.0;
        while step > FINEST * deepest.0 {
            let ways = (0..3).flat_map(|k| [-step, step].map(|way| Vector3::ith(k, way)));
            let moved = ways.map(|way| deepest.1 + way);
            let best = moved
                .map(|x| (depth(&x), x))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some(best) if best.0 > deepest.0 => deepest = best,
                _ => step *= 0.5,
            }
        }
        2.0 * deepest.0
    }

    /// The triangle of the skin nearest to a point, and its nearest point.
    pub fn on_skin(&self, x: &Point3) -> Option<(u32, Point3)> {
        let on = |face: u32| closest_point(&self.skin[face as usize].0, x);
        let distance = |face: u32| (on(face) - x).norm_squared();
        let (face, _) = self.skin_tree.nearest(x, distance)?;
        Some((face, on(face)))
    }

    fn coordinates(&self, tet: usize, x: &Point3) -> [f64; 4] {
        let [a, b, c, d] = self.tets[tet];
        let edges = Matrix3::from_columns(&[b - a, c - a, d - a]);
        // Cramer's rule.
        let (way, volume) = (x - a, edges.determinant());
        debug_assert!(volume != 0.0, "a checked mesh has no flat tetrahedron");
        let [e, f, g] = [b - a, c - a, d - a];
        let [l, m, n] = [f.cross(&g), g.cross(&e), e.cross(&f)].map(|s| way.dot(&s) / volume);
        [1.0 - l - m - n, l, m, n]
    }
}
