//! Sums over the pairs of an update.

use super::BatchTotals;
use super::pairs::Pair;
use crate::contact::{BodyId, Load, Partner};

/// Loads of awake bodies and of walls, and totals, from pairs that are added in their order.
pub(super) struct Sums<'a> {
    awake: &'a [bool],
    loads: &'a mut [Load],
    walls: &'a mut [Load],
    totals: &'a mut BatchTotals,
}

impl<'a> Sums<'a> {
    /// Without any pair; loads of sleeping bodies stay as they are.
    pub fn new(
        awake: &'a [bool],
        awake_list: &[BodyId],
        loads: &'a mut [Load],
        walls: &'a mut [Load],
        totals: &'a mut BatchTotals,
    ) -> Self {
        for &i in awake_list {
            loads[i as usize] = Load::default();
        }
        walls.fill(Load::default());
        *totals = BatchTotals::default();
        Self {
            awake,
            loads,
            walls,
            totals,
        }
    }

    pub fn add(&mut self, pair: &Pair) {
        self.totals.candidates += 1;
        for contact in pair.contacts() {
            self.totals.touching += usize::from(contact.patch == 0);
            self.totals.energy += contact.energy;
            self.totals.spring_energy += contact.spring_energy;
            match contact.a {
                Partner::Body(a) if self.awake[a as usize] => {
                    self.loads[a as usize].add(contact, 0);
                }
                Partner::Body(_) => {}
                Partner::Wall(w) => self.walls[w as usize].add(contact, 0),
            }
            if self.awake[contact.b as usize] {
                self.loads[contact.b as usize].add(contact, 1);
            }
        }
    }
}
