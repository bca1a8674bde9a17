//! Lists of the tetrahedra of a pair that can meet: their validity and renewal.

use super::posed::Posed;
use femdem_mesh::Vector3;
use femdem_mesh::bvh::Aabb;
use serde::{Deserialize, Serialize};

/// Number of evaluations at the present speed that a list usually lasts.
const LASTS: f64 = 128.0;

/// Least and largest margin of the lists over the field's length. The main cost of a list is finding it:
/// candidates that cannot touch yet are skipped by their own travel budget.
const MARGIN: [f64; 2] = [4e-3, 4e-2];

/// If nothing is found within the margin, it is widened by this factor, up to this part of the field's
/// length, so that pairs that pass close by are searched less often.
const WIDENING: f64 = 4.0;
const WIDEST: f64 = 0.25;

/// The cached state of a pair: that it is apart, or a list `N` of what can meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct NearList<N> {
    /// The list is valid while the motion is below this, m.
    until: f64,
    /// Nothing touches while the motion is below this, m.
    clear: f64,
    /// Motion at the last evaluation, m.
    last: f64,
    /// `None`: the bodies are apart.
    near: Option<Box<N>>,
}

impl<N> Default for NearList<N> {
    fn default() -> Self {
        Self {
            until: 0.0,
            clear: 0.0,
            last: 0.0,
            near: None,
        }
    }
}

/// A tetrahedron of A and one of B that may come to touch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Candidate {
    /// Indices in the lists of A's and of B's tetrahedra.
    pub places: [u32; 2],
    /// The two are apart while the motion is below this, m.
    pub clear: f64,
}

/// Two bodies at their present poses.
pub(crate) trait Search {
    type List;
    type Failure;

    /// Reference length of the margins, m.
    fn length(&self) -> f64;

    /// Up to which margin a search that finds nothing is repeated, m.
    fn widest(&self) -> f64 {
        WIDEST * self.length()
    }

    /// Number of evaluations at the present speed that a list should last.
    fn lasts(&self) -> f64 {
        LASTS
    }

    /// A lower bound of the distance, m.
    fn gap(&self) -> f64;

    /// The parts that touch or may come to touch within `margin`.
    fn find(&self, margin: f64, motion: f64) -> Result<Option<Box<Self::List>>, Self::Failure>;
}

impl<N> NearList<N> {
    /// Nothing touches while the motion is below `until`, m.
    pub fn apart(until: f64) -> Self {
        Self {
            until,
            clear: until,
            ..Self::default()
        }
    }

    /// Whether the list alone shows that nothing touches at this `motion`.
    pub fn is_clear(&self, motion: f64) -> bool {
        motion < self.clear
    }

    /// Nothing touches while the motion is below this, m.
    pub fn clear(&self) -> f64 {
        self.clear
    }

    /// Whether the list is no longer valid.
    pub fn is_expired(&self, motion: f64) -> bool {
        motion >= self.until
    }

    /// The list, expired or not.
    pub fn near(&self) -> Option<&N> {
        self.near.as_deref()
    }

    /// The list, renewed if it has expired.
    pub fn renewed<S: Search<List = N>>(
        &mut self,
        pair: &S,
        motion: f64,
    ) -> Result<Option<&mut N>, S::Failure> {
        if self.is_expired(motion) {
            let length = pair.length();
            let [least, largest] = MARGIN.map(|m| m * length);
            let mut margin = (pair.lasts() * (motion - self.last)).clamp(least, largest);
            let gap = pair.gap();
            self.near = None;
            if gap > margin {
                margin = gap;
            } else {
                self.near = pair.find(margin, motion)?;
                while self.near.is_none() && margin < pair.widest() {
                    let wider = margin * WIDENING;
                    self.near = pair.find(wider, motion)?;
                    margin = wider;
                }
            }
            self.until = motion + margin;
            self.clear = self.until;
        }
        self.last = motion;
        Ok(self.near.as_deref_mut())
    }

    /// Records until when no candidate touches; to be called after all of them have been evaluated.
    pub fn set_clear(&mut self, motion: f64) {
        self.clear = motion.min(self.until);
    }
}

/// Pairs of tetrahedra within a margin.
pub(crate) struct Within {
    /// Ascending.
    pub pairs: Vec<[u32; 2]>,
    /// Lower bounds of their distances, m.
    pub gaps: Vec<f64>,
    /// The middle of the region that the nearest ones can share.
    pub centre: Vector3,
}

impl Within {
    /// Those of `pairs`, posed by `posed`, that are no farther apart than `margin`; `None` if there are none.
    pub fn new<'p>(
        pairs: &[[u32; 2]],
        margin: f64,
        posed: impl Fn([u32; 2]) -> Option<[&'p Posed; 2]>,
    ) -> Option<Self> {
        let mut region = (f64::INFINITY, Aabb::EMPTY);
        let mut found = Vec::new();
        for &pair in pairs {
            let Some([a, b]) = posed(pair) else {
                continue;
            };
            let gap = a.gap(b, margin).max(0.0);
            if gap > margin {
                continue;
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
            found.push((pair, gap));
        }
        if found.is_empty() {
            return None;
        }
        found.sort_unstable_by_key(|(pair, _)| *pair);
        let (pairs, gaps) = found.into_iter().unzip();
        Some(Self {
            pairs,
            gaps,
            centre: region.1.center().coords,
        })
    }

    /// The candidates, with their indices in the lists of A's and of B's tetrahedra.
    pub fn candidates(&self, lists: [&[u32]; 2], motion: f64) -> Vec<Candidate> {
        let each = self.pairs.iter().zip(&self.gaps);
        each.map(|(pair, gap)| Candidate {
            places: [0, 1].map(|side| place(lists[side], pair[side]) as u32),
            clear: motion + gap,
        })
        .collect()
    }
}

/// The tetrahedra of one side that appear in pairs, ascending.
pub(crate) fn members(pairs: &[[u32; 2]], side: usize) -> Vec<u32> {
    let mut list: Vec<u32> = pairs.iter().map(|p| p[side]).collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// The index of a tetrahedron in a list that contains it.
pub(crate) fn place(list: &[u32], i: u32) -> usize {
    let place = list.partition_point(|x| *x < i);
    debug_assert_eq!(list.get(place), Some(&i), "the list contains it");
    place
}
