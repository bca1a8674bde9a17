//! The packing job: a state that advances step by step from an empty container to a verified
//! pack.

mod deposit;
mod ranks;
mod relax;
mod settle;
mod surface;
pub(crate) mod top;

use crate::error::PackError;
use crate::report::{PackReport, Relaxation, Verification};
use crate::spec::PackSpec;
use femdem_contact::BodyId;
use femdem_solve::{Alone, Drive, Halo, World};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The stage of a packing job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Bodies are being released.
    Depositing,
    /// All bodies are in; waiting for them to come to rest.
    Settling,
    /// All bodies are awake and the medium is switched off, to verify that they stay at rest. If some do not,
    /// the others sleep until they do, and all are woken again; where contacts hardly damp, the medium acts
    /// meanwhile.
    Verifying,
    /// Finished.
    Done,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Depositing => "depositing",
            Self::Settling => "settling",
            Self::Verifying => "verifying",
            Self::Done => "done",
        })
    }
}

/// The progress of a packing job.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// Bodies released so far.
    pub placed: u32,
    /// Bodies to be packed.
    pub count: u32,
    /// Batches released so far.
    pub batches: u32,
    /// Highest point of the bodies at the last check, m.
    pub top: f64,
    /// Simulated time, s.
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Bodies awake; of this rank in a job that is [shared out](Packing::share_out).
    pub awake: usize,
}

/// A packing job.
///
/// It owns the world and advances it by whole steps. Every decision is a function of the state, so that the
/// result does not depend on how the steps are divided over calls, on the number of threads, or on whether the
/// job was saved and read in between. Serialise it (for example with `femdem_solve::checkpoint`) to continue
/// later with the same bits.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Packing {
    world: World,
    job: Job,
}

/// The stored form of a job; the world then has to rebuild what is not stored.
#[derive(Deserialize)]
#[serde(rename = "Packing")]
struct Stored {
    world: World,
    job: Job,
}

/// The job's own state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Job {
    spec: PackSpec,
    /// Pa.
    penalty: f64,
    stage: Stage,
    /// Simulated time at which the stage began, s.
    stage_began: f64,
    /// Number of the first body of each batch.
    batches: Vec<BodyId>,
    /// Batches that were followed by the next before they had landed.
    cut_short: u32,
    /// Simulated time at which the last batch was released, s.
    released: f64,
    /// The awake relaxation in progress.
    relaxing: Option<relax::Relaxing>,
    /// The last awake relaxation that has ended.
    relaxation: Option<Relaxation>,
    /// Since when all bodies of the last batch have been at rest, s.
    landed_since: Option<f64>,
    /// Highest point of any start, m.
    highest_start: f64,
    /// Highest point of the bodies at the last check, m.
    top: f64,
    /// Simulated time of the next check, s.
    next_check: f64,
    /// Checks in a row that passed.
    passed: u32,
    /// The phase of the verification; `None` while bodies at rest sleep.
    attempt: Option<settle::Attempt>,
    /// Attempts at verification so far.
    tries: u32,
    verification: Option<Verification>,
}

impl TryFrom<Stored> for Packing {
    type Error = PackError;

    fn try_from(stored: Stored) -> Result<Self, PackError> {
        let Stored { mut world, job } = stored;
        world.restore()?;
        job.spec.validate()?;
        let first = job.batches.first().is_none_or(|&b| b == 0);
        let rising = job.batches.windows(2).all(|w| w[0] < w[1]);
        let placed = job
            .batches
            .last()
            .is_none_or(|&b| (b as usize) < world.count_in_whole());
        let known = world.shapes().len() == job.spec.shapes.len();
        let counted = world.count_in_whole() <= job.spec.count as usize;
        if !(first && rising && placed && known && counted) {
            return Err(PackError::Inconsistent {
                what: "the batches do not belong to the bodies",
            });
        }
        Ok(Self { world, job })
    }
}

impl Packing {
    /// A job with an empty container.
    ///
    /// # Errors
    /// What [`PackSpec::validate`] refuses; [`PackError::Solve`] for a shape or a
    /// parameter that the world refuses; [`PackError::LayerTooWide`], [`PackError::LayerOutside`] or [`PackError::LayerTooLarge`]
    /// for a release lattice that does not fit.
    pub fn new(spec: PackSpec) -> Result<Self, PackError> {
        let penalty = spec.resolved_penalty()?;
        let mut world = World::new(spec.world_parameters(penalty))?;
        if let Some(cell) = spec.container.cell()? {
            world.set_cell(cell)?;
        }
        for shape in &spec.shapes {
            shape.add_to(&mut world)?;
        }
        for wall in spec.container.walls()? {
            let wall = world.add_wall(wall, Drive::Fixed)?;
            world.set_wall_material(wall, spec.wall_material)?;
        }
        let usual = world.parameters().contact;
        for pair in &spec.pairs {
            let [a, b] = pair.materials;
            world.set_law(a, b, pair.over(&usual))?;
        }
        let job = Job {
            spec,
            penalty,
            stage: Stage::Depositing,
            stage_began: 0.0,
            batches: Vec::new(),
            cut_short: 0,
            released: 0.0,
            relaxing: None,
            relaxation: None,
            landed_since: None,
            highest_start: 0.0,
            top: 0.0,
            next_check: 0.0,
            passed: 0,
            attempt: None,
            tries: 0,
            verification: None,
        };
        let mut packing = Self { world, job };
        packing.release_if_due(&mut Alone)?;
        Ok(packing)
    }

    /// Advances by at most `steps` steps of the world; by fewer if the job ends before.
    ///
    /// # Errors
    /// [`PackError::Escaped`] or [`PackError::Thrown`] name a body that has left the container,
    /// [`PackError::Solve`] is a simulation that has blown up. The job can then not be continued; continue from
    /// an earlier checkpoint.
    pub fn advance(&mut self, steps: u64) -> Result<Progress, PackError> {
        self.advance_on(steps, &mut Alone)
    }

    /// As [`advance`](Self::advance), of a job that is [shared out](Self::share_out). All ranks call it alike.
    ///
    /// # Errors
    /// As [`advance`](Self::advance), and what `halo` reports. Which of several bodies an error names depends on the ranks; the
    /// others wait in vain for a rank that got one, unless the [halo](Halo) ends them.
    pub fn advance_on(&mut self, steps: u64, halo: &mut dyn Halo) -> Result<Progress, PackError> {
        for _ in 0..steps {
            match self.job.stage {
                Stage::Depositing => self.step_deposition(halo)?,
                Stage::Settling => self.step_settling(halo)?,
                Stage::Verifying => self.step_verification(halo)?,
                Stage::Done => break,
            }
        }
        Ok(self.progress())
    }

    /// Advances to the end.
    ///
    /// # Errors
    /// As [`Packing::advance`].
    pub fn run(&mut self) -> Result<PackReport, PackError> {
        const STEPS: u64 = 1000;
        while !self.is_done() {
            self.advance(STEPS)?;
        }
        self.report()
    }

    /// The progress of the job.
    pub fn progress(&self) -> Progress {
        Progress {
            stage: self.job.stage,
            placed: self.placed(),
            count: self.job.spec.count,
            batches: self.batch_count(),
            top: self.job.top,
            time: self.world.time(),
            steps: self.world.steps(),
            awake: self.world.awake_count(),
        }
    }

    /// Whether the job is finished.
    pub fn is_done(&self) -> bool {
        self.job.stage == Stage::Done
    }

    /// The specification of the job.
    pub fn spec(&self) -> &PackSpec {
        &self.job.spec
    }

    /// The bodies and walls.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The bodies and walls, to continue from the pack.
    pub fn into_world(self) -> World {
        self.world
    }

    /// The penalty in use, Pa.
    pub fn penalty(&self) -> f64 {
        self.job.penalty
    }

    /// Number, from 0, of the batch or layer in which a body was added; `None` for an unknown body. Within a
    /// batch bodies are numbered in the order of placement; in a job that is [shared out](Self::share_out) by their numbers in the
    /// whole.
    pub fn sequence(&self, body: BodyId) -> Option<u32> {
        if body >= self.placed() {
            return None;
        }
        let batches = self.job.batches.partition_point(|&first| first <= body);
        u32::try_from(batches).ok()?.checked_sub(1)
    }

    /// The state of the pack in numbers. Costs a pass over the bodies and their contacts.
    ///
    /// # Errors
    /// [`PackError::Shared`] in a job that is [shared out](Self::share_out).
    pub fn report(&self) -> Result<PackReport, PackError> {
        if self.world.is_shared() {
            return Err(PackError::Shared);
        }
        let verification = self.job.verification;
        let settled = self.is_done() && verification.is_some_and(|v| v.passed);
        let report = PackReport::new(
            &self.world,
            self.job.spec.diameter(),
            self.job.penalty,
            settled,
            verification,
        );
        let batches = self.batch_count();
        Ok(report.with_history(batches, self.job.cut_short, self.job.relaxation))
    }

    fn placed(&self) -> u32 {
        // A spec counts bodies in 32 bits, and no more than that are added.
        u32::try_from(self.world.count_in_whole()).unwrap_or(u32::MAX)
    }

    fn batch_count(&self) -> u32 {
        u32::try_from(self.job.batches.len()).unwrap_or(u32::MAX)
    }

    /// Simulated time since the stage began, s.
    fn stage_time(&self) -> f64 {
        self.world.time() - self.job.stage_began
    }

    fn enter(&mut self, stage: Stage) {
        self.job.stage = stage;
        self.job.stage_began = self.world.time();
        self.job.passed = 0;
        self.job.next_check = self.world.time();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_that_does_not_fit_its_world_is_refused() {
        let packing = Packing::new(PackSpec::default()).unwrap();
        let read = |change: fn(&mut Job)| {
            let Packing { world, mut job } = packing.clone();
            change(&mut job);
            Packing::try_from(Stored { world, job })
        };
        assert!(read(|_| {}).is_ok());
        let refused = |change: fn(&mut Job)| {
            let error = read(change).unwrap_err().to_string();
            assert!(error.contains("inconsistent"), "{error}");
        };
        refused(|job| job.batches = vec![0, 0]);
        refused(|job| job.batches = vec![1]);
        refused(|job| job.batches = vec![0, 10_000]);
        refused(|job| job.spec.count = 1);
        refused(|job| job.spec.shapes.extend(job.spec.shapes.clone()));
        assert!(read(|job| job.spec.density = -1.0).is_err());
    }
}
