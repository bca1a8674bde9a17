//! Distances to a set of triangles.

use crate::bvh::{Aabb, Bvh};
use crate::{Point3, closest_point};

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
