//! Convex polyhedra as graphs, cut by planes.
//!
//! Every vertex has three edges, in counter-clockwise order seen from outside; where more edges meet, several
//! vertices coincide. A cut uses only the signs at the vertices, and the result is a closed surface for any
//! signs. So round-off at a plane through vertices, edges or faces changes the result by no more than
//! round-off. (The idea of vertex graphs: D. Powell and T. Abel, An exact general remeshing scheme applied to
//! physically conservative voxelization, J. Comput. Phys. 297 (2015).)

use femdem_mesh::Vector3;

/// Largest number of vertices of a tetrahedron cut by four planes, for any signs: the first cut leaves at
/// most 6, and each later one at most doubles them.
const MOST: usize = 48;

/// Volume and first moment about the origin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Moments {
    pub volume: f64,
    pub first: Vector3,
}

/// A convex polyhedron. Half-edge 4 v + k starts at vertex v; the label of the face to its left is stored
/// with it.
#[derive(Debug)]
pub(crate) struct Piece {
    count: usize,
    at: [Vector3; MOST],
    twin: [u16; 4 * MOST],
    label: [u8; 4 * MOST],
    depth: [f64; MOST],
    /// First half-edge of the path along a cut face, by new vertex.
    start: [u16; MOST],
    seen: [bool; 4 * MOST],
    polygon: [Vector3; MOST],
}

impl Default for Piece {
    fn default() -> Self {
        Self {
            count: 0,
            at: [Vector3::zeros(); MOST],
            twin: [0; 4 * MOST],
            label: [0; 4 * MOST],
            depth: [0.0; MOST],
            start: [0; MOST],
            seen: [false; 4 * MOST],
            polygon: [Vector3::zeros(); MOST],
        }
    }
}

/// Ends of the edges from each corner of a tetrahedron, in counter-clockwise order.
const STAR: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [3, 1, 0], [2, 0, 1]];

/// The edge before edge k of a vertex, clockwise.
const BEFORE: [usize; 3] = [2, 0, 1];

/// By half-edge of a tetrahedron, its opposite half-edge. Half-edge 4 v + 3 is not in use.
const TETRAHEDRON: [u16; 16] = opposite_edges();

/// By half-edge of a tetrahedron, the corner opposite the face to its left.
const OPPOSITE: [u8; 16] = opposite_corners();

const fn opposite_edges() -> [u16; 16] {
    let mut twin = [0; 16];
    let mut h = 0;
    while h < 12 {
        let (v, k) = (h / 3, h % 3);
        let w = STAR[v][k];
        let mut back = 0;
        while STAR[w][back] != v {
            back += 1;
        }
        twin[4 * v + k] = (4 * w + back) as u16;
        h += 1;
    }
    twin
}

const fn opposite_corners() -> [u8; 16] {
    let mut corner = [0; 16];
    let mut h = 0;
    while h < 12 {
        let (v, k) = (h / 3, h % 3);
        // Between the edges to star[k] and star[k + 1] lies the face opposite the third.
        corner[4 * v + k] = STAR[v][BEFORE[k]] as u8;
        h += 1;
    }
    corner
}

impl Piece {
    /// Makes this a tetrahedron of positive volume. The face opposite corner k gets the label
    /// `label` + k.
    pub fn load(&mut self, corners: &[Vector3; 4], label: u8) {
        self.count = 4;
        self.at[..4].copy_from_slice(corners);
        self.twin[..16].copy_from_slice(&TETRAHEDRON);
        for (l, corner) in self.label.iter_mut().zip(OPPOSITE) {
            *l = label + corner;
        }
    }

    /// Keeps the part where `depth` (affine) is at least 0, and returns whether there is one. The new face gets the
    /// label.
    pub fn cut(&mut self, label: u8, depth: impl Fn(&Vector3) -> f64) -> bool {
        let old = self.count;
        let mut inside = 0;
        for (d, x) in self.depth[..old].iter_mut().zip(&self.at[..old]) {
            *d = depth(x);
            inside += usize::from(*d >= 0.0);
        }
        if inside > 0 && inside < old {
            self.add_crossings(old, label);
            self.link_crossings(old);
            self.drop_outside(old);
        }
        inside > 0
    }

    fn is_inside(&self, v: usize) -> bool {
        self.depth[v] >= 0.0
    }

    /// A new vertex on every edge that leaves the kept part.
    fn add_crossings(&mut self, old: usize, label: u8) {
        for v in 0..old {
            if !self.is_inside(v) {
                continue;
            }
            for (k, before) in BEFORE.into_iter().enumerate() {
                let out = 4 * v + k;
                let back = usize::from(self.twin[out]);
                let w = back / 4;
                if w >= old || self.is_inside(w) {
                    continue;
                }
                let u = self.count;
                self.count += 1;
                let (dv, dw) = (self.depth[v], self.depth[w]);
                self.at[u] = self.at[v] + (self.at[w] - self.at[v]) * (dv / (dv - dw));
                self.depth[u] = 0.0;
                self.start[u] = back as u16;
                // Both ends now lead to the new vertex.
                self.twin[out] = (4 * u) as u16;
                self.twin[back] = (4 * u) as u16;
                self.twin[4 * u] = out as u16;
                self.label[4 * u] = self.label[4 * v + before];
                self.label[4 * u + 1] = label;
                self.label[4 * u + 2] = self.label[out];
            }
        }
    }

    /// Joins the new vertices along the faces that were cut: from each, around the face through the part that
    /// is cut off, to the next.
    fn link_crossings(&mut self, old: usize) {
        for u in old..self.count {
            let mut back = usize::from(self.start[u]);
            let other = loop {
                let along = usize::from(self.twin[back - back % 4 + BEFORE[back % 4]]);
                if along >= 4 * old {
                    break along / 4;
                }
                back = along;
            };
            self.twin[4 * u + 2] = (4 * other + 1) as u16;
            self.twin[4 * other + 1] = (4 * u + 2) as u16;
        }
    }

    /// Moves vertices from the end into the slots of those that were cut off.
    fn drop_outside(&mut self, old: usize) {
        for v in 0..old {
            if v < self.count && !self.is_inside(v) {
                while !self.is_inside(self.count - 1) {
                    self.count -= 1;
                }
                if v < self.count {
                    self.count -= 1;
                    self.relocate(self.count, v);
                }
            }
        }
    }

    fn relocate(&mut self, from: usize, to: usize) {
        self.at[to] = self.at[from];
        self.depth[to] = self.depth[from];
        for k in 0..3 {
            let twin = usize::from(self.twin[4 * from + k]);
            self.label[4 * to + k] = self.label[4 * from + k];
            if twin / 4 == from {
                self.twin[4 * to + k] = (4 * to + twin % 4) as u16;
            } else {
                self.twin[4 * to + k] = twin as u16;
                self.twin[twin] = (4 * to + k) as u16;
            }
        }
    }

    pub fn vertices(&self) -> &[Vector3] {
        &self.at[..self.count]
    }

    /// Collects the corners of the face to the left of half-edge `first`; returns how many there are.
    #[inline]
    fn collect(&mut self, first: usize) -> usize {
        let mut corners = 0;
        let mut edge = first;
        while !self.seen[edge] && corners < MOST {
            self.seen[edge] = true;
            self.polygon[corners] = self.at[edge / 4];
            corners += 1;
            edge = self.next(edge);
        }
        corners
    }

    /// The half-edge after `edge` round the face to its left.
    #[inline]
    fn next(&self, edge: usize) -> usize {
        let back = usize::from(self.twin[edge]);
        back - back % 4 + BEFORE[back % 4]
    }

    /// Volume and first moment, summed about the first vertex; calls `face` with the label and the corners,
    /// counter-clockwise, of the faces whose labels are among the bits `wanted`. The bits of the labels of all
    /// faces are stored in `labels`.
    #[inline]
    pub fn moments_and_faces(
        &mut self,
        wanted: u8,
        labels: &mut u8,
        mut face: impl FnMut(u8, &[Vector3]),
    ) -> Moments {
        let origin = self.at[0];
        let mut six = 0.0;
        let mut first = Vector3::zeros();
        let mut add = |x: &Vector3, y: &Vector3, z: &Vector3| {
            let volume = x.dot(&y.cross(z));
            six += volume;
            first += (x + y + z) * volume;
        };
        self.seen[..4 * self.count].fill(false);
        for v in 0..self.count {
            for edge in [4 * v, 4 * v + 1, 4 * v + 2] {
                if self.seen[edge] {
                    continue;
                }
                let label = self.label[edge];
                let bit = 1 << label;
                *labels |= bit;
                let x = self.at[v] - origin;
                let flat = x == Vector3::zeros();
                if wanted & bit != 0 {
                    let corners = self.collect(edge);
                    let polygon = &self.polygon[..corners];
                    face(label, polygon);
                    if !flat && corners > 2 {
                        for pair in polygon[1..].windows(2) {
                            add(&x, &(pair[0] - origin), &(pair[1] - origin));
                        }
                    }
                    continue;
                }
                self.seen[edge] = true;
                let mut at = self.next(edge);
                if flat {
                    // These half-edges are only marked as visited.
                    while !self.seen[at] {
                        self.seen[at] = true;
                        at = self.next(at);
                    }
                    continue;
                }
                let mut y = self.at[at / 4] - origin;
                while !self.seen[at] {
                    self.seen[at] = true;
                    at = self.next(at);
                    if !self.seen[at] {
                        let z = self.at[at / 4] - origin;
                        add(&x, &y, &z);
                        y = z;
                    }
                }
            }
        }
        let volume = six / 6.0;
        Moments {
            volume,
            first: first / 24.0 + origin * volume,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> [Vector3; 4] {
        [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()]
    }

    fn moments(piece: &mut Piece) -> Moments {
        piece.moments_and_faces(0, &mut 0, |_, _| ())
    }

    fn for_faces(piece: &mut Piece, face: impl FnMut(u8, &[Vector3])) {
        piece.moments_and_faces(u8::MAX, &mut 0, face);
    }

    /// Labels and orientation: the face opposite corner k has an outward area vector.
    #[test]
    fn a_tetrahedron_has_its_faces() {
        let mut piece = Piece::default();
        piece.load(&unit(), 4);
        let mut found = Vec::new();
        for_faces(&mut piece, |label, p| {
            assert_eq!(p.len(), 3);
            let area = (p[1] - p[0]).cross(&(p[2] - p[0])) * 0.5;
            found.push((label, area));
        });
        found.sort_by_key(|f| f.0);
        let want = [
            Vector3::repeat(0.5),
            -Vector3::x() * 0.5,
            -Vector3::y() * 0.5,
            -Vector3::z() * 0.5,
        ];
        assert_eq!(found.len(), 4);
        for (k, (label, area)) in found.iter().enumerate() {
            assert_eq!(*label, 4 + k as u8);
            assert!((area - want[k]).norm() < 1e-15, "{label} {area}");
        }
        let m = moments(&mut piece);
        assert!((m.volume - 1.0 / 6.0).abs() < 1e-16);
        assert!((m.first - Vector3::repeat(1.0 / 24.0)).norm() < 1e-16);
    }

    /// Cutting off the corner at the origin at height 1/2 leaves 7/8 of the volume.
    #[test]
    fn cuts_leave_the_right_volume() {
        let mut piece = Piece::default();
        piece.load(&unit(), 0);
        let sum = |x: &Vector3| x.x + x.y + x.z - 0.5;
        assert!(piece.cut(4, sum));
        assert!((moments(&mut piece).volume - 7.0 / 48.0).abs() < 1e-16);
        assert!(piece.cut(5, |x| 0.25 - x.z));
        // What was above z = 1/4: a tetrahedron of edge 3/4 less one of edge 1/4.
        let want = 7.0 / 48.0 - (27.0 - 1.0) / (64.0 * 6.0);
        assert!((moments(&mut piece).volume - want).abs() < 1e-16);
        assert!(piece.cut(6, |x| x.z));
        assert!((moments(&mut piece).volume - want).abs() < 1e-16);
        assert!(!piece.cut(7, |x| -1.0 - x.z));
    }

    /// For any signs at the vertices, even ones that no plane can give, the surface stays closed.
    #[test]
    fn nonsense_signs_leave_a_closed_surface() {
        let mut piece = Piece::default();
        let mut state = 12345_u64;
        let mut bit = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / (1_u64 << 24) as f64 - 0.4
        };
        for _ in 0..20_000 {
            piece.load(&unit(), 0);
            for label in 4..8 {
                let values: Vec<f64> = (0..MOST).map(|_| bit()).collect();
                let next = std::cell::Cell::new(0);
                let left = piece.cut(label, |_| {
                    next.set(next.get() + 1);
                    values[next.get() - 1]
                });
                if !left {
                    break;
                }
                let mut area = Vector3::zeros();
                for_faces(&mut piece, |_, p| {
                    for e in p.windows(2) {
                        area += (e[0] - p[0]).cross(&(e[1] - p[0]));
                    }
                });
                assert!(area.norm() < 1e-12, "{area}");
                for h in (0..piece.count).flat_map(|v| [4 * v, 4 * v + 1, 4 * v + 2]) {
                    let t = usize::from(piece.twin[h]);
                    assert_eq!(usize::from(piece.twin[t]), h);
                    assert!(t / 4 < piece.count && t % 4 < 3);
                }
            }
        }
    }
}
