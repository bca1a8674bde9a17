//! Settling and the final verification with all bodies awake.

use super::surface::{mean_top, positions};
use super::{Packing, Stage};
use crate::error::PackError;
use crate::report::Verification;
use femdem_solve::Medium;

/// Without reaching the aim, this many times the passes in a row are needed.
const PASSES_WITHOUT_AIM: u32 = 3;

impl Packing {
    /// Waits until all bodies sleep or pass the checks, then wakes them all until they are calm.
    pub(super) fn step_settling(&mut self) -> Result<(), PackError> {
        self.world.step()?;
        if self.job.relaxing.is_some() {
            if self.world.time() >= self.job.next_check {
                self.guard()?;
                self.check_relaxation()?;
                self.wait_for_next_check();
            }
            return match self.job.relaxing {
                Some(_) => Ok(()),
                None => self.begin_verification(),
            };
        }
        let quiet = self.check_if_due()?.is_some_and(|c| c.enough);
        let longest =
            self.fall_time() + self.job.spec.settling.longest_settling * self.job.spec.time_unit();
        if quiet || self.world.awake_count() == 0 || self.stage_time() > longest {
            if self.job.spec.sleeping.enabled {
                self.begin_relaxation()?;
            } else {
                self.begin_verification()?;
            }
        }
        Ok(())
    }

    fn begin_verification(&mut self) -> Result<(), PackError> {
        self.world.set_medium(Medium::default())?;
        self.world.set_sleeping(false);
        let before = positions(&self.world).map(|(_, p)| p).collect();
        let top = mean_top(&self.world, self.job.spec.diameter());
        self.job.reference = Some((before, top));
        self.enter(Stage::Verifying);
        self.wait_for_next_check();
        Ok(())
    }

    /// Keeps all bodies awake until they pass the checks or the time is over.
    pub(super) fn step_verification(&mut self) -> Result<(), PackError> {
        self.world.step()?;
        let settling = self.job.spec.settling;
        let longest = settling.longest_verification * self.job.spec.time_unit();
        let over = self.stage_time() > longest;
        if over {
            self.job.next_check = self.world.time();
        }
        if let Some(check) = self.check_if_due()?
            && (check.enough || over)
        {
            self.job.verification = Some(self.verification());
            self.update_top();
            self.job.reference = None;
            self.enter(Stage::Done);
        }
        Ok(())
    }

    /// How far the verification has moved the bodies, and whether it was passed.
    fn verification(&self) -> Verification {
        let diameter = self.job.spec.diameter();
        let top = mean_top(&self.world, diameter);
        let (before, top_before) = match &self.job.reference {
            Some((positions, top)) => (positions.as_slice(), *top),
            None => (&[][..], top),
        };
        let (mean, max) = self.displacements(before);
        Verification {
            passed: self.job.passed >= self.job.spec.settling.checks,
            steps: self.world.steps() - self.job.stage_steps,
            time: self.stage_time(),
            mean_displacement_over_d: mean,
            max_displacement_over_d: max,
            mean_top_change_over_d: (top - top_before) / diameter,
        }
    }

    /// Checks residuals and kinetic energies if it is time.
    fn check_if_due(&mut self) -> Result<Option<Check>, PackError> {
        if self.world.time() < self.job.next_check {
            return Ok(None);
        }
        self.wait_for_next_check();
        self.guard()?;
        self.update_top();
        let settling = &self.job.spec.settling;
        let found = self.world.residuals();
        let passed = found.max_over_load <= settling.residual
            && found.kinetic_energy_over_mgd <= settling.kinetic_energy;
        self.job.passed = if passed { self.job.passed + 1 } else { 0 };
        let patient = settling.checks.saturating_mul(PASSES_WITHOUT_AIM);
        let needed = if found.max_over_load <= settling.aim {
            settling.checks
        } else {
            patient
        };
        let enough = self.job.passed >= needed;
        Ok(Some(Check { enough }))
    }

    pub(super) fn wait_for_next_check(&mut self) {
        let interval = self.job.spec.settling.check_interval * self.job.spec.time_unit();
        self.job.next_check = self.world.time() + interval;
    }
}

/// The outcome of a check.
struct Check {
    /// Whether enough checks in a row have passed.
    enough: bool,
}
