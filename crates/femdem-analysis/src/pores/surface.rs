//! Surfaces of triangles in named parts, and whether they are closed.

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

/// What a triangle of a surface belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SurfacePatch {
    /// The bodies.
    Bodies,
    /// The upright sides of the region.
    Sides,
    /// The lower end of the region.
    Low,
    /// The upper end of the region.
    High,
    /// The side of the smallest x, where space repeats itself along x: the triangles of the other side, a period away.
    XLow,
    /// The side of the largest x.
    XHigh,
    /// The side of the smallest y, where space repeats itself along y.
    YLow,
    /// The side of the largest y.
    YHigh,
}

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Corners (m).
    pub vertices: Vec<Point3>,
    /// Triangles by their corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The part that each triangle belongs to.
    pub patches: Vec<SurfacePatch>,
}

/// Whether a surface is closed, judged as a reader of a file in single precision sees it: corners of equal
/// coordinates are one, and triangles with two equal corners are left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceCheck {
    /// Triangles.
    pub triangles: usize,
    /// Triangles that single precision makes a line or a point.
    pub degenerate: usize,
    /// Edges.
    pub edges: usize,
    /// Edges that are not in exactly two triangles, once in each direction.
    pub open_edges: usize,
    /// Volume inside (m³).
    pub volume: f64,
}

impl SurfaceCheck {
    /// Whether every edge is in exactly two triangles.
    pub fn is_closed(&self) -> bool {
        self.triangles > 0 && self.open_edges == 0
    }
}

impl Surface {
    /// Adds a triangle with corners of its own.
    pub(super) fn push(&mut self, corners: [Point3; 3], patch: SurfacePatch) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
        self.patches.push(patch);
    }

    /// The corners of the triangles of a part.
    pub fn part(&self, patch: SurfacePatch) -> impl Iterator<Item = [Point3; 3]> + Clone + '_ {
        let own = self.triangles.iter().zip(&self.patches);
        own.filter(move |(_, part)| **part == patch)
            .map(|(triangle, _)| triangle.map(|v| self.vertices[v as usize]))
    }

    /// Leaves out triangles with two equal corners.
    pub(super) fn drop_degenerate(&mut self) {
        let vertices = &self.vertices;
        let (triangles, patches) = (self.triangles.iter().zip(&self.patches))
            .filter(|(triangle, _)| {
                let [a, b, c] = triangle.map(|v| vertices[v as usize]);
                a != b && b != c && c != a
            })
            .unzip();
        (self.triangles, self.patches) = (triangles, patches);
    }

    /// Checks whether the surface, all parts together, is closed, and measures the volume inside.
    pub fn check(&self) -> SurfaceCheck {
        // Adding zero makes one of the two zeros.
        let key = |p: &Point3| [p.x, p.y, p.z].map(|x| (x as f32 + 0.0).to_bits());
        let mut order: Vec<([u32; 3], u32)> = self.vertices.iter().map(key).zip(0..).collect();
        order.sort_unstable();
        // For every corner the first of those equal to it.
        let mut same = vec![0; self.vertices.len()];
        for equal in order.chunk_by(|a, b| a.0 == b.0) {
            for (_, vertex) in equal {
                same[*vertex as usize] = equal[0].1;
            }
        }
        let mut check = SurfaceCheck {
            triangles: self.triangles.len(),
            degenerate: 0,
            edges: 0,
            open_edges: 0,
            volume: 0.0,
        };
        let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * self.triangles.len());
        let place = |v: u32| self.vertices[v as usize].map(|x| f64::from(x as f32));
        let apex = self.vertices.first().map_or(Point3::origin(), |_| place(0));
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|v| same[v as usize]);
            if a == b || b == c || c == a {
                check.degenerate += 1;
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges.push((from.min(to), from.max(to), from < to));
            }
            let [p, q, r] = [a, b, c].map(|v| place(v) - apex);
            check.volume += p.dot(&q.cross(&r)) / 6.0;
        }
        edges.sort_unstable();
        for uses in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            check.edges += 1;
            if !matches!(uses, [(_, _, false), (_, _, true)]) {
                check.open_edges += 1;
            }
        }
        check
    }
}
