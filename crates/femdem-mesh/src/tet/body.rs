//! Questions to a closed surface: inside or outside, nearest point, crossings, sharp edges.

use super::distance::Triangles;
use crate::{Point3, Polyhedron, Vector3};
use std::f64::consts::PI;

/// Edges whose faces' normals differ by more than this angle \[rad\] are features to be kept.
const SHARP: f64 = 0.6;

/// A surface, prepared for questions.
pub(super) struct Body {
    pub(super) triangles: Triangles,
    /// The smooth patch of each triangle: patches end at sharp edges.
    patch: Vec<u32>,
    /// Sharp edges, as triangles of no width.
    sharp: Triangles,
    /// The chain of each sharp edge: chains end at corners.
    chain: Vec<u32>,
    /// Points where other than two sharp edges meet, or two at a sharp angle.
    pub(super) corners: Vec<Point3>,
}

impl Body {
    pub(super) fn new(polyhedron: &Polyhedron) -> Self {
        let vertices = polyhedron.vertices();
        let triangles = polyhedron.triangles();
        let mut sides: Vec<([u32; 2], usize)> = Vec::with_capacity(3 * triangles.len());
        for (i, &[a, b, c]) in triangles.iter().enumerate() {
            let edges = [[a, b], [b, c], [c, a]];
            sides.extend(edges.map(|[a, b]| ([a.min(b), a.max(b)], i)));
        }
        sides.sort_unstable();
        let corner = |i: u32| vertices[i as usize];
        let normal = |i: usize| {
            let [a, b, c] = triangles[i].map(corner);
            (b - a).cross(&(c - a))
        };
        let mut patches: Vec<usize> = (0..triangles.len()).collect();
        let mut sharp: Vec<[u32; 2]> = Vec::new();
        for pair in sides.chunk_by(|a, b| a.0 == b.0) {
            if let [(edge, i), (_, j)] = *pair {
                if normal(i).angle(&normal(j)) > SHARP {
                    sharp.push(edge);
                } else {
                    join(&mut patches, i, j);
                }
            }
        }
        let patch = (0..triangles.len())
            .map(|i| root(&mut patches, i) as u32)
            .collect();

        let mut ends: Vec<(u32, usize)> = Vec::with_capacity(2 * sharp.len());
        for (i, [a, b]) in sharp.iter().enumerate() {
            ends.extend([(*a, i), (*b, i)]);
        }
        ends.sort_unstable();
        let mut chains: Vec<usize> = (0..sharp.len()).collect();
        let mut corners = Vec::new();
        for group in ends.chunk_by(|a, b| a.0 == b.0) {
            let direction = |&(at, edge): &(u32, usize)| {
                let [a, b] = sharp[edge];
                corner(if a == at { b } else { a }) - corner(at)
            };
            match group {
                [a, b] if direction(a).angle(&-direction(b)) <= SHARP => {
                    join(&mut chains, a.1, b.1);
                }
                _ => corners.push(corner(group[0].0)),
            }
        }
        Self {
            triangles: Triangles::new(triangles.iter().map(|t| t.map(corner))),
            patch,
            chain: (0..sharp.len())
                .map(|i| root(&mut chains, i) as u32)
                .collect(),
            sharp: Triangles::new(sharp.iter().map(|&[a, b]| [a, b, b].map(corner))),
            corners,
        }
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

    /// Whether a point lies inside: its winding number is above one half.
    pub(super) fn contains(&self, p: &Point3) -> bool {
        let solid_angle: f64 = self
            .triangles
            .corners
            .iter()
            .map(|t| solid_angle(t, p))
            .sum();
        solid_angle > 2.0 * PI
    }

    /// Where the way from a point inside to one outside first leaves the body.
    pub(super) fn crossing(&self, inside: &Point3, outside: &Point3) -> Point3 {
        let way = outside - inside;
        let mut first = f64::INFINITY;
        self.triangles.along([*inside, *outside], |triangle| {
            if let Some(t) = crossing(triangle, inside, &way) {
                first = first.min(t);
            }
        });
        if first.is_finite() {
            return inside + way * first;
        }
        // Rounding can let the way slip through between two triangles: halve it instead.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.contains(&(inside + way * middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        inside + way * low
    }
}

/// Signed solid angle of a triangle seen from a point; positive if seen from behind
/// (A. Van Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125-126).
fn solid_angle(triangle: &[Point3; 3], p: &Point3) -> f64 {
    let [a, b, c] = triangle.map(|q| q - p);
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let numerator = a.dot(&b.cross(&c));
    let denominator = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
    2.0 * numerator.atan2(denominator)
}

/// The parameter, from 0 to 1, at which `start + t way` goes through a triangle
/// (T. Moeller and B. Trumbore, J. Graphics Tools 2 (1997) 21-28).
fn crossing([a, b, c]: &[Point3; 3], start: &Point3, way: &Vector3) -> Option<f64> {
    const SLACK: f64 = 1e-9;
    let (ab, ac, from) = (b - a, c - a, start - a);
    let across = way.cross(&ac);
    let determinant = ab.dot(&across);
    if determinant.abs() <= f64::EPSILON * way.norm() * ab.norm() * ac.norm() {
        return None;
    }
    let u = from.dot(&across) / determinant;
    let other = from.cross(&ab);
    let v = way.dot(&other) / determinant;
    let t = ac.dot(&other) / determinant;
    let inside = u >= -SLACK && v >= -SLACK && u + v <= 1.0 + SLACK;
    (inside && (0.0..=1.0).contains(&t)).then_some(t)
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
