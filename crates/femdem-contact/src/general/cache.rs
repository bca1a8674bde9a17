//! Which tetrahedra of a pair can meet, and for how long that is known.

use super::cells::Cells;
use super::posed::Posed;
use femdem_mesh::bvh::Aabb;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Candidate lists are made to last for this many evaluations at the present speed.
const LASTS: f64 = 128.0;

/// Least and largest margin of the lists over the field's length. What a list costs is finding it:
/// candidates that cannot touch yet are passed over by their own budget.
const MARGIN: [f64; 2] = [4e-3, 4e-2];

/// Where nothing is within the margin, it is widened by this factor, up to this part of the field's
/// length, so that pairs that pass close by are left alone for longer.
const WIDENING: f64 = 4.0;
const WIDEST: f64 = 0.25;

/// What the general kernel remembers of a pair: that it is apart, or which tetrahedra can meet. It
/// never changes which contacts are found; a fresh cache gives the same result to round-off.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GeneralCache {
    /// The list holds while the motion is below this, m.
    until: f64,
    /// Nothing touches while the motion is below this, m.
    clear: f64,
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
    /// In ascending order of their places.
    pub pairs: Vec<Candidate>,
}

/// A tetrahedron of A and one of B that can come to touch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Candidate {
    /// Places in `in_a` and `in_b`.
    pub places: [u32; 2],
    /// The two are apart while the motion is below this, m.
    pub clear: f64,
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
        motion < self.clear
    }

    /// The candidates, found anew if they have expired.
    pub(crate) fn candidates(&mut self, placed: &Placed, motion: f64) -> Option<&mut Near> {
        if motion >= self.until {
            let [least, largest] = MARGIN.map(|m| m * placed.scale);
            let mut margin = (LASTS * (motion - self.last)).clamp(least, largest);
            let gap = placed.gap();
            self.near = None;
            if gap > margin {
                margin = gap;
            } else {
                self.near = placed.find(margin, motion);
                while self.near.is_none() && margin < WIDEST * placed.scale {
                    let wider = margin * WIDENING;
                    self.near = placed.find(wider, motion);
                    margin = wider;
                }
            }
            self.until = motion + margin;
            self.clear = self.until;
        }
        self.last = motion;
        self.near.as_deref_mut()
    }

    /// Notes until when no candidate touches; to be called after a look at all of them.
    pub(crate) fn set_clear(&mut self, motion: f64) {
        self.clear = motion.min(self.until);
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
    fn find(&self, margin: f64, motion: f64) -> Option<Box<Near>> {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        let boxes = BoxTest::new(&self.rotation, &self.offset, margin);
        self.a.tree.visit_pairs(
            &self.b.tree,
            |a, b| boxes.meet(a, b),
            |i, j| {
                if boxes.meet(&self.a.boxes[i as usize], &self.b.boxes[j as usize]) {
                    pairs.push([i, j]);
                }
            },
        );
        let (in_a, in_b) = (members(&pairs, 0), members(&pairs, 1));
        let origin = Vector3::zeros();
        let posed_a: Vec<Posed> = in_a
            .iter()
            .filter_map(|&i| self.pose_a(i, &origin))
            .collect();
        let posed_b: Vec<Posed> = in_b
            .iter()
            .filter_map(|&j| self.pose_b(j, &origin))
            .collect();
        let mut region = (f64::INFINITY, Aabb::EMPTY);
        let mut gaps = Vec::new();
        pairs.retain(|[i, j]| {
            let (a, b) = (&posed_a[place(&in_a, *i)], &posed_b[place(&in_b, *j)]);
            let gap = a.gap(b, margin).max(0.0);
            if gap > margin {
                return false;
            }
            let common = Aabb {
                low: a.low.sup(&b.low).into(),
                high: a.high.inf(&b.high).into(),
            };
            if gap < region.0 {
                region = (gap, common);
            } else if gap == region.0 {
                region.1 = region.1.union(&common);
            }
            gaps.push(([*i, *j], gap));
            true
        });
        if gaps.is_empty() {
            return None;
        }
        gaps.sort_unstable_by_key(|(pair, _)| *pair);
        let (in_a, in_b) = (members(&pairs, 0), members(&pairs, 1));
        let candidate = |&([i, j], gap): &([u32; 2], f64)| Candidate {
            places: [place(&in_a, i) as u32, place(&in_b, j) as u32],
            clear: motion + gap,
        };
        let pairs = gaps.iter().map(candidate).collect();
        Some(Box::new(Near {
            centre: region.1.center().coords,
            pairs,
            in_a,
            in_b,
        }))
    }

    /// Tetrahedron i of A about an origin in A's axes.
    pub fn pose_a(&self, i: u32, origin: &Vector3) -> Option<Posed> {
        let cell = self.a.list.get(i as usize)?;
        Some(Posed::shifted(cell, &-origin))
    }

    /// Tetrahedron j of B about an origin in A's axes.
    pub fn pose_b(&self, j: u32, origin: &Vector3) -> Option<Posed> {
        let cell = self.b.list.get(j as usize)?;
        Some(Posed::new(cell, &self.rotation, &(self.offset - origin)))
    }
}

/// The tetrahedra of one side of the pairs, ascending.
fn members(pairs: &[[u32; 2]], side: usize) -> Vec<u32> {
    let mut list: Vec<u32> = pairs.iter().map(|p| p[side]).collect();
    list.sort_unstable();
    list.dedup();
    list
}

fn place(list: &[u32], i: u32) -> usize {
    list.binary_search(&i).unwrap_or(0)
}

/// Tells whether a box in A's axes and one in B's come within a margin, by the axes of both.
pub(crate) struct BoxTest {
    rotation: Matrix3,
    inverse: Matrix3,
    /// Absolute values of the two.
    spread: Matrix3,
    back: Matrix3,
    offset: Vector3,
    margin: f64,
}

impl BoxTest {
    pub fn new(rotation: &Matrix3, offset: &Vector3, margin: f64) -> Self {
        let inverse = rotation.transpose();
        Self {
            rotation: *rotation,
            inverse,
            spread: rotation.abs(),
            back: inverse.abs(),
            offset: *offset,
            margin,
        }
    }

    #[inline]
    pub fn meet(&self, a: &Aabb, b: &Aabb) -> bool {
        let (half_a, half_b) = ((a.high - a.low) * 0.5, (b.high - b.low) * 0.5);
        let between = self.rotation * b.center().coords + self.offset - a.center().coords;
        let reach = half_a + self.spread * half_b;
        if (0..3).any(|k| between[k].abs() > reach[k] + self.margin) {
            return false;
        }
        let between = self.inverse * between;
        let reach = half_b + self.back * half_a;
        (0..3).all(|k| between[k].abs() <= reach[k] + self.margin)
    }
}

/// Largest gap between a box and a turned box along the first one's axes, m.
pub(crate) fn gap_along_axes(a: &Aabb, b: &Aabb, rotation: &Matrix3, offset: &Vector3) -> f64 {
    let half = rotation.abs() * ((b.high - b.low) * 0.5);
    let centre = rotation * b.center().coords + offset;
    (0..3)
        .map(|k| (centre[k] - half[k] - a.high[k]).max(a.low[k] - centre[k] - half[k]))
        .fold(f64::NEG_INFINITY, f64::max)
}
