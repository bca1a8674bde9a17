//! The part of a run that one of several ranks steps.

use std::path::Path;

use femdem_solve::{Halo, SolveError, World, checkpoint};
use serde::{Deserialize, Serialize};

use super::fixtures::Fixtures;
use crate::gather::or_error_of_another;
use crate::run::flow::SharedFlow;
use crate::run::load::LoadedMembers;
use crate::run::saved::RUN;
use crate::run::stillness::{STEPS_BETWEEN_LOOKS, Stillness};
use crate::run::{Controls, Run, Scenario};
use crate::saved::{PartFiles, Saved};
use crate::{Error, Usage};

/// What a rank needs to step its part of a run: the first one has the [`Run`] besides, which writes the files.
pub struct Part {
    pub(super) world: World,
    pub(super) scenario: Scenario,
    pub(super) controls: Controls,
    loads: LoadedMembers,
    flow: SharedFlow,
    pub(super) fixtures: Fixtures,
    stillness: Stillness,
    /// Whether the bodies have been still for so long that their forces are looked at.
    pub(super) may_rest: bool,
    /// Steps of the relaxation, by the first rank, once the motion has ended.
    pub(super) relaxed: Option<u64>,
    /// Number of the deformable bodies of the whole, which stay unless bodies may break.
    pub(super) deformable: usize,
    /// Whether a frame shows nothing but bodies that do not break, their contacts and walls.
    pub(super) has_plain_frames: bool,
    /// Number of the last checkpoint.
    checkpoint: u64,
}

/// What all ranks get of a run besides its world.
#[derive(Serialize, Deserialize)]
struct Shared {
    scenario: String,
    controls: Controls,
    loads: LoadedMembers,
    flow: SharedFlow,
    fixtures: Fixtures,
    stillness: Stillness,
    relaxed: Option<u64>,
    files: PartFiles,
    /// Whether these have the parts of other ranks than the first.
    has_parts: bool,
}

impl Run {
    /// What it gives to ranks besides its world, if they can share it.
    fn to_share(&self, files: PartFiles) -> Result<Shared, Error> {
        self.steps_elsewhere()?;
        let simulation = &self.simulation;
        simulation.world.can_be_shared()?;
        let may_break = simulation.world.may_break();
        Ok(Shared {
            scenario: self.scenario.to_toml()?,
            controls: simulation.controls.clone(),
            loads: LoadedMembers::of(&simulation.loads, &simulation.members, may_break),
            flow: SharedFlow::of(simulation, may_break),
            fixtures: Fixtures::of(simulation),
            stillness: self.stillness,
            relaxed: self.steps_relaxed(),
            files,
            has_parts: simulation.world.is_shared(),
        })
    }

    pub(super) fn steps_relaxed(&self) -> Option<u64> {
        self.relaxation().map(|so_far| so_far.steps)
    }
}

impl Part {
    /// Shares a run out over ranks: the first one gives it, and no other. Its world is empty until
    /// [`go_on`](Self::go_on) has ended its motion, unless its bodies are being relaxed: those it keeps.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] for what ranks cannot do, as [`Run::steps_elsewhere`], and those of [`World::share_from_first`].
    pub fn share_out(run: Option<&mut Run>, halo: &mut dyn Halo) -> Result<Self, Error> {
        Self::begin(run, PartFiles::default(), Path::new(""), halo)
    }

    /// Goes on from the checkpoint in a folder, which any ranks have written, or one process. Each rank reads some of the parts. The
    /// first one gets the run, as in [`share_out`](Self::share_out), and its cost so far.
    ///
    /// # Errors
    ///
    /// As [`Run::read`] and [`share_out`](Self::share_out); an error of one rank is that of all.
    pub fn resume(
        folder: &Path,
        halo: &mut dyn Halo,
    ) -> Result<(Self, Option<(Run, Usage)>), Error> {
        let read = match halo.rank() {
            0 => RUN.read::<Run>(folder).map(Some),
            _ => Ok(None),
        };
        let Some(saved) = or_error_of_another(read.map_err(Error::from), halo)? else {
            let part = Self::begin(None, PartFiles::default(), folder, halo)?;
            return Ok((part, None));
        };
        let Saved {
            job: mut run,
            usage,
            parts,
        } = saved;
        let part = Self::begin(Some(&mut run), parts, folder, halo)?;
        Ok((part, Some((run, usage))))
    }

    /// Shares a run out, whose world may be the first of parts that are in files.
    fn begin(
        run: Option<&mut Run>,
        files: PartFiles,
        folder: &Path,
        halo: &mut dyn Halo,
    ) -> Result<Self, Error> {
        let (mut mine, mut given, mut refused) = (None, None, None);
        if let Some(run) = run {
            match run.to_share(files) {
                Ok(parts) => {
                    let world = &mut run.simulation.world;
                    let mut own = World::new(*world.parameters())?;
                    if parts.relaxed.is_none() {
                        std::mem::swap(world, &mut own);
                    }
                    given = Some(own);
                    mine = Some(parts);
                }
                // The others are told before.
                Err(error) => refused = Some(error),
            }
        }
        let mut messages = Vec::new();
        if given.is_some() || refused.is_some() {
            let bytes = checkpoint::encode(&mine)?;
            messages.extend((0..halo.size()).map(|rank| (rank, bytes.clone())));
        }
        let received = halo.send(messages)?;
        if let Some(error) = refused {
            return Err(error);
        }
        let none = || SolveError::Ranks {
            why: "the first rank gives the run, and no other rank does".to_owned(),
        };
        let (_, bytes) = received.first().ok_or_else(none)?;
        let sent: Option<Shared> = checkpoint::decode(bytes)?;
        let shared = sent.ok_or_else(none)?;
        let world = match shared.has_parts {
            true => {
                let others = RUN.parts_for(folder, &shared.files, halo);
                let others = or_error_of_another(others.map_err(Error::from), halo)?;
                World::share_parts(given.into_iter().chain(others).collect(), halo)?
            }
            false => World::share_from_first(given, halo)?,
        };
        let scenario = Scenario::from_toml(&shared.scenario)?;
        let own = [world.deformables().count(), world.bonds_added()];
        let mut counts = own.map(|count| count as u64);
        halo.sum(&mut counts)?;
        let [deformable, bonds] = counts;
        let shows_more = scenario.tables || scenario.pictures || world.may_break();
        Ok(Self {
            deformable: deformable as usize,
            has_plain_frames: bonds == 0 && !shows_more,
            world,
            scenario,
            controls: shared.controls,
            loads: shared.loads,
            flow: shared.flow,
            fixtures: shared.fixtures,
            stillness: shared.stillness,
            may_rest: false,
            relaxed: shared.relaxed,
            checkpoint: shared.files.number,
        })
    }

    /// The bodies of this rank.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The scene.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Steps of the motion, and of the relaxation after it.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.world.steps() + self.relaxed.unwrap_or(0)
    }

    /// Whether the motion has ended, and the first rank, which has all bodies, relaxes them.
    #[must_use]
    pub fn is_relaxing(&self) -> bool {
        self.relaxed.is_some()
    }

    /// Takes a step, or none while bodies are relaxed. Returns whether the run may have ended with it: [`go_on`](Self::go_on) says
    /// whether it has.
    ///
    /// # Errors
    ///
    /// Those of [`World::step_on`].
    pub fn step(&mut self, halo: &mut dyn Halo) -> Result<bool, Error> {
        if self.is_relaxing() {
            return Ok(true);
        }
        self.flow
            .begin_step(&mut self.world, &mut self.loads, halo)?;
        if !self.loads.is_empty() {
            let world = &mut self.world;
            // Of the middle of the step, as alone.
            let time = world.time() + 0.5 * world.time_step();
            self.loads.apply(world, time, halo)?;
        }
        if self.controls.is_empty() {
            self.world.step_on(halo)?;
        } else {
            self.controls.step_on(&mut self.world, halo)?;
        }
        self.flow
            .fragment_bodies(&mut self.world, &mut self.loads, halo)?;
        self.flow.end_step(&mut self.world, &mut self.loads, halo)?;
        self.may_rest = self.is_still(halo)?;
        let time = self.world.time();
        let sleeps = self.scenario.sleeps_at(time) && !self.stillness.verifying;
        if self.world.parameters().sleeping.enabled != sleeps {
            self.world.set_sleeping(sleeps);
        }
        Ok(self.may_rest || time >= self.scenario.duration)
    }

    fn is_still(&mut self, halo: &mut dyn Halo) -> Result<bool, Error> {
        let world = &self.world;
        let Some(rest) = self.scenario.rest else {
            return Ok(false);
        };
        if !world.steps().is_multiple_of(STEPS_BETWEEN_LOOKS) {
            return Ok(false);
        }
        let energy = world.kinetic_energy_on(halo)?;
        let time = world.time();
        let more = self.scenario.is_more_to_come(world) || self.flow.is_to_come(time);
        Ok(self.stillness.look(&rest, time, energy, more))
    }

    /// Writes a checkpoint into a folder that all ranks have: each writes its part, and the first one the run, in a file that names
    /// the parts and is put in place last; an earlier checkpoint stays until then. Call [`Run::flush`] first.
    ///
    /// # Errors
    ///
    /// As [`Run::save`]; an error of one rank is that of all.
    pub fn save(
        &mut self,
        run: Option<&mut Run>,
        folder: &Path,
        usage: &Usage,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        if self.is_relaxing() {
            let saved = run.map_or(Ok(()), |run| run.save(folder, usage));
            return or_error_of_another(saved, halo);
        }
        let files = RUN.write_parts(folder, self.checkpoint, &self.world, halo)?;
        let written = run.map(|run| {
            self.tell(run);
            self.lend(run, |run| RUN.write(folder, &*run, usage, &files))
        });
        RUN.end::<Run>(folder, &mut self.checkpoint, &files, written, halo)
    }

    /// Does something with the run that has the world of the first rank meanwhile.
    pub(super) fn lend<T>(&mut self, run: &mut Run, what: impl FnOnce(&mut Run) -> T) -> T {
        std::mem::swap(&mut self.world, &mut run.simulation.world);
        let done = what(run);
        std::mem::swap(&mut self.world, &mut run.simulation.world);
        done
    }

    /// Tells the run what has become of it but for its world.
    pub(super) fn tell(&self, run: &mut Run) {
        run.simulation.controls = self.controls.clone();
        self.flow.give_back(&mut run.simulation);
        self.loads.give_back(&mut run.simulation.loads);
        run.stillness = self.stillness;
    }
}
