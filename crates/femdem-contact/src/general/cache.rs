//! Cached lists of the tetrahedra of a pair that can meet, and how long they stay valid.

use crate::mark::Mark;
use crate::tets::boxes::{BoxTest, gap_along_axes};
use crate::tets::cells::Cells;
use crate::tets::near_list::{Candidate, NearList, Search, Within, members, place};
use crate::tets::posed::Posed;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::convert::Infallible;

/// The cache of the general kernel for a pair: that it is apart, or which tetrahedra can meet. It never
/// changes which contacts are found; a fresh cache gives the same result to round-off.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GeneralCache {
    /// Its validity is measured by `moved`.
    list: NearList<Near>,
    /// Accumulated relative motion of the two, m: less than the sum of their travels if they move together.
    moved: f64,
    /// Sum of the travels at the last evaluation, m, and the relative pose then.
    travelled: f64,
    here: Mark,
}

/// Candidate pairs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Near {
    /// Origin of the integrals, in A's axes: the middle of the region that can overlap.
    pub centre: Vector3,
    /// Tetrahedra of A and of B that appear in pairs, ascending.
    pub in_a: Vec<u32>,
    pub in_b: Vec<u32>,
    /// In ascending order of their indices in the lists.
    pub pairs: Vec<Candidate>,
}

/// Two solids and the pose of B in A's axes.
pub(crate) struct Placed<'a> {
    pub a: &'a Cells,
    pub b: &'a Cells,
    pub rotation: Matrix3,
    pub offset: Vector3,
    /// Reference length of the margins, m.
    pub scale: f64,
}

impl GeneralCache {
    /// Whether the pair was close enough for contact when the cache was last renewed.
    pub fn is_near(&self) -> bool {
        self.list.near().is_some()
    }

    /// Whether the cache alone shows that the pair is apart at this `motion`.
    pub fn is_clear(&self, motion: f64) -> bool {
        self.list.is_clear(self.moved + (motion - self.travelled))
    }

    /// Records the present pose, and returns the accumulated relative motion, m.
    pub(crate) fn advance(&mut self, placed: &Placed, motion: f64) -> f64 {
        let travelled = motion - self.travelled;
        let moved = self
            .here
            .moved(&placed.rotation, &placed.offset, placed.b.radius);
        self.moved += if moved < travelled { moved } else { travelled };
        self.travelled = motion;
        self.here = Mark::new(&placed.rotation, &placed.offset);
        self.moved
    }

    /// The candidates, renewed if they have expired; `moved` as returned by [`advance`](Self::advance).
    pub(crate) fn candidates(&mut self, placed: &Placed, moved: f64) -> Option<&mut Near> {
        let Ok(near) = self.list.renewed(placed, moved);
        near
    }

    /// Records until when no candidate touches; to be called after all of them have been evaluated.
    pub(crate) fn set_clear(&mut self, moved: f64) {
        self.list.set_clear(moved);
    }
}

impl Search for Placed<'_> {
    type List = Near;
    type Failure = Infallible;

    fn length(&self) -> f64 {
        self.scale
    }

    /// A lower bound of the distance: the gap of the boxes along the axes of A or B.
    fn gap(&self) -> f64 {
        let (a, b) = (self.a.tree.bounds(), self.b.tree.bounds());
        let in_a = gap_along_axes(&a, &b, &self.rotation, &self.offset);
        let inverse = self.rotation.transpose();
        let in_b = gap_along_axes(&b, &a, &inverse, &-(inverse * self.offset));
        in_a.max(in_b)
    }

    /// Pairs of tetrahedra that touch or may come to touch within `margin`.
    fn find(&self, margin: f64, motion: f64) -> Result<Option<Box<Near>>, Infallible> {
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
        let posed = |[i, j]: [u32; 2]| {
            let a = posed_a.get(place(&in_a, i))?;
            Some([a, posed_b.get(place(&in_b, j))?])
        };
        let Some(within) = Within::new(&pairs, margin, posed) else {
            return Ok(None);
        };
        let (in_a, in_b) = (members(&within.pairs, 0), members(&within.pairs, 1));
        Ok(Some(Box::new(Near {
            centre: within.centre,
            pairs: within.candidates([&in_a, &in_b], motion),
            in_a,
            in_b,
        })))
    }
}

impl Placed<'_> {
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
