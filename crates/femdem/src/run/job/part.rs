//! The part of a run that one of several ranks steps.

use std::path::Path;

use femdem_solve::{Halo, SolveError, World, checkpoint};

use crate::Error;
use crate::run::stillness::{STEPS_BETWEEN_LOOKS, Stillness};
use crate::run::{BodyLoads, Controls, Member, Run, Scenario};

/// What a rank needs to step its part of a run: the first one has the [`Run`] besides, which writes the files.
pub struct Part {
    world: World,
    scenario: Scenario,
    controls: Controls,
    /// Where there are loads, the bodies of the whole.
    members: Vec<Member>,
    loads: BodyLoads,
    stillness: Stillness,
    /// Whether the bodies have been still for so long that their forces are looked at.
    may_rest: bool,
}

impl Part {
    /// Shares a run out over ranks: the first one gives it, and no other. Its world is empty until
    /// [`go_on`](Self::go_on).
    ///
    /// # Errors
    ///
    /// [`Error::Option`] for what ranks cannot do, as [`Run::steps_elsewhere`], and those of [`World::share_from_first`].
    pub fn share_out(run: Option<&mut Run>, halo: &mut dyn Halo) -> Result<Self, Error> {
        let (mut mine, mut given) = (None, None);
        if let Some(run) = run {
            run.steps_elsewhere()?;
            let simulation = &mut run.simulation;
            let empty = World::new(*simulation.world.parameters())?;
            given = Some(std::mem::replace(&mut simulation.world, empty));
            // Names may be many, and are for loads alone.
            let (members, loads) = match simulation.loads.is_empty() {
                true => (&[][..], BodyLoads::default()),
                false => (&simulation.members[..], simulation.loads.clone()),
            };
            let rest = (&simulation.controls, run.stillness, members, loads);
            mine = Some((run.scenario.to_toml()?, checkpoint::encode(&rest)?));
        }
        let bytes = checkpoint::encode(&mine)?;
        let message = mine.is_some().then(|| {
            let others = 0..halo.size();
            others.map(|rank| (rank, bytes.clone())).collect()
        });
        let received = halo.send(message.unwrap_or_default())?;
        let world = World::share_from_first(given, halo)?;
        let none = || SolveError::Ranks {
            why: "the first rank gives the run, and no other rank does".to_owned(),
        };
        let (_, bytes) = received.first().ok_or_else(none)?;
        let sent: Option<(String, Vec<u8>)> = checkpoint::decode(bytes)?;
        let (scenario, rest) = sent.ok_or_else(none)?;
        let (controls, stillness, members, loads) = checkpoint::decode(&rest)?;
        Ok(Self {
            world,
            scenario: Scenario::from_toml(&scenario)?,
            controls,
            members,
            loads,
            stillness,
            may_rest: false,
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

    /// Takes a step. Returns whether the run may have ended with it: [`go_on`](Self::go_on) says whether it has.
    ///
    /// # Errors
    ///
    /// Those of [`World::step_on`].
    pub fn step(&mut self, halo: &mut dyn Halo) -> Result<bool, Error> {
        if !self.loads.is_empty() {
            let world = &mut self.world;
            // Of the middle of the step, as alone.
            let time = world.time() + 0.5 * world.time_step();
            self.loads.apply(&self.members, world, time, halo)?;
        }
        if self.controls.is_empty() {
            self.world.step_on(halo)?;
        } else {
            self.controls.step_on(&mut self.world, halo)?;
        }
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
        let more = self.scenario.is_more_to_come(world);
        Ok(self.stillness.look(&rest, world.time(), energy, more))
    }

    /// Shows all bodies to the run, on the first rank, which writes into `folder` what is due. Returns whether it has ended.
    ///
    /// # Errors
    ///
    /// As [`Run::advance`] but for those of the step, and those of [`World::gather`].
    pub fn go_on(
        &self,
        run: Option<&mut Run>,
        folder: &Path,
        halo: &mut dyn Halo,
    ) -> Result<bool, Error> {
        let whole = self.world.gather(halo)?;
        let mut ended = [0];
        if let Some((run, whole)) = run.zip(whole) {
            run.simulation.controls = self.controls.clone();
            if !self.loads.is_empty() {
                run.simulation.loads = self.loads.clone();
            }
            run.stillness = self.stillness;
            run.go_on_with(whole, self.may_rest, folder)?;
            ended = [u64::from(run.ending.is_some())];
        }
        halo.sum(&mut ended)?;
        Ok(ended[0] > 0)
    }
}
