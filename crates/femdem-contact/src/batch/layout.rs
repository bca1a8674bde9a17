//! Layout of pairs in memory.
//!
//! Pairs come and go as bodies move, and a new one takes the slot of one that has ended. If the pack does not
//! fit the processor cache, evaluating pairs out of memory order costs a cache miss per pair. No result
//! depends on the layout.

use super::pairs::PairTable;

/// Pairs are laid out again when one in this many lies in memory before its predecessor in the order of
/// evaluation.
const OUT_OF_ORDER: usize = 8;

/// Fewer pairs than this fit a cache in any order.
const FEW: usize = 1024;

impl PairTable {
    /// Sorts the pairs in memory by order of evaluation, if all of them are evaluated and many are out of
    /// order.
    pub(super) fn lay_out(&mut self) {
        let live = self.slots.len() - self.free.len();
        if live < FEW || self.order.len() != live {
            return;
        }
        let back = self.order.windows(2).filter(|w| w[1] < w[0]).count();
        if back * OUT_OF_ORDER < live {
            return;
        }
        let mut moved_to = vec![0; self.slots.len()];
        let mut pairs = Vec::with_capacity(live + live / 8);
        for (rank, slot) in (0..).zip(&mut self.order) {
            moved_to[*slot as usize] = rank;
            // Cloned while the old ones still exist, so that the boxed parts are allocated in this order too.
            pairs.push(self.slots[*slot as usize].clone());
            *slot = rank;
        }
        self.slots = pairs;
        self.free.clear();
        for neighbour in self.neighbours.iter_mut().flatten() {
            neighbour.slot = moved_to[neighbour.slot as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::pairs::Neighbour;
    use crate::body_shape::Kind;
    use crate::contact::Partner;

    /// Bodies in a row, each a neighbour of the four before and the four after it; entered from the last to
    /// the first.
    fn scrambled(bodies: u32) -> PairTable {
        let mut table = PairTable::default();
        for body in 0..bodies as usize {
            table.set_body(body, Kind::Convex);
        }
        for body in (0..bodies).rev() {
            let near = body.saturating_sub(4)..bodies.min(body + 5);
            let list: Vec<u32> = near.filter(|&other| other != body).collect();
            table.set_neighbours(body, &list);
        }
        // Some are removed and leave gaps among the others.
        for body in (4..bodies).step_by(50) {
            table.set_neighbours(body, &[]);
        }
        table
    }

    /// The pairs of each body, as found through its list.
    fn found(table: &PairTable) -> Vec<Vec<(Partner, u32)>> {
        let of = |list: &Vec<Neighbour>| {
            let pair = |n: &Neighbour| table.slot(n.slot);
            list.iter().map(|n| (pair(n).a, pair(n).b)).collect()
        };
        table.neighbours.iter().map(of).collect()
    }

    fn evaluated(table: &PairTable) -> Vec<(Partner, u32)> {
        table.evaluated().map(|pair| (pair.a, pair.b)).collect()
    }

    #[test]
    fn pairs_lie_in_the_order_of_evaluation_and_are_still_found() {
        const BODIES: u32 = 600;
        let all: Vec<u32> = (0..BODIES).collect();
        let mut table = scrambled(BODIES);
        let lists = found(&table);
        assert!(!table.free.is_empty());
        table.refresh_order(&[true; BODIES as usize], &all);
        let count = table.order_len() as u32;
        assert!(count > FEW as u32);
        assert!(table.order().iter().copied().eq(0..count));
        assert!(table.free.is_empty() && table.slots.len() == count as usize);
        assert_eq!(found(&table), lists);
        let pairs = evaluated(&table);
        assert!(pairs.is_sorted());

        // Where sleeping bodies have sleeping neighbours, not all pairs are evaluated: nothing is moved,
        // nothing is lost.
        let mut asleep = scrambled(BODIES);
        let mut awake = [true; BODIES as usize];
        awake[..20].fill(false);
        asleep.refresh_order(&awake, &all[20..]);
        assert!(!asleep.order().is_sorted());
        assert_eq!(found(&asleep), lists);
        let reached = |(a, b): &&(Partner, u32)| *a >= Partner::Body(20) || *b >= 20;
        let expected: Vec<_> = pairs.iter().filter(reached).copied().collect();
        assert_eq!(evaluated(&asleep), expected);
    }
}
