//! Isosurface stuffing: a lattice of tetrahedra, warped and cut to a closed surface.
//!
//! F. Labelle and J. R. Shewchuk, ACM Trans. Graph. 26 (2007) 57: nodes near the surface are moved
//! onto it, and tetrahedra that are still cut are replaced by a few whose shapes are bounded: in
//! cubic cells dihedral angles lie between 10.7 and 164.8 degrees, whatever the surface.

use super::body::Body;
use super::lattice::Lattice;
use super::six_volumes;
use crate::Point3;
use std::collections::BTreeMap;

/// Nodes nearer to the surface along an edge than this part of its length are moved onto it: long
/// edges and short ones ("safe" bounds of the paper's table 1).
const ALPHA_LONG: f64 = 0.249_99;
const ALPHA_SHORT: f64 = 0.411_89;
/// Nodes this near to the surface, in edges of cells, lie on it.
const ON_SURFACE: f64 = 1e-6;

/// Points and tetrahedra. Every tetrahedron has a lattice node strictly inside the body.
#[derive(Clone)]
pub(super) struct Stuffed {
    pub(super) points: Vec<Point3>,
    pub(super) tets: Vec<[u32; 4]>,
}

/// Fills the body with tetrahedra with edges of about `length` \[m\].
pub(super) fn stuff(body: &Body, lattice: &Lattice, length: f64) -> Stuffed {
    let mut filling = Filling::new(body, lattice, length);
    filling.find_cuts();
    filling.warp();
    filling.cut()
}

/// Where a node lies.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Outside,
    On,
    Inside,
}

struct Filling<'a> {
    body: &'a Body,
    lattice: &'a Lattice,
    positions: Vec<Point3>,
    side: Vec<Side>,
    /// Points of the surface on edges from a node inside (first) to one outside.
    cuts: BTreeMap<[usize; 2], Point3>,
}

impl<'a> Filling<'a> {
    fn new(body: &'a Body, lattice: &'a Lattice, length: f64) -> Self {
        let mut positions: Vec<Point3> = (0..lattice.len())
            .map(|id| lattice.position(lattice.node(id)))
            .collect();
        let near = near_surface(body, lattice);
        let mut side = vec![None; lattice.len()];
        for id in (0..lattice.len()).filter(|&id| near[id]) {
            let foot = body
                .triangles
                .nearest(&positions[id])
                .map_or(positions[id], |(_, q)| q);
            side[id] = Some(if (foot - positions[id]).norm() < ON_SURFACE * length {
                positions[id] = foot;
                Side::On
            } else {
                side_of(body, &positions[id])
            });
        }
        // No surface between neighbours that are both far from it: they lie on the same side.
        let mut stack = Vec::new();
        for start in 0..lattice.len() {
            if side[start].is_some() {
                continue;
            }
            let common = side_of(body, &positions[start]);
            side[start] = Some(common);
            stack.push(start);
            while let Some(id) = stack.pop() {
                for next in lattice.neighbours(id) {
                    if side[next].is_none() {
                        side[next] = Some(common);
                        stack.push(next);
                    }
                }
            }
        }
        Self {
            body,
            lattice,
            positions,
            side: side
                .into_iter()
                .map(|s| s.unwrap_or(Side::Outside))
                .collect(),
            cuts: BTreeMap::new(),
        }
    }

    fn find_cuts(&mut self) {
        for id in (0..self.lattice.len()).filter(|&id| self.side[id] == Side::Inside) {
            for other in self.lattice.neighbours(id) {
                if self.side[other] == Side::Outside {
                    let ends = [id, other].map(|i| self.positions[i]);
                    let cut = self.body.crossing(&ends[0], &ends[1]);
                    self.cuts.insert([id, other], cut);
                }
            }
        }
    }

    /// The cut on the edge between two nodes.
    fn cut_between(&self, a: usize, b: usize) -> Option<Point3> {
        let key = if self.side[a] == Side::Inside {
            [a, b]
        } else {
            [b, a]
        };
        self.cuts.get(&key).copied()
    }

    /// Moves nodes that a cut comes too near to onto the nearest such cut.
    fn warp(&mut self) {
        for id in 0..self.lattice.len() {
            if self.side[id] == Side::On {
                continue;
            }
            let here = self.positions[id];
            let mut nearest: Option<(f64, Point3)> = None;
            for other in self.lattice.neighbours(id) {
                let Some(cut) = self.cut_between(id, other) else {
                    continue;
                };
                let length = (self.positions[other] - here).norm();
                let alpha = if self.lattice.is_long(id, other) {
                    ALPHA_LONG
                } else {
                    ALPHA_SHORT
                };
                let distance = (cut - here).norm();
                if distance < alpha * length && nearest.is_none_or(|(d, _)| distance < d) {
                    nearest = Some((distance, cut));
                }
            }
            if let Some((_, cut)) = nearest {
                for other in self.lattice.neighbours(id).collect::<Vec<_>>() {
                    self.cuts.remove(&[id, other]);
                    self.cuts.remove(&[other, id]);
                }
                self.positions[id] = cut;
                self.side[id] = Side::On;
            }
        }
    }

    /// Keeps the parts of tetrahedra that lie inside.
    fn cut(&self) -> Stuffed {
        let mut output = Output {
            filling: self,
            nodes: vec![u32::MAX; self.lattice.len()],
            cuts: BTreeMap::new(),
            stuffed: Stuffed {
                points: Vec::new(),
                tets: Vec::new(),
            },
        };
        for tet in self.lattice.tets() {
            output.add_part_of(tet);
        }
        output.stuffed
    }

    /// Whether the quadrilateral p, q, cut(q, m), cut(p, m) of the face p, q, m is halved from p
    /// (to the cut of q and m), not from q: towards the cut on the long edge if one is cut, else
    /// by the parity rule (paper, figure 3).
    fn halved_from_first(&self, p: usize, q: usize, m: usize) -> bool {
        if self.lattice.is_long(p, m) {
            return false;
        }
        if self.lattice.is_long(q, m) {
            return true;
        }
        let (p, m) = (self.lattice.node(p), self.lattice.node(m));
        (0..3).filter(|&k| p[k] > m[k]).count() % 2 == 0
    }
}

fn side_of(body: &Body, p: &Point3) -> Side {
    if body.contains(p) {
        Side::Inside
    } else {
        Side::Outside
    }
}

/// The nodes within one cell of the box of a triangle: all that have a cut on one of their edges.
fn near_surface(body: &Body, lattice: &Lattice) -> Vec<bool> {
    let mut near = vec![false; lattice.len()];
    for triangle in &body.triangles.corners {
        let corners = triangle.map(|p| lattice.coordinates(&p));
        let low = corners[0].inf(&corners[1]).inf(&corners[2]);
        let high = corners[0].sup(&corners[1]).sup(&corners[2]);
        // Boxes are loose: a slab about the triangle's plane cuts them down.
        let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let reach = 2.1 * normal.lp_norm(1);
        let [x, y, z] =
            [0, 1, 2].map(|k| (low[k] - 2.1).floor() as i32..=(high[k] + 2.1).ceil() as i32);
        for i in x {
            for j in y.clone() {
                for k in z.clone() {
                    let node = [i, j, k];
                    let same_parity = node.iter().all(|n| n & 1 == i & 1);
                    let from = crate::Vector3::from(node.map(f64::from)) - corners[0];
                    let in_slab = normal.dot(&from).abs() <= reach;
                    if let Some(id) = lattice.id(node).filter(|_| same_parity && in_slab) {
                        near[id] = true;
                    }
                }
            }
        }
    }
    near
}

/// The mesh as it grows.
struct Output<'a> {
    filling: &'a Filling<'a>,
    /// Output index of each node; `u32::MAX` if it has none yet.
    nodes: Vec<u32>,
    cuts: BTreeMap<[usize; 2], u32>,
    stuffed: Stuffed,
}

impl Output<'_> {
    fn node(&mut self, id: usize) -> u32 {
        if self.nodes[id] == u32::MAX {
            self.nodes[id] = self.stuffed.points.len() as u32;
            self.stuffed.points.push(self.filling.positions[id]);
        }
        self.nodes[id]
    }

    /// The end of the part of an edge that lies inside: the cut, or the outer node if it lies on
    /// the surface.
    fn end(&mut self, inside: usize, other: usize) -> u32 {
        let Some(cut) = self.filling.cuts.get(&[inside, other]) else {
            return self.node(other);
        };
        let next = self.stuffed.points.len() as u32;
        let index = *self.cuts.entry([inside, other]).or_insert(next);
        if index == next {
            self.stuffed.points.push(*cut);
        }
        index
    }

    fn push(&mut self, tet: [u32; 4]) {
        let [a, b, c, d] = tet;
        let positive = six_volumes(tet.map(|i| self.stuffed.points[i as usize])) > 0.0;
        self.stuffed
            .tets
            .push(if positive { tet } else { [a, b, d, c] });
    }

    fn add_part_of(&mut self, tet: [usize; 4]) {
        let on = |side: Side| -> Vec<usize> {
            tet.into_iter()
                .filter(|&id| self.filling.side[id] == side)
                .collect()
        };
        let (inside, surface, outside) = (on(Side::Inside), on(Side::On), on(Side::Outside));
        match (&inside[..], &surface[..], &outside[..]) {
            ([], ..) => {}
            (_, _, []) => {
                let corners = tet.map(|id| self.node(id));
                self.push(corners);
            }
            (&[p], ..) => {
                let corners = tet.map(|id| {
                    if id == p {
                        self.node(p)
                    } else {
                        self.end(p, id)
                    }
                });
                self.push(corners);
            }
            (&[p, q], &[z], &[m]) => self.add_pyramid(z, p, q, m),
            (&[p, q], _, &[m, n]) => {
                let bottom = [self.node(p), self.end(p, m), self.end(p, n)];
                let top = [self.node(q), self.end(q, m), self.end(q, n)];
                let first = self.filling.halved_from_first(p, q, m);
                let last = !self.filling.halved_from_first(p, q, n);
                self.add_prism_with_free_face(bottom, top, first, last);
            }
            (&[p, q, r], _, &[m]) => {
                let bottom = [p, q, r].map(|id| self.node(id));
                let top = [p, q, r].map(|id| self.end(id, m));
                let halved =
                    [(p, q), (q, r), (r, p)].map(|(a, b)| self.filling.halved_from_first(a, b, m));
                for tet in prism(bottom, top, halved) {
                    self.push(tet);
                }
            }
            _ => {}
        }
    }

    /// The pyramid on p, q, cut(q, m), cut(p, m) with the apex z.
    fn add_pyramid(&mut self, z: usize, p: usize, q: usize, m: usize) {
        let from_first = self.filling.halved_from_first(p, q, m);
        let [p, q, z, cut_p, cut_q] = [
            self.node(p),
            self.node(q),
            self.node(z),
            self.end(p, m),
            self.end(q, m),
        ];
        let halves = if from_first {
            [[z, p, q, cut_q], [z, p, cut_q, cut_p]]
        } else {
            [[z, p, q, cut_p], [z, q, cut_q, cut_p]]
        };
        halves.into_iter().for_each(|tet| self.push(tet));
    }

    /// A prism of which the quadrilateral between corners 1 and 2 lies on the skin: its diagonal
    /// is chosen for the better shapes.
    fn add_prism_with_free_face(
        &mut self,
        bottom: [u32; 3],
        top: [u32; 3],
        first: bool,
        last: bool,
    ) {
        let points = &self.stuffed.points;
        let worst = |tets: &[[u32; 4]]| {
            let ratio = |tet: &[u32; 4]| {
                super::quality::radius_ratio(tet.map(|i| points[i as usize])).abs()
            };
            tets.iter().map(ratio).fold(f64::INFINITY, f64::min)
        };
        let choices = [true, false].map(|middle| prism(bottom, top, [first, middle, last]));
        let [a, b] = choices;
        let best = if a.is_empty() || worst(&b) > worst(&a) && !b.is_empty() {
            b
        } else {
            a
        };
        best.into_iter().for_each(|tet| self.push(tet));
    }
}

/// Three tetrahedra that fill a prism. `halved[i]`: the diagonal of the side between corners i and
/// i + 1 goes from bottom i to top i + 1, not from bottom i + 1 to top i. Empty if the three
/// diagonals go round in a circle.
fn prism(bottom: [u32; 3], top: [u32; 3], halved: [bool; 3]) -> Vec<[u32; 4]> {
    let Some(i) = (0..3).find(|&i| halved[i] && !halved[(i + 2) % 3]) else {
        return Vec::new();
    };
    let (next, last) = ((i + 1) % 3, (i + 2) % 3);
    let (a, [a1, a2]) = (bottom[i], [bottom[next], bottom[last]]);
    let (b, [b1, b2]) = (top[i], [top[next], top[last]]);
    let mut tets = vec![[a, b, b1, b2]];
    if halved[next] {
        tets.extend([[a, a1, a2, b2], [a, a1, b2, b1]]);
    } else {
        tets.extend([[a, a1, a2, b1], [a, a2, b2, b1]]);
    }
    tets
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strategies::{convex_polyhedra, poses};
    use crate::tet::{Quality, TetMesh};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn shapes_keep_the_bounds_of_the_paper(
            solid in convex_polyhedra(),
            pose in poses(1.0),
            length in 0.15..0.4,
        ) {
            let solid = solid.transformed(&pose).unwrap();
            let lattice = Lattice::around(&solid, length);
            let Stuffed { points, tets } = stuff(&Body::new(&solid), &lattice, length);
            let corners = |tet: &[u32; 4]| tet.map(|i| points[i as usize]);
            let quality = Quality::of(tets.iter().map(corners));
            // 10.78 and 164.74 degrees for cubic cells; these are stretched by up to 26 %.
            prop_assert!(quality.min_dihedral.to_degrees() > 9.0, "{quality:?}");
            prop_assert!(quality.max_dihedral.to_degrees() < 167.0, "{quality:?}");
            // Nothing sticks out of a convex body, and what is lost is a layer thinner than a cell.
            for p in &points {
                let outside = (0..solid.face_count())
                    .map(|i| solid.face_normal(i).dot(&p.coords) - solid.face_offset(i));
                prop_assert!(outside.fold(f64::NEG_INFINITY, f64::max) < 1e-6 * length);
            }
            if let Ok(mesh) = TetMesh::new(points, tets) {
                prop_assert!(mesh.every_tet_has_interior_point());
                let lost = solid.mass_properties().volume - mesh.volume();
                prop_assert!(lost > -1e-6 && lost < solid.area() * length);
            }
        }
    }
}
