//! Going on with a run under a changed scene.

use super::super::changes::{Change, changes};
use super::super::stillness::Stillness;
use super::super::words::KEYS;
use super::files::due;
use super::{Relaxing, Run, Until};
use crate::Error;
use crate::run::{RelaxSummary, Scenario, Simulation};
use femdem_solve::{World, WorldParameters};

impl Run {
    /// Refuses a duration that is not beyond the present time.
    ///
    /// # Errors
    ///
    /// [`Error::Over`] with the present time.
    pub fn check_duration(&self, duration: f64) -> Result<(), Error> {
        let time = self.simulation.world.time();
        if duration > time {
            return Ok(());
        }
        Err(Error::Over { duration, time })
    }

    /// Goes on under a changed scene, and returns the names of the keys that have changed. An equal scene changes nothing.
    ///
    /// A run that has ended goes on to a longer duration, and looks for rest anew. If its bodies were relaxed, or were being
    /// relaxed, the motion goes on from where that has come to, at its time, and there is a relaxation again at the new end.
    /// With a `relax` that is new or stricter, but no longer duration, an ended run is relaxed further.
    ///
    /// # Errors
    ///
    /// [`Error::Fixed`] for a change of bodies, materials, walls or folders, or of the motion in a run that stays ended;
    /// [`Error::Over`] for a duration that is over; and as [`Scenario::build`]. The run is then unchanged.
    pub fn apply(&mut self, scenario: Scenario) -> Result<Vec<String>, Error> {
        let of_pack = self.simulation.is_of_pack();
        let usual = match of_pack {
            true => *self.simulation.world.parameters(),
            false => WorldParameters::default(),
        };
        let mut scenario = scenario.filled(&usual, of_pack);
        if of_pack {
            scenario = scenario.with_pairs_of(&self.scenario);
        }
        let changes = changes(&self.scenario, &scenario)?;
        if changes.is_empty() {
            return Ok(Vec::new());
        }
        if let Some(fixed) = changes.iter().find(|change| !change.can_be_applied()) {
            let advice = "put it back, or start another run, for new loads with `from`";
            return Err(refused(fixed, "a checkpoint", advice));
        }
        if changes.iter().any(|change| change.top == "duration") {
            self.check_duration(scenario.duration)?;
        }
        scenario.check()?;
        scenario.check_relaxation(&self.simulation)?;
        scenario.check_sleep(&self.simulation)?;
        scenario.check_until(&self.simulation)?;
        World::new(scenario.parameters()).map_err(|error| Error::from(error).by_keys(&KEYS))?;
        let step = self.time_step();
        if step > 0.0 {
            scenario.check_step(step)?;
        }
        let (ending, relaxing) = self.stage_under(&scenario, &changes)?;
        let moving = changes.iter().find(|change| change.moves());
        if let Some(change) = moving {
            if ending.is_some() {
                let advice = "give a `duration` beyond the present time too, to go on";
                return Err(refused(change, "the end of the run", advice));
            }
            let mut simulation = self.simulation.clone();
            simulation.change(&self.scenario, &scenario)?;
            self.simulation = simulation;
        }
        if changes.iter().any(|change| change.top == "duration") {
            self.simulation.extend_sources(&scenario)?;
        }
        let time = self.simulation.world.time();
        let again = |next: u64, old: f64, new: f64| match due(time, new, 0) {
            Some(number) if next > 0 && old != new => number,
            _ => next,
        };
        let (old, new) = (&self.scenario, &scenario);
        self.next_row = again(
            self.next_row,
            old.history_interval(),
            new.history_interval(),
        );
        self.next_frame = again(self.next_frame, old.frame_interval(), new.frame_interval());
        let goes_on = (self.ending.is_some() && ending.is_none())
            || (self.relaxing.is_some() && relaxing.is_none());
        if old.rest != new.rest || goes_on {
            self.stillness = Stillness::default();
        }
        if old.until != new.until || goes_on {
            self.until = Until::default();
        }
        (self.ending, self.relaxing) = (ending, relaxing);
        self.scenario = scenario;
        Ok(changes.into_iter().map(|change| change.name).collect())
    }

    /// The ending and the relaxation with which the run goes on under another scene.
    fn stage_under(
        &self,
        scene: &Scenario,
        changes: &[Change],
    ) -> Result<(Option<super::Ending>, Option<Relaxing>), Error> {
        let changed = |key: &str| changes.iter().any(|change| change.top == key);
        let (ending, relaxing) = (self.ending, self.relaxing);
        let moves_on = scene.duration > self.simulation.world.time();
        if moves_on && (changed("duration") || changed("rest") || changed("until")) {
            return Ok((None, None));
        }
        match (ending, relaxing, scene.relax) {
            (_, Some(_), None) => Err(Error::Option {
                name: "relax",
                value: "none".to_owned(),
                allowed: "the bodies are being relaxed, or were: leave it, or give a duration beyond the present time",
            }),
            (_, Some(mut relaxing), Some(entry)) if changed("relax") => {
                let so_far = &mut relaxing.so_far;
                so_far.converged = so_far.steps > 0 && so_far.residual <= entry.tolerance;
                let ending = ending.filter(|_| so_far.is_done(&entry));
                Ok((ending, Some(relaxing)))
            }
            (Some(ending), None, Some(_)) => Ok((
                None,
                Some(Relaxing {
                    ending,
                    time_step: self.simulation.world.time_step(),
                    so_far: RelaxSummary::default(),
                }),
            )),
            _ => Ok((ending, relaxing)),
        }
    }

    /// The scene and the state.
    pub(in crate::run) fn into_parts(self) -> (Scenario, Simulation) {
        (self.scenario, self.simulation)
    }
}

fn refused(change: &Change, state: &str, advice: &'static str) -> Error {
    Error::Fixed {
        scene: "scene.toml",
        key: change.name.clone(),
        state: state.to_owned(),
        advice,
    }
}
