//! Inserting vertices that lie on the edges of facets.

use super::clean::Surface;
use crate::bvh::{Aabb, Bvh};
use crate::polyhedron::{Plane, triangulate};
use crate::{Point3, Vector3};

/// Triangles less sharp than this are avoided where a facet is cut along a seam: vertices there lie on a line
/// only to within the welding distance.
const SHARP: f64 = 1e-2;

/// A vertex to be inserted into a loop.
#[derive(PartialEq, PartialOrd)]
struct Joint {
    facet: u32,
    /// The corner of the loop after which it comes.
    corner: usize,
    /// Position on the side from this corner to the next, from 0 to 1.
    along: f64,
    vertex: u32,
}

impl Surface {
    /// Inserts vertices of open edges that lie on another open edge, within `distance` \[m\], into the loop of
    /// its facet, which is cut into triangles; returns the numbers of such vertices and facets.
    pub(super) fn join_seams(&mut self, distance: f64) -> (usize, usize) {
        let joints = self.joints(distance);
        let mut facets = 0;
        for facet in joints.chunk_by(|a, b| a.facet == b.facet) {
            facets += 1;
            let i = facet[0].facet as usize;
            let before = std::mem::take(&mut self.loops[i]);
            let mut corners = Vec::with_capacity(before.len() + facet.len());
            let mut next = facet.iter().peekable();
            for (k, &v) in before.iter().enumerate() {
                corners.push(v);
                while let Some(joint) = next.next_if(|joint| joint.corner == k) {
                    corners.push(joint.vertex);
                }
            }
            let normal = Plane::through(&self.points, &before).normal;
            let mut triangles = Vec::new();
            triangulate(&self.points, &corners, &normal, SHARP, &mut triangles);
            let mut triangles = triangles.iter().map(|t| t.to_vec());
            self.loops[i] = triangles.next().unwrap_or(before);
            let from = self.origin[i];
            self.loops.extend(triangles);
            self.origin.resize(self.loops.len(), from);
        }
        (joints.len(), facets)
    }

    /// The joints, sorted by facet, corner and position on its side.
    fn joints(&self, distance: f64) -> Vec<Joint> {
        let sides = self.sorted_sides();
        let open: Vec<_> = sides
            .chunk_by(|s, t| s.edge == t.edge)
            .filter(|edge| edge.len() == 1)
            .map(|edge| edge[0])
            .collect();
        let mut ends: Vec<u32> = open.iter().flat_map(|side| side.edge).collect();
        ends.sort_unstable();
        ends.dedup();
        let boxes: Vec<Aabb> = ends
            .iter()
            .map(|&v| Aabb::of_points([self.points[v as usize]]))
            .collect();
        let tree = Bvh::new(&boxes);

        let mut joints = Vec::new();
        for side in open {
            let [low, high] = side.edge;
            let [from, to] = if side.forward {
                [low, high]
            } else {
                [high, low]
            };
            let (start, end) = (self.points[from as usize], self.points[to as usize]);
            let corners = &self.loops[side.facet as usize];
            let Some(corner) = corners.iter().position(|&v| v == from) else {
                continue;
            };
            tree.visit(
                |b| passes(b, start, end - start, distance),
                |k| {
                    let vertex = ends[k as usize];
                    let p = self.points[vertex as usize];
                    let along = along(p, start, end - start, distance);
                    if let Some(along) = along.filter(|_| !corners.contains(&vertex)) {
                        joints.push(Joint {
                            facet: side.facet,
                            corner,
                            along,
                            vertex,
                        });
                    }
                },
            );
        }
        joints.sort_by(|a, b| {
            let by_place = (a.facet, a.corner).cmp(&(b.facet, b.corner));
            by_place
                .then(a.along.total_cmp(&b.along))
                .then(a.vertex.cmp(&b.vertex))
        });
        joints
    }
}

/// Position of a point along a segment, if it is within the distance of the segment and not of its ends.
fn along(p: Point3, start: Point3, segment: Vector3, distance: f64) -> Option<f64> {
    let length = segment.norm();
    let along = (p - start).dot(&segment) / length;
    let off = (p - start - segment * (along / length)).norm();
    (off <= distance && along > distance && along < length - distance).then(|| along / length)
}

/// Whether a segment comes within about the distance of a box.
fn passes(b: &Aabb, start: Point3, segment: Vector3, distance: f64) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for k in 0..3 {
        let (low, high) = (
            b.low[k] - distance - start[k],
            b.high[k] + distance - start[k],
        );
        if segment[k] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (at_low, at_high) = (low / segment[k], high / segment[k]);
        enter = enter.max(at_low.min(at_high));
        leave = leave.min(at_low.max(at_high));
    }
    enter <= leave
}
