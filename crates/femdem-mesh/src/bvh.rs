//! A tree of axis-aligned boxes, to find neighbours without testing everything.
//!
//! Built once over the boxes of any items (triangles, tetrahedra), and updated with [`Bvh::refit`] when they
//! move. The order of visits depends on the boxes alone.

use crate::Point3;

/// Largest number of items in one leaf.
const LEAF_SIZE: usize = 4;

/// An axis-aligned box \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner of smallest coordinates.
    pub low: Point3,
    /// The corner of largest coordinates.
    pub high: Point3,
}

impl Aabb {
    /// The empty box: the neutral element of [`union`](Self::union).
    pub const EMPTY: Self = Self {
        low: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// The smallest box around points.
    pub fn of_points(points: impl IntoIterator<Item = Point3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self {
            low: b.low.inf(&p),
            high: b.high.sup(&p),
        })
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: self.low.inf(&other.low),
            high: self.high.sup(&other.high),
        }
    }

    /// The box grown by `margin` \[m\] on all sides.
    pub fn grown(&self, margin: f64) -> Self {
        Self {
            low: self.low.map(|x| x - margin),
            high: self.high.map(|x| x + margin),
        }
    }

    /// Whether the boxes share a point.
    pub fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Squared distance from a point to the box \[m^2\]; 0 inside.
    pub fn distance_squared(&self, p: &Point3) -> f64 {
        (0..3)
            .map(|k| {
                let outside = (self.low[k] - p[k]).max(p[k] - self.high[k]).max(0.0);
                outside * outside
            })
            .sum()
    }

    /// The middle of the box.
    pub fn center(&self) -> Point3 {
        nalgebra::center(&self.low, &self.high)
    }
}

/// A node: a leaf holds the items `order[first..first + count]`; the first child of an inner node (`count` 0)
/// directly follows it, the second is at `first`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    aabb: Aabb,
    first: u32,
    count: u32,
}

/// A binary tree over boxes.
///
/// ```
/// use femdem_mesh::Point3;
/// use femdem_mesh::bvh::{Aabb, Bvh};
///
/// // A hundred boxes in a row.
/// let cube = |x: f64| Aabb { low: Point3::new(x, 0.0, 0.0), high: Point3::new(x + 1.0, 1.0, 1.0) };
/// let boxes: Vec<Aabb> = (0..100).map(|i| cube(2.0 * f64::from(i))).collect();
/// let tree = Bvh::new(&boxes);
/// let mut found = Vec::new();
/// tree.query(&cube(40.5), |i| found.push(i));
/// found.retain(|&i| boxes[i as usize].overlaps(&cube(40.5)));
/// assert_eq!(found, [20]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Bvh {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Bvh {
    /// Builds the tree over `boxes`, halving at the median of the longest axis of their centres.
    ///
    /// The tree holds at most 2^32 - 1 boxes; further ones are ignored.
    pub fn new(boxes: &[Aabb]) -> Self {
        let count = boxes.len().min(u32::MAX as usize);
        let mut tree = Self {
            nodes: Vec::with_capacity(count),
            order: (0..count as u32).collect(),
        };
        if count > 0 {
            let centers: Vec<Point3> = boxes.iter().map(Aabb::center).collect();
            tree.build(boxes, &centers, 0, count);
        }
        tree
    }

    fn build(&mut self, boxes: &[Aabb], centers: &[Point3], start: usize, end: usize) {
        let things = &mut self.order[start..end];
        let aabb = things
            .iter()
            .fold(Aabb::EMPTY, |b, &i| b.union(&boxes[i as usize]));
        let node = self.nodes.len();
        self.nodes.push(Node {
            aabb,
            first: start as u32,
            count: (end - start) as u32,
        });
        if end - start <= LEAF_SIZE {
            return;
        }
        let spread = Aabb::of_points(things.iter().map(|&i| centers[i as usize]));
        let axis = (spread.high - spread.low).imax();
        let half = things.len() / 2;
        things.select_nth_unstable_by(half, |&i, &j| {
            let (a, b) = (centers[i as usize][axis], centers[j as usize][axis]);
            a.total_cmp(&b).then(i.cmp(&j))
        });
        self.build(boxes, centers, start, start + half);
        self.nodes[node].count = 0;
        self.nodes[node].first = self.nodes.len() as u32;
        self.build(boxes, centers, start + half, end);
    }

    /// The items in the order of the leaves.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Number of items in the tree.
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Whether the tree is empty.
    pub fn is_empty(&self) -> bool {
        self.order.is_empty()
    }

    /// The box around all items; [`Aabb::EMPTY`] if there are none.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |root| root.aabb)
    }

    /// Updates the boxes of items that have moved, keeping the tree's shape. Items beyond the end of `boxes`
    /// become empty.
    pub fn refit(&mut self, boxes: &[Aabb]) {
        for node in (0..self.nodes.len()).rev() {
            let Node { first, count, .. } = self.nodes[node];
            self.nodes[node].aabb = if count == 0 {
                let (left, right) = (self.nodes[node + 1].aabb, self.nodes[first as usize].aabb);
                left.union(&right)
            } else {
                self.leaf(first, count)
                    .iter()
                    .filter_map(|&i| boxes.get(i as usize))
                    .fold(Aabb::EMPTY, |b, other| b.union(other))
            };
        }
    }

    fn leaf(&self, first: u32, count: u32) -> &[u32] {
        &self.order[first as usize..(first + count) as usize]
    }

    /// Calls `hit` for every item in a leaf whose ancestors' boxes all pass `enter`.
    ///
    /// Leaves hold several items: `hit` must test the item's own box where that matters.
    pub fn visit(&self, mut enter: impl FnMut(&Aabb) -> bool, mut hit: impl FnMut(u32)) {
        let mut stack = vec![0];
        while let Some(index) = stack.pop() {
            let Some(node) = self.nodes.get(index as usize) else {
                continue;
            };
            if !enter(&node.aabb) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, index + 1]);
            } else {
                self.leaf(node.first, node.count)
                    .iter()
                    .for_each(|&i| hit(i));
            }
        }
    }

    /// Calls `hit` for all items that may overlap the box: at least those whose boxes do.
    pub fn query(&self, aabb: &Aabb, hit: impl FnMut(u32)) {
        self.visit(|node| node.overlaps(aabb), hit);
    }

    /// Calls `hit(i, j)` for pairs of an item of this tree and one of the other, pruned where `meet` excludes
    /// that two boxes (this tree's first) touch. The boxes may be in different frames: `meet` has to convert
    /// them. It must be true for a pair of boxes if it is true for a pair of boxes inside them.
    pub fn visit_pairs(
        &self,
        other: &Self,
        mut meet: impl FnMut(&Aabb, &Aabb) -> bool,
        mut hit: impl FnMut(u32, u32),
    ) {
        let mut stack = vec![(0_u32, 0_u32)];
        while let Some((i, j)) = stack.pop() {
            let (Some(a), Some(b)) = (self.nodes.get(i as usize), other.nodes.get(j as usize))
            else {
                continue;
            };
            if !meet(&a.aabb, &b.aabb) {
                continue;
            }
            if a.count > 0 && b.count > 0 {
                for &k in self.leaf(a.first, a.count) {
                    for &l in other.leaf(b.first, b.count) {
                        hit(k, l);
                    }
                }
                continue;
            }
            let size = |node: &Node| (node.aabb.high - node.aabb.low).norm_squared();
            if b.count > 0 || (a.count == 0 && size(a) >= size(b)) {
                stack.extend([(a.first, j), (i + 1, j)]);
            } else {
                stack.extend([(i, b.first), (i, j + 1)]);
            }
        }
    }

    /// The item nearest to a point, and its squared distance: `distance_squared(i)` is that of item i. Among
    /// equal distances the first in the tree's order. None if the tree is empty, or no distance is below
    /// infinity.
    pub fn nearest(
        &self,
        point: &Point3,
        mut distance_squared: impl FnMut(u32) -> f64,
    ) -> Option<(u32, f64)> {
        let mut best: Option<(u32, f64)> = None;
        let mut stack = vec![(0_u32, 0.0)];
        while let Some((index, bound)) = stack.pop() {
            let reach = best.map_or(f64::INFINITY, |(_, d)| d);
            let Some(node) = self.nodes.get(index as usize) else {
                continue;
            };
            if bound >= reach {
                continue;
            }
            if node.count > 0 {
                for &i in self.leaf(node.first, node.count) {
                    let d = distance_squared(i);
                    if d < best.map_or(f64::INFINITY, |(_, d)| d) {
                        best = Some((i, d));
                    }
                }
                continue;
            }
            let mut children = [index + 1, node.first].map(|child| {
                (
                    child,
                    self.nodes[child as usize].aabb.distance_squared(point),
                )
            });
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            stack.extend(children);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vector3;
    use crate::strategies::vectors;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<Aabb>> {
        let one =
            (vectors(1.0), vectors(0.2)).prop_map(|(middle, size): (Vector3, Vector3)| Aabb {
                low: Point3::from(middle - size.abs()),
                high: Point3::from(middle + size.abs()),
            });
        prop::collection::vec(one, 0..60)
    }

    proptest! {
        #[test]
        fn queries_find_what_brute_force_finds(old in boxes(), new in boxes(), p in vectors(1.5)) {
            let p = Point3::from(p);
            let mut tree = Bvh::new(&old);
            // After a refit the tree must answer for the new boxes, here shuffled among the old.
            let moved: Vec<Aabb> =
                old.iter().enumerate().map(|(i, b)| *new.get(i).unwrap_or(b)).collect();
            tree.refit(&moved);
            let window = Aabb { low: p.map(|x| x - 0.3), high: p.map(|x| x + 0.3) };
            let mut found = Vec::new();
            tree.query(&window, |i| {
                if moved[i as usize].overlaps(&window) {
                    found.push(i);
                }
            });
            found.sort_unstable();
            let expected: Vec<u32> =
                (0..moved.len() as u32).filter(|&i| moved[i as usize].overlaps(&window)).collect();
            prop_assert_eq!(found, expected);

            let distance = |i: u32| moved[i as usize].distance_squared(&p);
            let nearest = tree.nearest(&p, distance).map(|(_, d)| d);
            let expected = (0..moved.len() as u32).map(distance).min_by(f64::total_cmp);
            prop_assert_eq!(nearest, expected);
        }

        #[test]
        fn pairs_are_those_of_brute_force(a in boxes(), b in boxes()) {
            let mut found = Vec::new();
            Bvh::new(&a).visit_pairs(&Bvh::new(&b), Aabb::overlaps, |i, j| {
                if a[i as usize].overlaps(&b[j as usize]) {
                    found.push((i as usize, j as usize));
                }
            });
            found.sort_unstable();
            let all = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
            let expected: Vec<_> = all.filter(|&(i, j)| a[i].overlaps(&b[j])).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
