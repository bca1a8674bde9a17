//! Sums over the pairs of an update.

use super::BatchTotals;
use super::pairs::Pair;
use crate::contact::{BodyId, Load, Partner, RigidContact};
use crate::error::ContactError;
use crate::motion::Motion;
use crate::periodic::EdgeLoad;
use crate::walls::WallShape;
use serde::{Deserialize, Serialize};

/// Loads of bodies and of walls, and totals. Pairs are added in their order.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Sums {
    pub loads: Vec<Load>,
    pub walls: Vec<Load>,
    pub edges: [EdgeLoad; 3],
    pub totals: BatchTotals,
}

impl Sums {
    /// Resets the sums; loads of sleeping bodies stay as they are.
    pub fn begin(&mut self, awake: &[BodyId]) {
        for &i in awake {
            self.loads[i as usize] = Load::default();
        }
        self.walls.fill(Load::default());
        self.edges = Default::default();
        self.totals = BatchTotals::default();
    }

    /// Adds a pair. One whose B belongs to another batch is on the books there.
    pub fn add(&mut self, awake: &[bool], guests: &[bool], pair: &Pair) {
        if !guests.get(pair.b as usize).is_some_and(|guest| *guest) {
            self.book(pair);
            self.add_pair_to_edges(pair);
        }
        for contact in pair.contacts() {
            match contact.a {
                Partner::Body(a) if awake[a as usize] => {
                    self.loads[a as usize].add(contact, 0);
                }
                Partner::Body(_) => {}
                // A pair of a wall and a guest is not evaluated.
                Partner::Wall(w) => self.walls[w as usize].add(contact, 0),
            }
            if awake[contact.b as usize] {
                self.loads[contact.b as usize].add(contact, 1);
            }
        }
    }

    fn book(&mut self, pair: &Pair) {
        let totals = &mut self.totals;
        totals.candidates += 1;
        totals.energy_change += pair.energy() - pair.was;
        totals.broken += pair.broken;
        for contact in pair.contacts() {
            totals.touching += usize::from(contact.patch == 0);
            totals.energy += contact.potential();
            totals.spring_energy += contact.spring_energy;
        }
    }

    /// Adds the contacts of a pair with an image to the edges between.
    pub fn add_pair_to_edges(&mut self, pair: &Pair) {
        if pair.image != [0; 3] {
            for contact in pair.contacts() {
                self.add_to_edges(contact, pair.image);
            }
        }
    }

    fn add_to_edges(&mut self, contact: &RigidContact, image: [i32; 3]) {
        let mut on_a = Load::default();
        on_a.add(contact, 0);
        let on_a = EdgeLoad {
            total: on_a.total.force,
            damping: on_a.damping.force,
            friction: on_a.friction.force,
        };
        EdgeLoad::add_over(&mut self.edges, image, &on_a);
    }

    /// Refuses sums that are not finite: names the awake body of the lowest index with such a load, else the wall.
    pub fn check(
        &self,
        awake: &[BodyId],
        bodies: &[Motion],
        walls: &[Option<WallShape>],
    ) -> Result<(), ContactError> {
        let lost = |i: &&BodyId| !self.loads[**i as usize].is_finite();
        if let Some(&body) = awake.iter().find(lost) {
            return Err(load_not_finite(body as usize, bodies));
        }
        let loads = self.walls.iter().zip(walls);
        if let Some((_, Some(wall))) = loads.into_iter().find(|(load, _)| !load.is_finite()) {
            return Err(ContactError::Wall {
                name: wall.name().to_owned(),
                why: "the load of its contacts about its origin is not finite: the bodies on it, \
                      or its own motion, are out of the range of the numbers"
                    .to_owned(),
            });
        }
        Ok(())
    }
}

pub(super) fn load_not_finite(body: usize, bodies: &[Motion]) -> ContactError {
    ContactError::LoadNotFinite {
        body,
        position: bodies[body].frame.position.into(),
        velocity: bodies[body].velocity.into(),
    }
}
