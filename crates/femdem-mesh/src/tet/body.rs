//! Queries on a closed surface: inside or outside, nearest point, crossings.

use super::distance::Triangles;
use super::winding::Winding;
use crate::{Point3, Polyhedron, Vector3};

/// A surface prepared for queries.
pub(super) struct Body {
    pub(super) triangles: Triangles,
    winding: Winding,
}

impl Body {
    pub(super) fn new(polyhedron: &Polyhedron) -> Self {
        let vertices = polyhedron.vertices();
        let corners = polyhedron.triangles();
        let corners = corners.iter().map(|t| t.map(|i| vertices[i as usize]));
        let triangles = Triangles::new(corners);
        Self {
            winding: Winding::new(&triangles),
            triangles,
        }
    }

    /// Whether a point lies inside: its winding number is above one half.
    pub(super) fn contains(&self, p: &Point3) -> bool {
        self.winding.number(p) > 0.5
    }

    /// Where the segment from a point inside to one outside first leaves the body.
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
        // By rounding the segment can slip through between two triangles: bisect instead.
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
