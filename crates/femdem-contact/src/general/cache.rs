//! Which tetrahedra of a pair can meet, and for how long that is known.

use super::cells::Cells;
use super::posed::Posed;
use femdem_mesh::bvh::Aabb;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Candidate lists are made to last for this many evaluations at the present speed.
const LASTS: f64 = 32.0;

/// Least and largest margin of the lists over the field's length.
const MARGIN: [f64; 2] = [4e-4, 2e-2];

/// What the general kernel remembers of a pair: that it is apart, or which tetrahedra can meet. It
/// never changes which contacts are found; a fresh cache gives the same result to round-off.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GeneralCache {
    /// The state holds while the motion is below this, m.
    until: f64,
    /// Motion at the last evaluation, m.
    last: f64,
    /// `None`: the bodies are apart.
    near: Option<Box<Near>>,
}

/// Candidate pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Near {
    /// Origin of the integrals, in A's axes: the middle of what can overlap.
    pub centre: Vector3,
    /// Tetrahedra of A and of B that appear in pairs, ascending.
    pub in_a: Vec<u32>,
    pub in_b: Vec<u32>,
    /// Places in `in_a` and `in_b`, in ascending order.
    pub pairs: Vec<[u32; 2]>,
}

/// Two solids and where B is in A's axes.
pub(crate) struct Placed<'a> {
    pub a: &'a Cells,
    pub b: &'a Cells,
    pub rotation: Matrix3,
    pub offset: Vector3,
    /// Length that margins are measured by, m.
    pub scale: f64,
}

impl GeneralCache {
    /// Whether the pair was close enough for contact when the cache was last renewed.
    pub fn is_near(&self) -> bool {
        self.near.is_some()
    }

    /// Whether `motion` still lies within what the cache allows without a look at the pair.
    pub fn is_clear(&self, motion: f64) -> bool {
        self.near.is_none() && motion < self.until
    }

    /// The candidates, found anew if they have expired.
    pub(crate) fn candidates(&mut self, placed: &Placed, motion: f64) -> Option<&Near> {
        if motion >= self.until {
            let [least, largest] = MARGIN.map(|m| m * placed.scale);
            let margin = (LASTS * (motion - self.last)).clamp(least, largest);
            let gap = placed.gap();
            self.near = if gap > margin {
                self.until = motion + gap;
                None
            } else {
                self.until = motion + margin;
                placed.find(margin).map(Box::new)
            };
        }
        self.last = motion;
        self.near.as_deref()
    }
}

impl Placed<'_> {
    /// A lower bound of the distance: how far the boxes are apart along the axes of A or B.
    fn gap(&self) -> f64 {
        let (a, b) = (self.a.tree.bounds(), self.b.tree.bounds());
        let in_a = gap_along_axes(&a, &b, &self.rotation, &self.offset);
        let inverse = self.rotation.transpose();
        let in_b = gap_along_axes(&b, &a, &inverse, &-(inverse * self.offset));
        in_a.max(in_b)
    }

    /// Pairs of tetrahedra that are, or within `margin` may come to be, in touch.
    fn find(&self, margin: f64) -> Option<Near> {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        let absolute = self.rotation.abs();
        self.a.tree.visit_pairs(
            &self.b.tree,
            |a, b| meet(a, b, &self.rotation, &absolute, &self.offset, margin),
            |i, j| pairs.push([i, j]),
        );
        pairs.sort_unstable();
        let mut in_a: Vec<u32> = pairs.iter().map(|p| p[0]).collect();
        in_a.dedup();
        let mut in_b: Vec<u32> = pairs.iter().map(|p| p[1]).collect();
        in_b.sort_unstable();
        in_b.dedup();
        let posed_a = self.pose_a(&in_a, &Vector3::zeros());
        let posed_b = self.pose_b(&in_b, &Vector3::zeros());
        let place = |list: &[u32], i: u32| list.binary_search(&i).unwrap_or(0);
        let (mut low, mut high) = (
            Vector3::repeat(f64::INFINITY),
            Vector3::repeat(f64::NEG_INFINITY),
        );
        pairs.retain(|[i, j]| {
            let (a, b) = (&posed_a[place(&in_a, *i)], &posed_b[place(&in_b, *j)]);
            let close = a.is_near(b, margin)
                && a.faces_across(b, margin).is_some()
                && b.faces_across(a, margin).is_some();
            if close {
                low = low.inf(&a.low.sup(&b.low));
                high = high.sup(&a.high.inf(&b.high));
            }
            close
        });
        if pairs.is_empty() {
            return None;
        }
        in_a = pairs.iter().map(|p| p[0]).collect();
        in_a.dedup();
        in_b = pairs.iter().map(|p| p[1]).collect();
        in_b.sort_unstable();
        in_b.dedup();
        for [i, j] in &mut pairs {
            *i = place(&in_a, *i) as u32;
            *j = place(&in_b, *j) as u32;
        }
        Some(Near {
            centre: (low + high) * 0.5,
            in_a,
            in_b,
            pairs,
        })
    }

    /// Tetrahedra of A about an origin in A's axes.
    fn pose_a(&self, list: &[u32], origin: &Vector3) -> Vec<Posed> {
        let mut out = Vec::new();
        pose_a(self.a, list, origin, &mut out);
        out
    }

    fn pose_b(&self, list: &[u32], origin: &Vector3) -> Vec<Posed> {
        let mut out = Vec::new();
        self.pose_b_into(list, origin, &mut out);
        out
    }

    /// Tetrahedra of A and B about an origin in A's axes.
    pub fn pose(&self, near: &Near, out_a: &mut Vec<Posed>, out_b: &mut Vec<Posed>) {
        pose_a(self.a, &near.in_a, &near.centre, out_a);
        self.pose_b_into(&near.in_b, &near.centre, out_b);
    }

    fn pose_b_into(&self, list: &[u32], origin: &Vector3, out: &mut Vec<Posed>) {
        let offset = self.offset - origin;
        let cells = list.iter().filter_map(|&j| self.b.list.get(j as usize));
        out.clear();
        out.extend(cells.map(|c| Posed::new(c, &self.rotation, &offset)));
    }
}

fn pose_a(a: &Cells, list: &[u32], origin: &Vector3, out: &mut Vec<Posed>) {
    let cells = list.iter().filter_map(|&i| a.list.get(i as usize));
    out.clear();
    out.extend(cells.map(|c| Posed::shifted(c, &-origin)));
}

/// Whether a box in A's axes and one in B's come within `margin` along A's axes.
fn meet(
    a: &Aabb,
    b: &Aabb,
    rotation: &Matrix3,
    absolute: &Matrix3,
    offset: &Vector3,
    margin: f64,
) -> bool {
    let half = absolute * ((b.high - b.low) * 0.5);
    let centre = rotation * b.center().coords + offset;
    (0..3).all(|k| {
        a.low[k] - margin <= centre[k] + half[k] && centre[k] - half[k] <= a.high[k] + margin
    })
}

/// Largest gap between a box and a turned box along the first one's axes, m.
fn gap_along_axes(a: &Aabb, b: &Aabb, rotation: &Matrix3, offset: &Vector3) -> f64 {
    let half = rotation.abs() * ((b.high - b.low) * 0.5);
    let centre = rotation * b.center().coords + offset;
    (0..3)
        .map(|k| (centre[k] - half[k] - a.high[k]).max(a.low[k] - centre[k] - half[k]))
        .fold(f64::NEG_INFINITY, f64::max)
}
