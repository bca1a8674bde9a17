//! Settling and the final verification with all bodies awake.

use super::ranks::largest;
use super::relax::CALM_CHECKS;
use super::{Packing, Stage};
use crate::error::PackError;
use crate::report::Verification;
use femdem_mesh::Vector3;
use femdem_solve::{Halo, Medium};
use serde::{Deserialize, Serialize};

/// Checks in a row that must pass, and the time between them in units of sqrt(d/g).
const CHECKS: u32 = 10;
const CHECK_INTERVAL: f64 = 0.1;

/// In a job with implicit steps this many of the last checks that must pass in a row follow explicit steps; in
/// others all do.
const EXPLICIT_CHECKS: u32 = 3;

/// If the verification moves a body by more than this, over d, it begins anew from the present places.
const LARGEST_SHIFT: f64 = 1e-3;

/// In a calm check all bodies are within this part of the limits, so that the trial that follows need not wait.
const CALM: f64 = 0.5;

/// The phase of the verification; all bodies are awake.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) enum Attempt {
    /// Implicit steps let the loads that sleeping bodies held back come to rest.
    Calming(Calming),
    /// An attempt.
    Trial(Trial),
}

/// Checks of the calming, and how many in a row were calm.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Calming {
    checks: u32,
    calm: u32,
    /// The start of the series of passed checks, if these count.
    passing: Option<Start>,
}

/// An attempt at verification, with explicit steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Trial {
    /// The state that the bodies are to keep.
    start: Start,
    /// Checks since steps are explicit.
    checks: u32,
}

/// The state at the beginning of the verification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Start {
    /// Simulated time, s.
    time: f64,
    /// Steps taken.
    step: u64,
    /// Centroids, m.
    from: Vec<Vector3>,
    /// Mean top, m.
    top: f64,
}

impl Packing {
    /// Waits until all bodies sleep or pass the checks, relaxes them, and verifies.
    pub(super) fn step_settling(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        self.world.step_on(halo)?;
        if self.job.relaxing.is_some() {
            return self.step_relaxation(halo);
        }
        let is_quiet = self.check_if_due(halo)?.is_some_and(|c| c.enough);
        let longest = self.fall_time() + self.job.spec.settling.longest * self.job.spec.time_unit();
        if is_quiet || self.awake_count(halo)? == 0 || self.stage_time() > longest {
            return if self.job.spec.sleeping.enabled {
                self.begin_relaxation(halo)
            } else {
                self.begin_verification(halo)
            };
        }
        Ok(())
    }

    pub(super) fn begin_verification(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        self.enter(Stage::Verifying);
        self.begin_attempt(halo)
    }

    fn begin_attempt(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        self.world.set_medium(Medium::default())?;
        if !self.job.spec.sleeping.enabled {
            return self.begin_trial(None, halo);
        }
        self.step_implicitly()?;
        self.world.set_sleeping(false);
        self.job.attempt = Some(Attempt::Calming(Calming::default()));
        self.job.passed = 0;
        self.wait_for_next_check();
        Ok(())
    }

    /// Continues with explicit steps; passes of the calming count if their start is known.
    fn begin_trial(
        &mut self,
        passing: Option<Start>,
        halo: &mut dyn Halo,
    ) -> Result<(), PackError> {
        // Not only by the steps that brought the bodies to rest: those dissipate energy themselves.
        self.world.step_explicitly()?;
        self.world.set_sleeping(false);
        self.job.passed = match passing {
            Some(_) => self.job.passed.min(CHECKS - EXPLICIT_CHECKS),
            None => 0,
        };
        let start = passing.map_or_else(|| self.start(halo), Ok)?;
        self.job.attempt = Some(Attempt::Trial(Trial { start, checks: 0 }));
        self.job.tries += 1;
        self.wait_for_next_check();
        Ok(())
    }

    fn start(&self, halo: &mut dyn Halo) -> Result<Start, PackError> {
        Ok(Start {
            time: self.world.time(),
            step: self.world.steps(),
            from: self.positions(halo)?,
            top: self.mean_top(halo)?,
        })
    }

    /// Keeps all bodies awake until they pass the checks without having moved, or the time is over. If a check
    /// fails after enough checks for all to pass, bodies at rest sleep (if sleeping is on) until the others are
    /// at rest, too.
    pub(super) fn step_verification(&mut self, halo: &mut dyn Halo) -> Result<(), PackError> {
        self.world.step_on(halo)?;
        let longest = self.job.spec.settling.longest * self.job.spec.time_unit();
        let is_over = self.stage_time() > longest;
        match self.job.attempt.take() {
            Some(Attempt::Trial(trial)) => self.step_trial(trial, is_over, halo),
            _ if is_over => {
                self.world.set_medium(Medium::default())?;
                self.begin_trial(None, halo)
            }
            Some(Attempt::Calming(calming)) => self.step_calming(calming, halo),
            None if self.awake_count(halo)? == 0 => self.begin_attempt(halo),
            None => {
                // If sleeping is off, bodies are at rest when they pass the checks.
                let may_sleep = self.job.spec.sleeping.enabled;
                match self.check_if_due(halo)? {
                    Some(check) if check.enough && !may_sleep => self.begin_attempt(halo),
                    _ => Ok(()),
                }
            }
        }
    }

    fn step_calming(&mut self, mut calming: Calming, halo: &mut dyn Halo) -> Result<(), PackError> {
        if let Some(check) = self.check_if_due(halo)? {
            let counts = self.job.spec.time_step.implicit.is_some();
            calming.checks += 1;
            calming.calm = if check.calm { calming.calm + 1 } else { 0 };
            calming.passing = match calming.passing.take() {
                _ if !counts || self.job.passed == 0 => None,
                None => Some(self.start(halo)?),
                passing => passing,
            };
            let is_calm = calming.calm >= CALM_CHECKS;
            let has_passed = self.job.passed >= CHECKS - EXPLICIT_CHECKS;
            if is_calm && (has_passed || !counts) {
                return self.begin_trial(calming.passing, halo);
            }
            // One that tips over slowly may stay within the limits for long.
            if calming.checks > CHECKS && calming.calm == 0 {
                self.world.step_explicitly()?;
                return self.rest_between_tries();
            }
        }
        self.job.attempt = Some(Attempt::Calming(calming));
        Ok(())
    }

    fn step_trial(
        &mut self,
        mut trial: Trial,
        is_over: bool,
        halo: &mut dyn Halo,
    ) -> Result<(), PackError> {
        if is_over {
            self.job.next_check = self.world.time();
        }
        if let Some(check) = self.check_if_due(halo)? {
            trial.checks += 1;
            if check.enough || is_over {
                let found = self.verification(&trial.start, halo)?;
                if found.max_displacement_over_d > LARGEST_SHIFT && !is_over {
                    return self.begin_trial(None, halo);
                }
                self.job.verification = Some(found);
                self.update_top(halo)?;
                self.enter(Stage::Done);
                return Ok(());
            }
            let has_failed = trial.checks > CHECKS && self.job.passed == 0;
            if has_failed && (self.job.spec.sleeping.enabled || self.rests_in_the_medium()) {
                return self.rest_between_tries();
            }
        }
        self.job.attempt = Some(Attempt::Trial(trial));
        Ok(())
    }

    /// How far the bodies have moved during the verification, and whether it was passed.
    fn verification(&self, start: &Start, halo: &mut dyn Halo) -> Result<Verification, PackError> {
        let diameter = self.job.spec.diameter();
        let top = self.mean_top(halo)?;
        let (mean, max) = self.displacements(&start.from, halo)?;
        Ok(Verification {
            passed: self.job.passed >= CHECKS,
            tries: self.job.tries,
            steps: self.world.steps() - start.step,
            time: self.world.time() - start.time,
            mean_displacement_over_d: mean,
            max_displacement_over_d: max,
            mean_top_change_over_d: (top - start.top) / diameter,
        })
    }

    /// Checks residuals and kinetic energies if it is time.
    fn check_if_due(&mut self, halo: &mut dyn Halo) -> Result<Option<Check>, PackError> {
        if self.world.time() < self.job.next_check {
            return Ok(None);
        }
        self.wait_for_next_check();
        self.guard()?;
        self.update_top(halo)?;
        let settling = &self.job.spec.settling;
        let found = self.world.residuals();
        let [residual, energy] =
            largest([found.max_over_load, found.kinetic_energy_over_mgd], halo)?;
        let within = |share: f64| {
            residual <= share * settling.residual && energy <= share * settling.kinetic_energy
        };
        let calm = within(CALM);
        self.job.passed = if within(1.0) { self.job.passed + 1 } else { 0 };
        let enough = self.job.passed >= CHECKS;
        Ok(Some(Check { enough, calm }))
    }

    pub(super) fn wait_for_next_check(&mut self) {
        let interval = CHECK_INTERVAL * self.job.spec.time_unit();
        self.job.next_check = self.world.time() + interval;
    }
}

/// The outcome of a check.
struct Check {
    /// Whether enough checks in a row have passed.
    enough: bool,
    /// Whether all bodies are calm.
    calm: bool,
}
