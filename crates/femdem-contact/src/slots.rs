//! Numbers of bodies and walls: given out lowest first, and given out again once taken back.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The numbers in use, out of those ever given out.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Slots {
    /// Numbers ever given out.
    count: u32,
    /// Those of them that are not in use.
    free: BTreeSet<u32>,
}

impl FromIterator<u32> for Slots {
    /// These numbers in use, ascending, out of all up to the last of them.
    fn from_iter<T: IntoIterator<Item = u32>>(numbers: T) -> Self {
        let mut slots = Self::default();
        for number in numbers {
            slots.extend_to(number);
            slots.count = number + 1;
        }
        slots
    }
}

impl Slots {
    /// Counts the numbers below `count` among those given out.
    pub fn extend_to(&mut self, count: u32) {
        self.free.extend(self.count..count);
        self.count = self.count.max(count);
    }

    /// Gives out the lowest number that is not in use. The second is whether it is new: lists by number grow by one then.
    pub fn take(&mut self) -> (u32, bool) {
        if let Some(slot) = self.free.pop_first() {
            return (slot, false);
        }
        self.count += 1;
        (self.count - 1, true)
    }

    /// Gives out this number, if it is not in use and was given out before, or is the next new one; the second is as of
    /// [`take`](Self::take).
    pub fn take_this(&mut self, slot: u32) -> Option<(u32, bool)> {
        let is_new = slot == self.count;
        if is_new {
            self.count += 1;
        } else if !self.free.remove(&slot) {
            return None;
        }
        Some((slot, is_new))
    }

    /// Takes a number back; returns whether it was in use.
    pub fn give_back(&mut self, slot: u32) -> bool {
        self.holds(slot) && self.free.insert(slot)
    }

    /// Whether a number is in use.
    pub fn holds(&self, slot: u32) -> bool {
        slot < self.count && !self.free.contains(&slot)
    }

    /// How many are in use.
    pub fn len(&self) -> usize {
        self.total() - self.free.len()
    }

    /// How many were ever given out: the length of lists by number.
    pub fn total(&self) -> usize {
        self.count as usize
    }

    /// The numbers in use, ascending.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        (0..self.count).filter(|slot| !self.free.contains(slot))
    }

    /// Whether what was read can be: a number that is free was given out.
    pub fn is_sound(&self) -> bool {
        self.free.last().is_none_or(|&slot| slot < self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_free_number_is_given_out_again() {
        let mut slots = Slots::default();
        for i in 0..4 {
            assert_eq!(slots.take(), (i, true));
        }
        assert!(slots.give_back(2) && slots.give_back(0) && !slots.give_back(2));
        assert!(!slots.give_back(4) && !slots.holds(0) && slots.holds(1));
        assert_eq!(slots.iter().collect::<Vec<_>>(), [1, 3]);
        assert_eq!((slots.len(), slots.total()), (2, 4));
        assert_eq!(
            [slots.take(), slots.take(), slots.take()],
            [(0, false), (2, false), (4, true)]
        );
        assert!(slots.give_back(1) && slots.give_back(3));
        let taken = [3, 3, 6, 5].map(|slot| slots.take_this(slot));
        assert_eq!(taken, [Some((3, false)), None, None, Some((5, true))]);
        assert_eq!(slots.take(), (1, false));
    }
}
