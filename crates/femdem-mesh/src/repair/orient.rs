//! Edges, and the orientation of facets.

use super::clean::Surface;
use crate::MeshError;
use crate::polyhedron::sides;
use std::collections::VecDeque;

/// A side of a facet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// Its vertices, the smaller first.
    pub(super) edge: [u32; 2],
    pub(super) facet: u32,
    /// Whether the loop runs from the smaller vertex to the larger.
    pub(super) forward: bool,
}

/// A neighbour of a facet, and whether the two are oriented differently.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Neighbour {
    of: u32,
    facet: u32,
    opposed: bool,
}

impl Surface {
    /// All sides, those of one edge beside each other.
    pub(super) fn sorted_sides(&self) -> Vec<Side> {
        let mut all: Vec<Side> = (0..)
            .zip(&self.loops)
            .flat_map(|(facet, corners)| {
                sides(corners).map(move |[a, b]| Side {
                    edge: [a.min(b), a.max(b)],
                    facet,
                    forward: a < b,
                })
            })
            .collect();
        all.sort_unstable();
        all
    }

    /// Every edge has two facets.
    pub(super) fn check_edges(&self) -> Result<(), MeshError> {
        let sides = self.sorted_sides();
        let edges_of = |bad: fn(usize) -> bool| {
            let edges = sides.chunk_by(|s, t| s.edge == t.edge);
            let (mut count, mut facets) = (0, Vec::new());
            for edge in edges.filter(|edge| bad(edge.len())) {
                count += 1;
                facets.extend(edge.iter().map(|s| s.facet as usize));
            }
            (count, self.list(facets))
        };
        let (count, facets) = edges_of(|n| n > 2);
        if count > 0 {
            return Err(MeshError::NonManifoldFacets {
                what: "edge",
                facets,
                count,
            });
        }
        match edges_of(|n| n < 2) {
            (0, _) => Ok(()),
            (edges, facets) => Err(MeshError::OpenSurface { edges, facets }),
        }
    }

    /// Reverses loops so that neighbours have the same orientation, as few as possible in each part of the
    /// surface, and returns their number. Every edge must have two facets.
    pub(super) fn orient(&mut self) -> Result<usize, MeshError> {
        let neighbours = self.neighbours();
        let mut flip: Vec<Option<bool>> = vec![None; self.loops.len()];
        let mut clashes = Vec::new();
        for seed in 0..self.loops.len() {
            if flip[seed].is_some() {
                continue;
            }
            flip[seed] = Some(false);
            let mut part = vec![seed];
            let mut queue = VecDeque::from([seed]);
            while let Some(i) = queue.pop_front() {
                let from = neighbours.partition_point(|n| (n.of as usize) < i);
                for next in neighbours[from..].iter().take_while(|n| n.of as usize == i) {
                    let j = next.facet as usize;
                    let wanted = flip[i].map(|flipped| flipped != next.opposed);
                    if flip[j].is_none() {
                        flip[j] = wanted;
                        part.push(j);
                        queue.push_back(j);
                    } else if flip[j] != wanted {
                        clashes.extend([i, j]);
                    }
                }
            }
            let flipped = part.iter().filter(|&&i| flip[i] == Some(true)).count();
            if 2 * flipped > part.len() {
                for i in part {
                    flip[i] = flip[i].map(|flipped| !flipped);
                }
            }
        }
        if !clashes.is_empty() {
            return Err(MeshError::OneSided {
                facets: self.list(clashes),
            });
        }
        let mut count = 0;
        for (corners, flip) in self.loops.iter_mut().zip(flip) {
            if flip == Some(true) {
                reverse(corners);
                count += 1;
            }
        }
        Ok(count)
    }

    /// The neighbours, sorted by facet.
    fn neighbours(&self) -> Vec<Neighbour> {
        let sides = self.sorted_sides();
        let mut all: Vec<Neighbour> = sides
            .windows(2)
            .filter(|pair| pair[0].edge == pair[1].edge)
            .flat_map(|pair| {
                let opposed = pair[0].forward == pair[1].forward;
                let one = |s: &Side, t: &Side| Neighbour {
                    of: s.facet,
                    facet: t.facet,
                    opposed,
                };
                [one(&pair[0], &pair[1]), one(&pair[1], &pair[0])]
            })
            .collect();
        all.sort_unstable();
        all
    }

    /// Reverses all loops if the surface encloses a negative volume; returns whether it did.
    pub(super) fn turn_outward(&mut self) -> bool {
        // The volume is taken about a point of the surface, so that a body far from the origin loses no digits.
        let Some(&about) = self.points.first() else {
            return false;
        };
        let at = |v: u32| self.points[v as usize] - about;
        let cone = |corners: &Vec<u32>| -> f64 {
            let apex = at(corners[0]);
            corners
                .windows(2)
                .map(|side| apex.dot(&at(side[0]).cross(&at(side[1]))))
                .sum()
        };
        let inside_out = self.loops.iter().map(cone).sum::<f64>() < 0.0;
        if inside_out {
            self.loops.iter_mut().for_each(|corners| reverse(corners));
        }
        inside_out
    }
}

/// Reverses a loop, keeping its first vertex.
fn reverse(corners: &mut [u32]) {
    if let Some((_, others)) = corners.split_first_mut() {
        others.reverse();
    }
}
