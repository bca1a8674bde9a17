//! Cached lists of the tetrahedra of a pair that can meet, and how long they stay valid.

use super::operand::{Inverted, Operand};
use super::shape::DeformableShape;
use crate::tets::boxes::{BoxTest, gap_along_axes};
use crate::tets::current::Current;
use crate::tets::near_list::{Candidate, NearList, Search, Within, members, place};
use crate::tets::posed::Posed;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

/// The cached state of a pair: that it is apart, or which tetrahedra can meet.
pub(crate) type Candidates = NearList<Near>;

/// Tetrahedra that can meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Near {
    /// Origin of the integrals, m: the middle of the region that could overlap when the list was made.
    pub origin: Vector3,
    pub sides: [Members; 2],
    /// In ascending order of their indices in the lists.
    pub pairs: Vec<Candidate>,
}

/// The tetrahedra of one side that appear in pairs, ascending, and their nodes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Members {
    pub tets: Vec<u32>,
    /// Contact nodes, ascending, including the masters of slaves; none for rigid bodies.
    pub nodes: Vec<u32>,
    /// By tetrahedron, the indices of its nodes in `nodes`.
    pub corners: Vec<[u32; 4]>,
    /// Indices of slaves and of their masters in `nodes`.
    pub slaves: Vec<(u32, [u32; 4])>,
}

/// A tree over the tetrahedra of one side, in world axes for deformable bodies, in body axes for rigid ones.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tree<'a> {
    pub tree: &'a Bvh,
    pub boxes: &'a [Aabb],
    /// Where the body is seen, from where its boxes are, m: its image in periodic space.
    pub away: Vector3,
}

impl<'a> Tree<'a> {
    /// The tree of a body where it is.
    pub fn here(tree: &'a Bvh, boxes: &'a [Aabb]) -> Self {
        let away = Vector3::zeros();
        Self { tree, boxes, away }
    }
}

/// The two sides of a pair with their trees. B is deformable.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sides<'a> {
    pub operands: [Operand<'a>; 2],
    pub trees: [Tree<'a>; 2],
}

/// A side and an inverted tetrahedron of it.
pub(crate) type Failure = (usize, Inverted);

impl Sides<'_> {
    /// The test of A's boxes against B's, in the axes of A, if A is rigid.
    fn box_test(&self, margin: f64) -> Option<BoxTest> {
        match self.operands[0] {
            Operand::Deformable(..) => None,
            Operand::Rigid(_, frame) | Operand::Wall(_, frame) => {
                let inverse = frame.rotation.transpose();
                Some(BoxTest::new(&inverse, &-(inverse * frame.position), margin))
            }
        }
    }

    /// Approximate centre of the tetrahedra of the pairs, from those of B.
    fn middle(&self, pairs: &[[u32; 2]]) -> Option<Vector3> {
        let box_of = |pair: &[u32; 2]| self.trees[1].boxes.get(pair[1] as usize);
        let first = box_of(pairs.first()?)?;
        let all = pairs
            .iter()
            .filter_map(box_of)
            .fold(*first, |x, y| x.union(y));
        Some(all.center().coords)
    }
}

impl Sides<'_> {
    /// The list of those of `pairs` that touch or may come to touch within `margin`.
    fn listed(
        &self,
        pairs: &[[u32; 2]],
        margin: f64,
        motion: f64,
    ) -> Result<Option<Box<Near>>, Failure> {
        let Some(origin) = self.middle(pairs) else {
            return Ok(None);
        };
        let tets = [0, 1].map(|side| members(pairs, side));
        let mut posed: [Vec<Posed>; 2] = Default::default();
        for side in 0..2 {
            for &i in &tets[side] {
                let mut tet = Current::default();
                let found = self.operands[side].pose(i, 1.0, &origin, &mut tet);
                let found = found.map_err(|inverted| (side, inverted))?;
                posed[side].extend(found.map(|()| tet.planes()));
            }
        }
        let posed = |[i, j]: [u32; 2]| {
            let a = posed[0].get(place(&tets[0], i))?;
            Some([a, posed[1].get(place(&tets[1], j))?])
        };
        let Some(within) = Within::new(pairs, margin, posed) else {
            return Ok(None);
        };
        let sides = [0, 1].map(|side| self.operands[side].members(members(&within.pairs, side)));
        Ok(Some(Box::new(Near {
            origin: origin + within.centre,
            pairs: within.candidates([&sides[0].tets, &sides[1].tets], motion),
            sides,
        })))
    }
}

impl Search for Sides<'_> {
    type List = Near;
    type Failure = Failure;

    fn length(&self) -> f64 {
        let [a, b] = self.operands.map(|o| o.length());
        if a > 0.0 { a.min(b) } else { b }
    }

    /// A lower bound of the distance, from the boxes around both, m.
    fn gap(&self) -> f64 {
        let [a, b] = self.trees.map(|t| t.tree.bounds());
        let away = self.trees[0].away;
        match self.operands[0] {
            Operand::Deformable(..) => (0..3)
                .map(|k| {
                    let (low, high) = (a.low[k] + away[k], a.high[k] + away[k]);
                    (low - b.high[k]).max(b.low[k] - high)
                })
                .fold(f64::NEG_INFINITY, f64::max),
            Operand::Rigid(_, frame) | Operand::Wall(_, frame) => {
                let inverse = frame.rotation.transpose();
                let in_a = gap_along_axes(&a, &b, &inverse, &-(inverse * frame.position));
                in_a.max(gap_along_axes(&b, &a, &frame.rotation, &frame.position))
            }
        }
    }

    /// Pairs of tetrahedra that touch or may come to touch within `margin`.
    fn find(&self, margin: f64, motion: f64) -> Result<Option<Box<Near>>, Failure> {
        let mut pairs: Vec<[u32; 2]> = Vec::new();
        let test = self.box_test(margin);
        let away = self.trees[0].away;
        let meet = |a: &Aabb, b: &Aabb| match &test {
            Some(test) => test.meet(a, b),
            None => (0..3).all(|k| {
                let (low, high) = (a.low[k] + away[k], a.high[k] + away[k]);
                low - margin <= b.high[k] && b.low[k] - margin <= high
            }),
        };
        let [a, b] = &self.trees;
        a.tree.visit_pairs(b.tree, meet, |i, j| {
            if let (Some(x), Some(y)) = (a.boxes.get(i as usize), b.boxes.get(j as usize))
                && meet(x, y)
            {
                pairs.push([i, j]);
            }
        });
        self.listed(&pairs, margin, motion)
    }
}

impl Members {
    /// Tetrahedra of a deformable body, ascending, with their nodes.
    pub(crate) fn new(shape: &DeformableShape, tets: Vec<u32>) -> Self {
        let nodes_of = |i: &u32| shape.tets()[*i as usize].nodes;
        let mut nodes: Vec<u32> = tets.iter().flat_map(nodes_of).collect();
        let masters: Vec<u32> = nodes
            .iter()
            .filter_map(|&i| shape.masters(i))
            .flatten()
            .copied()
            .collect();
        nodes.extend(masters);
        nodes.sort_unstable();
        nodes.dedup();
        let at = |i: u32| place(&nodes, i) as u32;
        let slave = |i: &u32| Some((at(*i), shape.masters(*i)?.map(at)));
        Self {
            corners: tets.iter().map(|i| nodes_of(i).map(at)).collect(),
            slaves: nodes.iter().filter_map(slave).collect(),
            tets,
            nodes,
        }
    }
}

impl Operand<'_> {
    /// Tetrahedra (ascending) with their nodes.
    fn members(&self, tets: Vec<u32>) -> Members {
        match self {
            Self::Deformable(shape, _) => Members::new(shape, tets),
            Self::Rigid(..) | Self::Wall(..) => Members {
                tets,
                ..Members::default()
            },
        }
    }

    /// Boxes around the tetrahedra of a deformable body, m.
    pub(crate) fn boxes(&self, boxes: &mut Vec<Aabb>) {
        boxes.clear();
        if let Self::Deformable(shape, x) = self {
            let corners = (0..shape.tet_count() as u32).filter_map(|i| shape.corners(i, x));
            boxes.extend(corners.map(|c| Aabb::of_points(c.map(Point3::from))));
            // The update has checked that there is a position for every node.
            debug_assert_eq!(boxes.len(), shape.tet_count());
        }
    }
}
