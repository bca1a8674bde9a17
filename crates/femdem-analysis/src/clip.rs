//! Polyhedra cut by planes: the basis of the exact volumes.

use femdem_mesh::{Point3, Polyhedron, Pose, Vector3};

use crate::ball::volume_in_ball;
use crate::bounds::Bounds;
use crate::prisms::volume_in_cylinder;
use crate::region::Region;

/// A closed surface of polygons that is cut by planes, with memory that is reused.
///
/// The surface is stored as loops over shared vertices. A cut decides once per vertex on which side it lies (on
/// the plane counts as kept) and makes one new vertex per cut edge, so that the surface stays closed whatever
/// the round-off; there are no tolerances. Faces that a plane meets more than twice (non-convex ones) are
/// joined along the cut: such a loop overlaps itself there, which does not change the volume, a signed sum over
/// loops. The same holds for a cap of several loops.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clipper {
    surface: Surface,
    cut: Surface,
    distances: Vec<f64>,
    /// Cut edges as (kept vertex, dropped vertex), sorted.
    edges: Vec<(u32, u32)>,
    /// For each cut edge the one before it on the faces around, which is the next on the cap.
    successor: Vec<u32>,
    renumbered: Vec<u32>,
    visited: Vec<bool>,
}

#[derive(Clone, Debug, Default)]
struct Surface {
    vertices: Vec<Point3>,
    /// Vertex indices, loop after loop.
    corners: Vec<u32>,
    /// Where each loop ends in `corners`.
    ends: Vec<usize>,
}

impl Surface {
    fn clear(&mut self) {
        self.vertices.clear();
        self.corners.clear();
        self.ends.clear();
    }

    fn loops(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts
            .zip(&self.ends)
            .map(|(start, &end)| &self.corners[start..end])
    }

    fn close_loop(&mut self) {
        if self.ends.last().copied().unwrap_or(0) < self.corners.len() {
            self.ends.push(self.corners.len());
        }
    }
}

/// The directed edges of a loop.
fn edges_of(corners: &[u32]) -> impl Iterator<Item = (u32, u32)> {
    corners
        .iter()
        .copied()
        .zip(corners.iter().copied().cycle().skip(1))
}

impl Clipper {
    /// Restarts with `shape` at `pose`.
    pub(crate) fn load(&mut self, shape: &Polyhedron, pose: &Pose) {
        self.surface.clear();
        self.surface
            .vertices
            .extend(shape.vertices().iter().map(|v| pose * v));
        for face in shape.faces() {
            self.surface.corners.extend_from_slice(face);
            self.surface.close_loop();
        }
    }

    /// Restarts with a box.
    pub(crate) fn load_box(&mut self, bounds: &Bounds) {
        self.surface.clear();
        let corners = [&bounds.min, &bounds.max];
        for i in 0..8_usize {
            let [x, y, z] = [i & 1, (i >> 1) & 1, i >> 2].map(|side| corners[side]);
            self.surface.vertices.push(Point3::new(x.x, y.y, z.z));
        }
        for face in [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ] {
            self.surface.corners.extend_from_slice(&face);
            self.surface.close_loop();
        }
    }

    /// Makes the rest empty.
    pub(crate) fn clear(&mut self) {
        self.surface.clear();
    }

    /// Restarts with the rest in another clipper.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.surface.vertices.clone_from(&other.surface.vertices);
        self.surface.corners.clone_from(&other.surface.corners);
        self.surface.ends.clone_from(&other.surface.ends);
    }

    /// Moves the rest.
    pub(crate) fn transform(&mut self, pose: &Pose) {
        for vertex in &mut self.surface.vertices {
            *vertex = pose * *vertex;
        }
    }

    /// Whether the rest is empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.surface.vertices.is_empty()
    }

    /// Box around the rest.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::around(self.surface.vertices.iter().copied())
    }

    /// Calls `hit` with the triangles of the rest. They are fans of the loops: signed integrals over them are
    /// correct, though some triangles may be reversed.
    pub(crate) fn each_triangle(&self, mut hit: impl FnMut([Point3; 3])) {
        let place = |v: u32| self.surface.vertices[v as usize];
        for corners in self.surface.loops() {
            let Some((&first, rest)) = corners.split_first() else {
                continue;
            };
            for pair in rest.windows(2) {
                hit([place(first), place(pair[0]), place(pair[1])]);
            }
        }
    }

    /// Volume of the rest: signed tetrahedra from one of its vertices.
    pub(crate) fn volume(&self) -> f64 {
        let vertices = &self.surface.vertices;
        let Some(&apex) = vertices.first() else {
            return 0.0;
        };
        let mut six_volumes = 0.0;
        for corners in self.surface.loops() {
            let Some((&first, rest)) = corners.split_first() else {
                continue;
            };
            let base = vertices[first as usize];
            let mut area = Vector3::zeros();
            for pair in rest.windows(2) {
                let [p, q] = [pair[0], pair[1]].map(|v| vertices[v as usize] - base);
                area += p.cross(&q);
            }
            six_volumes += area.dot(&(base - apex));
        }
        six_volumes / 6.0
    }

    /// Keeps the part with `normal · x <= offset`.
    pub(crate) fn clip(&mut self, normal: &Vector3, offset: f64) {
        self.distances.clear();
        self.distances.extend(
            self.surface
                .vertices
                .iter()
                .map(|v| normal.dot(&v.coords) - offset),
        );
        if self.distances.iter().all(|&s| s <= 0.0) {
            return;
        }
        if self.distances.iter().all(|&s| s > 0.0) {
            self.surface.clear();
            return;
        }
        self.find_cut_edges();
        self.cut.clear();
        self.place_vertices();
        self.cut_faces();
        self.add_caps();
        std::mem::swap(&mut self.surface, &mut self.cut);
    }

    fn find_cut_edges(&mut self) {
        let kept = |v: u32| self.distances[v as usize] <= 0.0;
        self.edges.clear();
        for corners in self.surface.loops() {
            for (a, b) in edges_of(corners) {
                match (kept(a), kept(b)) {
                    (true, false) => self.edges.push((a, b)),
                    (false, true) => self.edges.push((b, a)),
                    _ => {}
                }
            }
        }
        self.edges.sort_unstable();
        self.edges.dedup();
    }

    /// Kept vertices first, then one per cut edge.
    fn place_vertices(&mut self) {
        let old = &self.surface.vertices;
        self.renumbered.clear();
        for (vertex, &distance) in old.iter().zip(&self.distances) {
            self.renumbered.push(self.cut.vertices.len() as u32);
            if distance <= 0.0 {
                self.cut.vertices.push(*vertex);
            }
        }
        for &(a, b) in &self.edges {
            let [a, b] = [a as usize, b as usize];
            let t = self.distances[a] / (self.distances[a] - self.distances[b]);
            self.cut.vertices.push(old[a] + (old[b] - old[a]) * t);
        }
    }

    fn cut_faces(&mut self) {
        let first_new = (self.cut.vertices.len() - self.edges.len()) as u32;
        let kept = |v: u32| self.distances[v as usize] <= 0.0;
        let number = |edge: (u32, u32)| self.edges.partition_point(|e| *e < edge) as u32;
        self.successor.clear();
        self.successor.extend(0..self.edges.len() as u32);
        for corners in self.surface.loops() {
            let mut exit = None;
            let mut entry_before_exit = None;
            for (a, b) in edges_of(corners) {
                if kept(a) {
                    self.cut.corners.push(self.renumbered[a as usize]);
                }
                match (kept(a), kept(b)) {
                    (true, false) => {
                        let out = number((a, b));
                        self.cut.corners.push(first_new + out);
                        exit = Some(out);
                    }
                    (false, true) => {
                        let back = number((b, a));
                        self.cut.corners.push(first_new + back);
                        match exit {
                            Some(out) => self.successor[back as usize] = out,
                            None => entry_before_exit = Some(back),
                        }
                    }
                    _ => {}
                }
            }
            if let (Some(back), Some(out)) = (entry_before_exit, exit) {
                self.successor[back as usize] = out;
            }
            self.cut.close_loop();
        }
    }

    /// Closes the surface on the plane.
    fn add_caps(&mut self) {
        let first_new = (self.cut.vertices.len() - self.edges.len()) as u32;
        self.visited.clear();
        self.visited.resize(self.edges.len(), false);
        for start in 0..self.edges.len() {
            let mut at = start;
            while !self.visited[at] {
                self.visited[at] = true;
                self.cut.corners.push(first_new + at as u32);
                at = self.successor[at] as usize;
            }
            self.cut.close_loop();
        }
    }

    /// Keeps the part inside the planes of `region`; round surfaces are left to [`volume_in`](Self::volume_in).
    pub(crate) fn clip_to_planes(&mut self, region: &Region) {
        let (min, max) = region.corners();
        let axes: &[usize] = match region {
            Region::Box { .. } => &[0, 1, 2],
            Region::Cylinder { .. } => &[2],
            Region::Sphere { .. } => &[],
        };
        for &k in axes {
            let mut normal = Vector3::zeros();
            normal[k] = 1.0;
            self.clip(&normal, max[k]);
            normal[k] = -1.0;
            self.clip(&normal, -min[k]);
        }
    }

    /// Volume of the part inside `region`, after the rest was clipped to its planes.
    pub(crate) fn volume_in(&mut self, region: &Region) -> f64 {
        self.clip_to_planes(region);
        match *region {
            Region::Box { .. } => self.volume(),
            Region::Cylinder {
                centre,
                radius,
                z_min,
                ..
            } => {
                let origin = Point3::new(centre[0], centre[1], z_min);
                let mut volume = 0.0;
                self.each_triangle(|t| volume += volume_in_cylinder(&t, 2, &origin, radius));
                volume
            }
            Region::Sphere { centre, radius } => {
                let mut volume = 0.0;
                self.each_triangle(|t| volume += volume_in_ball(&t, &centre, radius));
                volume
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::catalogue::CatalogueShape;
    use proptest::prelude::*;

    fn halves(shape: &Polyhedron, normal: Vector3, offset: f64) -> [f64; 2] {
        [(normal, offset), (-normal, -offset)].map(|(normal, offset)| {
            let mut clipper = Clipper::default();
            clipper.load(shape, &Pose::identity());
            clipper.clip(&normal, offset);
            clipper.volume()
        })
    }

    /// Planes through every triple of vertices: through faces, edges, vertices and diagonals, where
    /// round-off decides which vertices are kept. The two halves still make the whole.
    #[test]
    fn halves_make_the_whole_in_degenerate_positions() {
        for id in ["P1", "P2", "P5", "A1", "A11"] {
            let shape = id
                .parse::<CatalogueShape>()
                .unwrap()
                .polyhedron(2.0)
                .unwrap();
            let points = shape.vertices();
            let volume = shape.mass_properties().volume;
            for (i, p) in points.iter().enumerate() {
                for (j, q) in points.iter().enumerate().skip(i + 1) {
                    for r in &points[j + 1..] {
                        let normal = (q - p).cross(&(r - p)).normalize();
                        let [below, above] = halves(&shape, normal, normal.dot(&p.coords));
                        assert!(
                            (below + above - volume).abs() < 1e-13,
                            "{id} {below} {above}"
                        );
                        assert!(below > -1e-14 && above > -1e-14);
                    }
                }
            }
        }
    }

    proptest! {
        /// Further cuts never add volume, the order of cuts does not matter, and an empty rest stays empty.
        #[test]
        fn cuts_commute_and_shrink(
            cuts in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, -0.6..0.6_f64), 1..8),
        ) {
            let shape = "A10".parse::<CatalogueShape>().unwrap().polyhedron(2.0).unwrap();
            let mut planes = Vec::new();
            for (x, y, z, offset) in cuts {
                prop_assume!(x * x + y * y + z * z > 1e-3);
                planes.push((Vector3::new(x, y, z).normalize(), offset));
            }
            let mut forth = Clipper::default();
            forth.load(&shape, &Pose::identity());
            let mut last = shape.mass_properties().volume;
            for (normal, offset) in &planes {
                forth.clip(normal, *offset);
                prop_assert!(forth.volume() <= last + 1e-14);
                last = forth.volume();
            }
            let mut back = Clipper::default();
            back.load(&shape, &Pose::identity());
            planes.iter().rev().for_each(|(normal, offset)| back.clip(normal, *offset));
            prop_assert!((back.volume() - last).abs() < 1e-13);
            prop_assert!(!forth.is_empty() || last == 0.0);
        }
    }
}
