//! Distances to a set of triangles.

use crate::bvh::{Aabb, Bvh};
use crate::{Point3, Vector3};

/// Triangles in a tree, for queries of the nearest one.
pub(crate) struct Triangles {
    pub(crate) corners: Vec<[Point3; 3]>,
    tree: Bvh,
}

impl Triangles {
    pub(crate) fn new(corners: impl Iterator<Item = [Point3; 3]>) -> Self {
        let corners: Vec<_> = corners.collect();
        let boxes: Vec<Aabb> = corners.iter().map(|&t| Aabb::of_points(t)).collect();
        Self {
            tree: Bvh::new(&boxes),
            corners,
        }
    }

    /// The triangles in the tree's order: neighbours are near each other.
    pub(crate) fn order(&self) -> &[u32] {
        self.tree.order()
    }

    /// Distance to the nearest triangle \[m\]; infinite if there is none.
    pub(crate) fn distance(&self, p: &Point3) -> f64 {
        self.nearest(p)
            .map_or(f64::INFINITY, |(_, q)| (q - p).norm())
    }

    /// The nearest triangle and the nearest point on it.
    pub(crate) fn nearest(&self, p: &Point3) -> Option<(usize, Point3)> {
        self.nearest_of(p, |_| true)
    }

    /// The nearest among the triangles for which `wanted` is true.
    pub(crate) fn nearest_of(
        &self,
        p: &Point3,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<(usize, Point3)> {
        let distance_squared = |i: u32| {
            if wanted(i as usize) {
                (closest_point(&self.corners[i as usize], p) - p).norm_squared()
            } else {
                f64::INFINITY
            }
        };
        let (i, _) = self.tree.nearest(p, distance_squared)?;
        let i = i as usize;
        Some((i, closest_point(&self.corners[i], p)))
    }

    /// Calls `hit` for all triangles whose boxes a segment's box may touch.
    pub(crate) fn along(&self, segment: [Point3; 2], mut hit: impl FnMut(&[Point3; 3])) {
        self.tree.query(
            &Aabb::of_points(segment),
            |i| hit(&self.corners[i as usize]),
        );
    }
}

/// The point of a triangle nearest to `p`, by the region of the plane over which `p` lies (C. Ericson,
/// Real-Time Collision Detection, 2005, section 5.1.5).
pub(crate) fn closest_point([a, b, c]: &[Point3; 3], p: &Point3) -> Point3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return along(a, &ab, d1, d1 - d3);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return along(a, &ac, d2, d2 - d6);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return along(b, &(c - b), d4 - d3, (d4 - d3) + (d5 - d6));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

fn along(start: &Point3, direction: &Vector3, part: f64, whole: f64) -> Point3 {
    start + direction * if whole > 0.0 { part / whole } else { 0.0 }
}
