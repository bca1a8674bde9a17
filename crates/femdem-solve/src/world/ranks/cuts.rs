//! Space shared out by recursive bisection: each cut halves the ranks of a box, and its cost in proportion.

use crate::error::SolveError;
use crate::halo::Halo;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Parts into which a box is divided to find its cut; twice, one within the other.
const PARTS: usize = 128;

/// A plane across an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Cut {
    axis: usize,
    at: f64,
}

/// The boxes of all ranks, as the tree of the cuts between them: the ranks of a node are consecutive, and the cuts of its lower
/// half follow its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Cuts {
    ranks: usize,
    cuts: Vec<Cut>,
}

/// A box that several ranks share.
#[derive(Clone, Copy)]
struct Node {
    /// Its cut in the list.
    index: usize,
    ranks: usize,
    low: Vector3,
    high: Vector3,
}

impl Node {
    fn axis(&self) -> usize {
        (self.high - self.low).imax()
    }

    /// Ranks of the lower half.
    fn lower(&self) -> usize {
        self.ranks / 2
    }

    fn halves(&self, cut: Cut) -> [Self; 2] {
        let [mut lower, mut upper] = [*self, *self];
        lower.high[cut.axis] = cut.at;
        upper.low[cut.axis] = cut.at;
        lower.index = self.index + 1;
        upper.index = self.index + self.lower();
        lower.ranks = self.lower();
        upper.ranks = self.ranks - self.lower();
        [lower, upper]
    }
}

impl Cuts {
    /// Cuts such that each rank has about the same cost: of bodies with a place (m) and a cost, those of this rank. The ranks
    /// find the same cuts.
    pub fn find(bodies: &[(Vector3, u64)], halo: &mut dyn Halo) -> Result<Self, SolveError> {
        let mut ends = [f64::MAX; 6];
        for (x, _) in bodies {
            for k in 0..3 {
                ends[k] = ends[k].min(x[k]);
                ends[3 + k] = ends[3 + k].min(-x[k]);
            }
        }
        halo.least(&mut ends)?;
        if ends[0] > -ends[3] {
            // No bodies at all.
            ends = [0.0; 6];
        }
        let ranks = halo.size();
        let root = Node {
            index: 0,
            ranks,
            low: Vector3::new(ends[0], ends[1], ends[2]),
            high: -Vector3::new(ends[3], ends[4], ends[5]),
        };
        let none = Cut { axis: 0, at: 0.0 };
        let mut cuts = Self {
            ranks,
            cuts: vec![none; ranks.saturating_sub(1)],
        };
        // The nodes of a level, and which of them each body is in.
        let mut level = vec![root];
        let mut places = vec![0; bodies.len()];
        while level.iter().any(|node| node.ranks > 1) {
            let found = halve(&level, bodies, &places, halo)?;
            let mut next = Vec::new();
            let mut first = Vec::new();
            for (node, cut) in level.iter().zip(&found) {
                first.push(next.len());
                match cut {
                    Some(cut) => {
                        cuts.cuts[node.index] = *cut;
                        next.extend(node.halves(*cut));
                    }
                    None => next.push(*node),
                }
            }
            for (place, (x, _)) in places.iter_mut().zip(bodies) {
                let is_above = found[*place].is_some_and(|cut| x[cut.axis] >= cut.at);
                *place = first[*place] + usize::from(is_above);
            }
            level = next;
        }
        Ok(cuts)
    }

    /// All space for the first rank.
    pub fn to_first(ranks: usize) -> Self {
        let (axis, at) = (0, f64::INFINITY);
        Self {
            ranks,
            cuts: vec![Cut { axis, at }; ranks.saturating_sub(1)],
        }
    }

    /// Whether the first of several ranks has all space.
    pub fn are_to_first(&self) -> bool {
        self.ranks > 1 && self.cuts.iter().all(|cut| cut.at == f64::INFINITY)
    }

    /// Number of ranks.
    pub fn ranks(&self) -> usize {
        self.ranks
    }

    /// Whether what was read can be.
    pub fn is_sound(&self) -> bool {
        self.ranks > 0
            && self.cuts.len() == self.ranks - 1
            && self.cuts.iter().all(|cut| cut.axis < 3)
    }

    /// The rank whose box a place is in.
    pub fn owner(&self, x: &Vector3) -> usize {
        let (mut index, mut first, mut ranks) = (0, 0, self.ranks);
        while ranks > 1 {
            let (cut, lower) = (self.cuts[index], ranks / 2);
            if x[cut.axis] >= cut.at {
                (index, first, ranks) = (index + lower, first + lower, ranks - lower);
            } else {
                (index, ranks) = (index + 1, lower);
            }
        }
        first
    }

    /// The ranks whose boxes are within `reach` (m) of a place along each axis, ascending.
    pub fn near(&self, x: &Vector3, reach: f64) -> Vec<usize> {
        let mut found = Vec::new();
        let mut nodes = vec![(0, 0, self.ranks)];
        while let Some((index, first, ranks)) = nodes.pop() {
            if ranks <= 1 {
                found.push(first);
                continue;
            }
            let (cut, lower) = (self.cuts[index], ranks / 2);
            let above = x[cut.axis] - cut.at;
            if above >= -reach {
                nodes.push((index + lower, first + lower, ranks - lower));
            }
            if above < reach {
                nodes.push((index + 1, first, lower));
            }
        }
        found
    }
}

/// The cuts of the nodes of a level that have several ranks.
fn halve(
    level: &[Node],
    bodies: &[(Vector3, u64)],
    places: &[usize],
    halo: &mut dyn Halo,
) -> Result<Vec<Option<Cut>>, SolveError> {
    // Where to look, and the cost below it.
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for node in level {
        let axis = node.axis();
        spans.push([node.low[axis], node.high[axis]]);
    }
    let mut below = vec![0; level.len()];
    let mut total: Vec<u64> = Vec::new();
    for round in 0..2 {
        let mut costs = vec![0_u64; (PARTS + 1) * level.len()];
        for ((x, cost), &place) in bodies.iter().zip(places) {
            let ([low, high], x) = (spans[place], x[level[place].axis()]);
            let part = (x - low) / (high - low) * PARTS as f64;
            // The last part is for what lies above.
            let part = if x < low {
                continue;
            } else if part < PARTS as f64 {
                part as usize
            } else {
                PARTS
            };
            costs[place * (PARTS + 1) + part] += cost;
        }
        halo.sum(&mut costs)?;
        for (k, node) in level.iter().enumerate() {
            let own = &costs[k * (PARTS + 1)..][..=PARTS];
            if round == 0 {
                total.push(own.iter().sum());
            }
            let wanted = total[k] as f64 * node.lower() as f64 / node.ranks as f64;
            let mut part = 0;
            while part + 1 < PARTS && (below[k] + own[part]) as f64 <= wanted {
                below[k] += own[part];
                part += 1;
            }
            if round == 1 && (2 * below[k] + own[part]) as f64 <= 2.0 * wanted {
                // Nearer to what is wanted: what costs more than its share may lie below.
                part += 1;
            }
            let [low, high] = spans[k];
            let at = |part: usize| low + (high - low) * (part as f64 / PARTS as f64);
            spans[k] = [at(part), at(part + 1)];
        }
    }
    let cut = |(node, span): (&Node, &[f64; 2])| {
        (node.ranks > 1).then(|| Cut {
            axis: node.axis(),
            at: span[0],
        })
    };
    Ok(level.iter().zip(&spans).map(cut).collect())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::halo::Alone;

    /// Alone, but one of several.
    pub struct OneOf(pub usize);

    impl Halo for OneOf {
        fn rank(&self) -> usize {
            0
        }
        fn size(&self) -> usize {
            self.0
        }
        fn least(&mut self, values: &mut [f64]) -> Result<(), SolveError> {
            Alone.least(values)
        }
        fn sum(&mut self, counts: &mut [u64]) -> Result<(), SolveError> {
            Alone.sum(counts)
        }
        fn swap(&mut self, with: &[usize], out: Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, SolveError> {
            Alone.swap(with, out)
        }
        fn send(
            &mut self,
            out: Vec<(usize, Vec<u8>)>,
        ) -> Result<Vec<(usize, Vec<u8>)>, SolveError> {
            Alone.send(out)
        }
    }

    fn scattered(count: usize) -> Vec<(Vector3, u64)> {
        let mut x = 0.37_f64;
        let mut next = || {
            x = (x * 997.0 + 0.123).fract();
            x
        };
        // Denser near one corner, in a flat box.
        let mut place = || Vector3::new(3.0 * next() * next(), 2.0 * next(), 0.3 * next());
        (0..count).map(|i| (place(), 1 + i as u64 % 3)).collect()
    }

    #[test]
    fn each_rank_has_its_share_of_the_cost() {
        let bodies = scattered(4000);
        let total: u64 = bodies.iter().map(|b| b.1).sum();
        for ranks in [1, 2, 3, 5, 8] {
            let cuts = Cuts::find(&bodies, &mut OneOf(ranks)).unwrap();
            let mut costs = vec![0; ranks];
            for (x, cost) in &bodies {
                costs[cuts.owner(x)] += cost;
            }
            for cost in &costs {
                let share = *cost as f64 * ranks as f64 / total as f64;
                assert!((share - 1.0).abs() < 0.03, "{ranks}: {costs:?}");
            }
        }
    }

    #[test]
    fn what_costs_more_than_its_share_does_not_take_the_others_along() {
        let at = |x: f64, cost: u64| (Vector3::new(x, 0.0, 0.0), cost);
        for costs in [[1, 100], [100, 1]] {
            let bodies = [at(0.3, costs[0]), at(1.0, costs[1])];
            let cuts = Cuts::find(&bodies, &mut OneOf(2)).unwrap();
            assert_eq!(bodies.map(|(x, _)| cuts.owner(&x)), [0, 1], "{costs:?}");
        }
    }

    #[test]
    fn those_near_a_place_are_the_owners_of_places_around_it() {
        let bodies = scattered(500);
        let cuts = Cuts::find(&bodies, &mut OneOf(7)).unwrap();
        let reach = 0.1;
        for (x, _) in &bodies {
            let near = cuts.near(x, reach);
            assert!(near.windows(2).all(|w| w[0] < w[1]));
            assert!(near.contains(&cuts.owner(x)));
            assert_eq!(cuts.near(x, 0.0), [cuts.owner(x)]);
            for corner in 0..8 {
                let side = |k: u32| if corner >> k & 1 == 0 { -0.99 } else { 0.99 };
                let there = x + Vector3::new(side(0), side(1), side(2)) * reach;
                assert!(near.contains(&cuts.owner(&there)));
            }
        }
    }

    #[test]
    fn nothing_and_bodies_in_one_place_have_owners_too() {
        let none = Cuts::find(&[], &mut OneOf(4)).unwrap();
        assert!(none.owner(&Vector3::zeros()) < 4);
        let one = Cuts::find(&[(Vector3::repeat(1.0), 1); 9], &mut OneOf(4)).unwrap();
        assert!(one.owner(&Vector3::repeat(1.0)) < 4);
    }
}
