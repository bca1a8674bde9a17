//! Awake relaxation: from time to time all bodies are woken until the pack is calm.
//!
//! A sleeping body passes a load on only when its own balance is lost by more than a share of
//! what it carries, so a pack of sleepers carries a part of every new load near the place
//! where it was put: its lower part is compressed too little. With all bodies awake the load
//! comes down within a few hundred steps. The numbers of bodies at which that is done follow a
//! geometric series that ends with the last body, so that its cost per body does not depend on how
//! many there are.
//!
//! What remains after that is the slowest oscillation of the whole column, which contacts damp
//! little and the longer it lasts the higher the pack is. The last relaxation therefore begins in a
//! medium that damps it critically, and ends without it. The medium moves no body at rest, and the
//! verification shows that they are.

use super::surface::{mean_top, positions};
use super::{Packing, Stage};
use crate::error::PackError;
use crate::report::Relaxation;
use femdem_mesh::Vector3;
use femdem_solve::Medium;
use serde::{Deserialize, Serialize};

/// The pack grows by this factor between two relaxations.
const GROWTH: f64 = std::f64::consts::SQRT_2;

/// Below this number of bodies all loads are near.
const FEWEST: f64 = 100.0;

/// A growing pack is calm at this mean net force over weight.
const CALM: f64 = 0.05;

/// Calm checks in a row that end a relaxation: an oscillation has moments without force.
const CALM_CHECKS: u32 = 2;

/// The smallest number of bodies in the series down from `count`, that itself left out, above
/// that of the last relaxation.
fn next_size(count: u32, relaxed: u32) -> Option<f64> {
    let least = FEWEST.max(f64::from(relaxed));
    let below = |size: &f64| Some(size / GROWTH);
    let series = std::iter::successors(below(&f64::from(count)), below);
    series.take_while(|&size| size > least).last()
}

/// An awake relaxation that is going on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Relaxing {
    /// Simulated time at which it began, s.
    began: f64,
    /// Steps taken when it began.
    first_step: u64,
    /// Checks in a row that were calm.
    calm: u32,
    /// Centroids when it began, m.
    from: Vec<Vector3>,
}

impl Packing {
    /// Whether the growing pack is to be relaxed before the next batch.
    pub(super) fn is_relaxation_due(&self) -> bool {
        let relaxed = self.job.relaxation.map_or(0, |r| r.bodies);
        self.job.spec.sleeping.enabled
            && next_size(self.job.spec.count, relaxed)
                .is_some_and(|next| f64::from(self.placed()) >= next)
    }

    /// Wakes all bodies and keeps them awake; once all are in, in a medium.
    pub(super) fn begin_relaxation(&mut self) -> Result<(), PackError> {
        self.world.set_sleeping(false);
        if self.job.stage == Stage::Settling {
            let medium = self.job.spec.medium;
            let drag = medium.drag.max(self.critical_drag());
            self.world.set_medium(Medium { drag, ..medium })?;
        }
        self.job.relaxing = Some(Relaxing {
            began: self.world.time(),
            first_step: self.world.steps(),
            calm: 0,
            from: positions(&self.world).map(|(_, p)| p).collect(),
        });
        self.wait_for_next_check();
        Ok(())
    }

    /// Drag rate that damps the slowest oscillation of the column critically, 1/s: its squared
    /// frequency is about g over the sag of the top under the weight of the column, and the sag
    /// about the mean penetration times the number of layers.
    fn critical_drag(&self) -> f64 {
        let diameter = self.job.spec.diameter();
        let contacts = self.world.contacts();
        let sum: f64 = contacts.iter().map(|c| c.penetration()).sum();
        let layers = (mean_top(&self.world, diameter) / diameter).max(1.0);
        let sag = layers * sum / contacts.len().max(1) as f64;
        if sag > 0.0 {
            2.0 * (self.job.spec.gravity / sag).sqrt()
        } else {
            0.0
        }
    }

    /// A check: ends the relaxation that is going on if the pack is calm, or if it has had its
    /// time; the last one first loses its medium.
    pub(super) fn check_relaxation(&mut self) -> Result<(), PackError> {
        let Some(relaxing) = self.job.relaxing.take() else {
            return Ok(());
        };
        let settling = &self.job.spec.settling;
        let found = self.world.residuals();
        let is_damped = self.world.parameters().medium != Medium::default();
        let is_calm = match self.job.stage {
            Stage::Depositing => found.mean_over_weight <= CALM,
            // Not the largest force: the medium would only delay single bodies that turn over.
            _ if is_damped => found.mean_over_weight <= settling.residual,
            _ => found.max_over_load <= settling.aim,
        };
        let longest = settling.longest_verification * self.job.spec.time_unit();
        let calm = if is_calm { relaxing.calm + 1 } else { 0 };
        let in_time = self.world.time() - relaxing.began <= longest;
        if calm < CALM_CHECKS && in_time {
            self.job.relaxing = Some(Relaxing { calm, ..relaxing });
            return Ok(());
        }
        if is_damped && in_time && self.job.stage == Stage::Settling {
            self.world.set_medium(Medium::default())?;
            self.job.relaxing = Some(Relaxing {
                calm: 0,
                ..relaxing
            });
            return Ok(());
        }
        let (mean, max) = self.displacements(&relaxing.from);
        self.job.relaxation = Some(Relaxation {
            bodies: self.placed(),
            steps: self.world.steps() - relaxing.first_step,
            mean_displacement_over_d: mean,
            max_displacement_over_d: max,
        });
        self.world.set_sleeping(true);
        Ok(())
    }

    /// Mean and largest distance of the centroids from where they were, over d.
    pub(super) fn displacements(&self, before: &[Vector3]) -> (f64, f64) {
        let diameter = self.job.spec.diameter();
        let (mut sum, mut max) = (0.0, 0.0_f64);
        for ((_, now), before) in positions(&self.world).zip(before) {
            let moved = (now - before).norm() / diameter;
            sum += moved;
            max = max.max(moved);
        }
        (sum / before.len().max(1) as f64, max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sizes_grow_by_the_root_of_two_up_to_the_last_body() {
        let near = |relaxed, expected: f64| {
            let next = next_size(1000, relaxed).unwrap();
            assert!((next - expected).abs() < 1e-9, "{next} after {relaxed}");
        };
        near(0, 125.0);
        near(128, 176.776_695_296_636_9);
        near(240, 250.0);
        near(256, 353.553_390_593_273_8);
        near(512, 707.106_781_186_547_5);
        assert_eq!(next_size(1000, 720), None);
        assert_eq!(next_size(140, 0), None);
        assert_eq!(next_size(0, 0), None);
    }
}
