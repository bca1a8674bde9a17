//! Awake relaxation: from time to time all bodies are woken until the pack is calm.
//!
//! A sleeping body passes a load on only when its own balance is lost by more than a share of its load, so that
//! a pack of sleepers carries a part of every new load near the place where it was put, and its lower part is
//! compressed too little. With all bodies awake the load comes down within a few hundred steps. Relaxations
//! take place at numbers of bodies that form a geometric series ending with the last body, so that their cost
//! per body does not depend on the size of the pack.
//!
//! What then remains is the slowest oscillation of the whole column, which contacts damp little and which lasts
//! longer the higher the pack is. A relaxation therefore damps kinetically: it stops all bodies whenever more
//! of them slow down than speed up, which is where that oscillation passes its equilibrium. This holds no body
//! that is not at rest by itself, as the verification shows. The steps are implicit: loads take time, not work,
//! to come down a column, and the effect of implicit steps on impacts does not matter where there are none.

use super::{Packing, Stage};
use crate::error::PackError;
use crate::report::Relaxation;
use crate::spec::LEAST_DAMPING;
use femdem_mesh::Vector3;
use femdem_solve::{Halo, ImplicitStep, Medium, TimeStepParameters, World};
use serde::{Deserialize, Serialize};

/// The pack grows by this factor between two relaxations.
const GROWTH: f64 = std::f64::consts::SQRT_2;

/// Below this number of bodies no relaxation is needed: all loads are near.
const FEWEST: f64 = 100.0;

/// Longest implicit step over sqrt(d/g): nothing falls.
const LONGEST_STEP: f64 = 0.02;

/// Largest multiple of the explicit limit: at twice this value bodies tremble, and a pack takes longer to
/// become calm.
const LARGEST_MULTIPLE: f64 = 6.0;

/// Calm checks in a row that count: an oscillation has moments at which forces vanish.
pub(super) const CALM_CHECKS: u32 = 3;

/// The smallest number of bodies in the geometric series down from `count` (itself excluded) that is above the
/// number at the last relaxation.
fn next_size(count: u32, relaxed: u32) -> Option<f64> {
    let least = FEWEST.max(f64::from(relaxed));
    let below = |size: &f64| Some(size / GROWTH);
    let series = std::iter::successors(below(&f64::from(count)), below);
    series.take_while(|&size| size > least).last()
}

/// An awake relaxation in progress.
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

    /// Wakes all bodies and keeps them awake.
    pub(super) fn begin_relaxation(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        self.step_implicitly()?;
        self.world.set_sleeping(false);
        self.job.relaxing = Some(Relaxing {
            began: self.world.time(),
            first_step: self.world.steps(),
            calm: 0,
            from: self.positions(halo)?,
        });
        self.wait_for_next_check();
        Ok(())
    }

    /// Makes the steps implicit, and longer than where bodies fall, because nothing falls in a relaxation. Jobs
    /// with local damping, rolling friction or attraction, which implicit steps do not have, continue with explicit steps.
    pub(super) fn step_implicitly(&mut self) -> Result<(), PackError> {
        let time_step = self.job.spec.time_step;
        let asked = time_step.implicit.unwrap_or_default();
        let is_plain = self.world.parameters().medium.local_damping == 0.0;
        if is_plain && self.job.spec.suits_implicit_steps() {
            self.world.set_time_step(TimeStepParameters {
                implicit: Some(ImplicitStep {
                    fall: LONGEST_STEP,
                    multiple: asked.multiple.min(LARGEST_MULTIPLE),
                }),
                ..time_step
            })?;
        }
        Ok(())
    }

    /// Work after a step of a relaxation.
    pub(super) fn step_relaxation(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        if self.world.is_slowing_on(halo)? {
            self.world.stop();
        }
        if self.world.time() >= self.job.next_check {
            self.guard()?;
            self.check_relaxation(halo)?;
            self.wait_for_next_check();
        }
        Ok(())
    }

    /// Ends the relaxation in progress if the pack is calm, or if its time is over.
    fn check_relaxation(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        let Some(relaxing) = self.job.relaxing.take() else {
            return Ok(());
        };
        let settling = &self.job.spec.settling;
        // Not the largest residual: single bodies that turn over would keep all others awake.
        let is_calm = self.mean_residual(halo)? <= settling.residual;
        let calm = if is_calm { relaxing.calm + 1 } else { 0 };
        let longest = settling.longest * self.job.spec.time_unit();
        let in_time = self.world.time() - relaxing.began <= longest;
        if calm < CALM_CHECKS && in_time {
            self.job.relaxing = Some(Relaxing { calm, ..relaxing });
            return Ok(());
        }
        let (mean, max) = self.displacements(&relaxing.from, halo)?;
        self.job.relaxation = Some(Relaxation {
            bodies: self.placed(),
            steps: self.world.steps() - relaxing.first_step,
            mean_displacement_over_d: mean,
            max_displacement_over_d: max,
        });
        if self.job.stage == Stage::Settling {
            return self.begin_verification(halo);
        }
        self.world
            .set_time_step(self.job.spec.falling_time_step())?;
        self.world.set_sleeping(true);
        Ok(())
    }

    /// Mean over the bodies of the net force over the larger of weight and mean contact force.
    fn mean_residual(&self, halo: &mut dyn Halo) -> Result<f64, PackError> {
        let residual = |world: &World, body| world.body_residual(body);
        let residuals = self.world.of_whole(halo, residual)?.into_iter().flatten();
        Ok(residuals.sum::<f64>() / f64::from(self.placed().max(1)))
    }

    /// Whether bodies come to rest only in the medium, if at all, because contacts hardly damp. In other jobs
    /// the medium would only hold up bodies that tip over.
    pub(super) fn rests_in_the_medium(&self) -> bool {
        self.job.spec.damping_ratio < LEAST_DAMPING && self.job.spec.medium != Medium::default()
    }

    /// Until the next attempt the medium acts where nothing else brings bodies to rest. If bodies may sleep at
    /// all, they do so by the limits of the verification, so that those still in motion continue without the
    /// cost of the rest, and hardly any load is held back from the rest.
    pub(super) fn rest_between_tries(&mut self) -> Result<(), PackError> {
        if self.rests_in_the_medium() {
            self.world.set_medium(self.job.spec.medium)?;
        }
        if self.job.spec.sleeping.enabled {
            let limit = self.job.spec.settling.kinetic_energy;
            let strict = self.job.spec.sleeping.for_ringing(limit);
            self.world
                .set_time_step(self.job.spec.falling_time_step())?;
            self.world.set_sleep_rule(strict)?;
        }
        Ok(())
    }

    /// Mean and largest distance of the centroids from where they were, over d.
    pub(super) fn displacements(
        &self,
        before: &[Vector3],
        halo: &mut dyn Halo,
    ) -> Result<(f64, f64), PackError> {
        let diameter = self.job.spec.diameter();
        let (mut sum, mut max) = (0.0, 0.0_f64);
        for (now, before) in self.positions(halo)?.iter().zip(before) {
            let moved = (now - before).norm() / diameter;
            sum += moved;
            max = max.max(moved);
        }
        Ok((sum / before.len().max(1) as f64, max))
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
