//! The static end of a run: all bodies are brought to rest under the forces that act then.

use femdem_solve::{SolveError, WorldRelaxation};
use serde::{Deserialize, Serialize};

use super::{BoundaryEntry, Ending, LoadEntry, MotionEntry, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;

/// Steps after which a run interrupts its relaxation. It does not depend on the clock, because each part begins
/// from rest.
const PART: u64 = 4000;

/// How bodies are brought to rest after the duration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct RelaxEntry {
    /// Largest unbalanced force on a node or a body, over the mean contact force.
    pub tolerance: f64,
    /// Largest number of steps.
    pub steps: u64,
}

impl Default for RelaxEntry {
    fn default() -> Self {
        let WorldRelaxation { tolerance, steps } = WorldRelaxation::default();
        Self { tolerance, steps }
    }
}

/// Result of a relaxation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RelaxSummary {
    /// Whether the tolerance was reached.
    pub converged: bool,
    /// Largest unbalanced force on a node or a body, over the mean contact force or, where nothing touches,
    /// over the loads (see [`WorldRelaxation::tolerance`]).
    pub residual: f64,
    /// Steps that were taken.
    pub steps: u64,
    /// Deformable bodies that Newton's method put into equilibrium first: those that supports hold and that touched nothing.
    pub solved: u32,
}

/// A run after its motion.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Relaxing {
    /// Why the motion ended.
    pub ending: Ending,
    /// Its last step \[s\].
    pub time_step: f64,
    pub so_far: RelaxSummary,
}

impl RelaxSummary {
    /// Whether it is over.
    pub(super) fn is_done(&self, entry: &RelaxEntry) -> bool {
        self.converged || self.steps >= entry.steps
    }
}

impl Simulation {
    /// The next part of the relaxation, after those summarised in `so_far`.
    pub(super) fn relax_on(
        &mut self,
        entry: &RelaxEntry,
        so_far: &RelaxSummary,
    ) -> Result<RelaxSummary, Error> {
        let part = WorldRelaxation {
            tolerance: entry.tolerance,
            steps: PART.min(entry.steps.saturating_sub(so_far.steps)),
        };
        self.load_bodies(self.world.time())?;
        let before = so_far.steps;
        let solved = match before {
            0 => {
                let found = self.world.solve_single_bodies(entry.tolerance);
                found.map_err(|error| self.named(error))?
            }
            _ => so_far.solved,
        };
        match self.world.relax(&part) {
            Ok(report) => Ok(RelaxSummary {
                converged: true,
                residual: report.residual,
                steps: before + report.steps.iter().sum::<u64>(),
                solved,
            }),
            Err(SolveError::NotConverged { residual, .. }) => Ok(RelaxSummary {
                converged: false,
                residual,
                steps: before + part.steps,
                solved,
            }),
            Err(error) => Err(self.named(error)),
        }
    }
}

impl Scenario {
    /// Refuses a relaxation while motions or loads still change, of bodies that crack and of bonded ones.
    pub(super) fn check_relaxation(&self, simulation: &Simulation) -> Result<(), Error> {
        let Some(RelaxEntry { tolerance, steps }) = self.relax else {
            return Ok(());
        };
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            let allowed = "a positive, finite number, such as 1e-4";
            return Err(wrong("relax.tolerance", &tolerance.to_string(), allowed));
        }
        if steps == 0 {
            return Err(wrong("relax.steps", "0", "at least 1"));
        }
        if self.has_breakable() {
            let allowed =
                "breakable bodies crack in motion: leave it out, or make the bodies deformable";
            return Err(wrong("relax", "given", allowed));
        }
        if !self.bond.is_empty() || simulation.bond_counts()[0] > 0 {
            let allowed = "bonds need explicit steps: leave it out, or the [[bond]] entries";
            return Err(wrong("relax", "given", allowed));
        }
        if self.controls().next().is_some() {
            let allowed =
                "with controlled walls use [rest]: a relaxation would hold them where they are";
            return Err(wrong("relax", "given", allowed));
        }
        let conditions = self.body.iter().flat_map(|body| &body.boundary);
        let motions = self.motions().map(|motion| motion.end());
        let on_bodies = self.load.iter().map(LoadEntry::settled_from);
        let loads = conditions.map(BoundaryEntry::settled_from).chain(on_bodies);
        let ends = [
            ("motion", motions.fold(0.0, f64::max)),
            ("rise or table", loads.fold(0.0, f64::max)),
        ];
        for (name, end) in ends {
            // Sums of periods need not be exact to the last bit.
            if end > self.duration * (1.0 + 1e-9) {
                let value = if end < f64::MAX {
                    format!("to {end} s")
                } else {
                    "without end".to_owned()
                };
                let allowed =
                    "with [relax] all motions and changes of loads end within the duration";
                return Err(wrong(name, &value, allowed));
            }
        }
        Ok(())
    }
}

impl MotionEntry {
    /// When it is over \[s\].
    fn end(&self) -> f64 {
        match *self {
            Self::Linear { end, .. } | Self::Turn { end, .. } => end,
            Self::Shake {
                frequency,
                start,
                periods,
                ..
            }
            | Self::Rock {
                frequency,
                start,
                periods,
                ..
            } => start + lasting(periods, 1.0 / frequency, 0.0),
            Self::Tap {
                frequency,
                interval,
                start,
                taps,
                ..
            } => start + lasting(taps, interval, 1.0 / frequency - interval),
        }
    }
}

/// Duration of `count` repetitions, with the difference of the last one.
fn lasting(count: u32, each: f64, more: f64) -> f64 {
    match count {
        0 => 0.0,
        u32::MAX => f64::MAX,
        _ => f64::from(count) * each + more,
    }
}
