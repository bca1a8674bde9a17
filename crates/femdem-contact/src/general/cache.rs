//! Cached lists of the tetrahedra of a pair that can meet, and how long they stay valid.

use crate::mark::Mark;
use crate::tets::boxes::{BoxTest, gap_along_axes};
use crate::tets::cells::Cells;
use crate::tets::clip::NOISE;
use crate::tets::current::Current;
use crate::tets::near_list::{Candidate, NearList, Search, Within, members, place};
use crate::tets::posed::Posed;
use femdem_mesh::bvh::Aabb;
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

/// Candidates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Near {
    /// Origin of the integrals, in A's axes: the middle of the region that can overlap.
    pub centre: Vector3,
    /// Tetrahedra of A and of B among the candidates, ascending.
    pub tets: [Vec<u32>; 2],
    /// Pairs of which one has a face on the skin, in ascending order of their indices in the lists. Nothing touches
    /// unless two of these do.
    pub pairs: Vec<Candidate>,
    /// Pairs of which neither has.
    pub inside: Vec<Candidate>,
    /// By side, nodes inside it and tetrahedra of the other, in ascending order.
    pub nodes: [Vec<Candidate>; 2],
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

    /// Records for a pair without candidates that it is apart while the sum of the travels is below `until`, m.
    pub(crate) fn set_apart(&mut self, until: f64) {
        *self = Self {
            list: NearList::apart(until),
            ..Self::default()
        };
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
        let tets = [0, 1].map(|side| members(&pairs, side));
        let origin = Vector3::zeros();
        let posed = [0, 1].map(|side| -> Vec<Posed> {
            let mut tet = Current::default();
            let pose = |&i: &u32| {
                self.pose(side, i, &origin, &mut tet)?;
                Some(tet.planes())
            };
            tets[side].iter().filter_map(pose).collect()
        });
        let found = |[i, j]: [u32; 2]| {
            let a = posed[0].get(place(&tets[0], i))?;
            Some([a, posed[1].get(place(&tets[1], j))?])
        };
        let Some(within) = Within::new(&pairs, margin, found) else {
            return Ok(None);
        };
        let nodes = [0, 1].map(|side| self.nodes(side, &boxes, margin));
        let lists = [0, 1].map(|side| {
            let hosts = nodes[1 - side].iter().map(|(pair, _)| pair[1]);
            let mut list: Vec<u32> = within
                .pairs
                .iter()
                .map(|pair| pair[side])
                .chain(hosts)
                .collect();
            list.sort_unstable();
            list.dedup();
            list
        });
        let on_skin = |[i, j]: [u32; 2]| {
            let skin = |cells: &Cells, i: u32| cells.list.get(i as usize).map_or(0, |c| c.tet.skin);
            skin(self.a, i) | skin(self.b, j) != 0
        };
        let (pairs, inside) = within
            .pairs
            .iter()
            .zip(within.candidates([&lists[0], &lists[1]], motion))
            .partition::<Vec<_>, _>(|(pair, _)| on_skin(**pair));
        let candidates =
            |list: Vec<(&[u32; 2], Candidate)>| list.into_iter().map(|c| c.1).collect();
        let nodes = [0, 1].map(|side| {
            let candidate = |([node, tet], gap): &([u32; 2], f64)| Candidate {
                places: [*node, place(&lists[1 - side], *tet) as u32],
                clear: motion + gap,
            };
            nodes[side].iter().map(candidate).collect()
        });
        Ok((!pairs.is_empty()).then(|| {
            Box::new(Near {
                centre: within.centre,
                pairs: candidates(pairs),
                inside: candidates(inside),
                nodes,
                tets: lists,
            })
        }))
    }
}

impl Placed<'_> {
    pub fn side(&self, side: usize) -> &Cells {
        [self.a, self.b][side]
    }

    /// Sets `room` to a side's tetrahedron about an origin in A's axes.
    #[inline(always)]
    pub fn pose(&self, side: usize, i: u32, origin: &Vector3, room: &mut Current) -> Option<()> {
        let tet = &self.side(side).list.get(i as usize)?.tet;
        *room = if side == 0 {
            tet.shifted(&-origin)
        } else {
            tet.placed(&self.rotation, &(self.offset - origin), 1.0)
        };
        Some(())
    }

    /// A side's point about an origin in A's axes.
    pub fn point(&self, side: usize, x: &Vector3, origin: &Vector3) -> Vector3 {
        if side == 0 {
            x - origin
        } else {
            self.rotation * x + (self.offset - origin)
        }
    }

    /// Nodes inside a side and tetrahedra of the other within `margin` of them, ascending, with their distances, m.
    fn nodes(&self, side: usize, boxes: &BoxTest, margin: f64) -> Vec<([u32; 2], f64)> {
        let (own, other) = (self.side(side), self.side(1 - side));
        let mut found = Vec::new();
        let origin = Vector3::zeros();
        let mut room = Current::default();
        let meet = |a: &Aabb, b: &Aabb| {
            if side == 0 {
                boxes.meet(a, b)
            } else {
                boxes.meet(b, a)
            }
        };
        own.inner_tree.visit_pairs(&other.tree, meet, |node, tet| {
            let x = self.point(side, &own.inner[node as usize].at, &origin);
            if self.pose(1 - side, tet, &origin, &mut room).is_some() {
                // On a face between two tetrahedra round-off must not put it outside both.
                let gap = room.gap(&x, NOISE);
                if gap <= margin {
                    found.push(([node, tet], gap));
                }
            }
        });
        found.sort_unstable_by_key(|(pair, _)| *pair);
        found
    }
}
