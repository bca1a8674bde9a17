//! A run: stepping a simulation and writing its files when they are due.

mod resume;

use std::fs;
use std::path::Path;

use femdem_mesh::Vector3;
use femdem_view::ViewError;
use femdem_view::output::{write_file, write_pvd_parts};
use femdem_view::picture::PictureOptions;
use serde::{Deserialize, Serialize};

use super::history::{self, Table};
use super::relaxation::Relaxing;
use super::watch::{Deepest, Watch};
use super::{RelaxSummary, RunSummary, Scenario, Simulation};
use crate::{Error, Usage};

/// Steps between checks for rest.
const STEPS_BETWEEN_LOOKS: u64 = 64;

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// Its duration was over.
    Time,
    /// All bodies were at rest.
    Rest,
}

/// The largest force on a wall or of a support among the rows of the history.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    /// N.
    pub force: f64,
    /// s.
    pub time: f64,
}

impl Peak {
    fn see(&mut self, force: &Vector3, time: f64) {
        let force = force.norm();
        if force > self.force {
            *self = Self { force, time };
        }
    }
}

/// A scenario in progress. It can be saved and read back through serde, and continues to the same bits.
///
/// Output does not affect the motion: a frame shows the first step at or after its time.
#[derive(Debug, Serialize, Deserialize)]
pub struct Run {
    #[serde(with = "as_text")]
    scenario: Scenario,
    simulation: Simulation,
    /// Times of the frames that were written \[s\].
    frames: Vec<f64>,
    /// Numbers of the next frame and the next row, in their intervals.
    next_frame: u64,
    next_row: u64,
    history: Table,
    members: Table,
    peaks: Vec<Peak>,
    reaction_peaks: Vec<Peak>,
    watch: Watch,
    /// When the kinetic energy last fell below that of rest, as far as it was checked \[s\].
    quiet_since: Option<f64>,
    /// Whether the bodies have come to rest, and are awake to show that they stay there.
    verifying: bool,
    relaxing: Option<Relaxing>,
    ending: Option<Ending>,
}

impl Run {
    /// A run at its start; no file is written yet.
    ///
    /// # Errors
    ///
    /// As [`Scenario::build`].
    pub fn new(scenario: Scenario) -> Result<Self, Error> {
        let simulation = scenario.build()?;
        let (mut history, mut members) = (Table::default(), Table::default());
        history.row(history::history_header(&simulation));
        members.row(history::MEMBER_COLUMNS.map(str::to_owned));
        Ok(Self {
            peaks: vec![Peak::default(); simulation.world.walls().len()],
            reaction_peaks: vec![Peak::default(); simulation.supports.len()],
            watch: Watch::default(),
            scenario,
            simulation,
            frames: Vec::new(),
            next_frame: 0,
            next_row: 0,
            history,
            members,
            quiet_since: None,
            verifying: false,
            relaxing: None,
            ending: None,
        })
    }

    /// The scenario.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The bodies and their world.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Times of the frames that were written \[s\].
    #[must_use]
    pub fn frames(&self) -> &[f64] {
        &self.frames
    }

    pub(super) fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// Whether all bodies are awake to show that they stay at rest.
    pub(super) fn is_verifying(&self) -> bool {
        self.verifying
    }

    /// Why the run has ended; `None` while it has not.
    #[must_use]
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// Progress of the relaxation after the motion; `None` before it, and without one.
    #[must_use]
    pub fn relaxation(&self) -> Option<&RelaxSummary> {
        self.relaxing.as_ref().map(|relaxing| &relaxing.so_far)
    }

    /// The last step of the motion \[s\].
    pub(super) fn time_step(&self) -> f64 {
        let of_motion = self.relaxing.as_ref().map(|relaxing| relaxing.time_step);
        of_motion.unwrap_or_else(|| self.simulation.world.time_step())
    }

    /// Largest force on each wall \[N\] and its time \[s\], among the rows of the history.
    pub(super) fn peaks(&self) -> &[Peak] {
        &self.peaks
    }

    /// The same of the supports' forces.
    pub(super) fn reaction_peaks(&self) -> &[Peak] {
        &self.reaction_peaks
    }

    /// The deepest contact of all steps.
    pub(super) fn deepest(&self) -> &Deepest {
        &self.watch.deepest
    }

    /// What the run has warned of so far: overlaps that are deeper than a contact law of small overlaps is meant for.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.watch.warnings
    }

    /// Advances by at most `steps` steps, or to the end of the run, and writes frames and rows into `folder`
    /// when they are due. The end has a frame and a row, too. A relaxation continues in parts of up to 4,000
    /// steps, and has neither frames nor rows before its end.
    ///
    /// # Errors
    ///
    /// As [`Simulation::step`], and [`Error::View`].
    pub fn advance(&mut self, folder: &Path, steps: u64) -> Result<(), Error> {
        if self.ending.is_none() {
            self.write_due(folder)?;
        }
        let mut left = steps;
        while left > 0 && self.ending.is_none() {
            let taken = if self.relaxing.is_some() {
                self.relax_on()?
            } else {
                self.simulation.step()?;
                if self.simulation.world.steps() == 1 {
                    self.scenario.check_step(self.time_step())?;
                }
                self.look();
                self.allow_sleep();
                self.watch.look(&self.simulation)?;
                self.check_books()?;
                1
            };
            left = left.saturating_sub(taken);
            self.write_due(folder)?;
        }
        Ok(())
    }

    /// Writes the rows that are still in memory, so that a checkpoint made next fits the files.
    ///
    /// # Errors
    ///
    /// [`Error::View`].
    pub fn flush(&mut self, folder: &Path) -> Result<(), Error> {
        self.history.flush(&folder.join("history.csv"))?;
        if self.scenario.track {
            self.members.flush(&folder.join("members.csv"))?;
        }
        Ok(())
    }

    /// Writes the files of the end: for a run that was stopped before, a frame of the present state; the
    /// picture; and last of all `summary.json`.
    ///
    /// # Errors
    ///
    /// [`Error::View`].
    pub fn finish(&mut self, folder: &Path, usage: &Usage) -> Result<RunSummary, Error> {
        if self.frames.last() != Some(&self.simulation.world.time()) {
            self.write_frame(folder)?;
        }
        self.flush(folder)?;
        let picture = self.picture(&PictureOptions::default())?;
        write_file(folder.join("run.png"), |w| picture.write_png(w))?;
        let summary = RunSummary::of(self, usage)?;
        write_file(folder.join("summary.json"), |w| summary.write_json(w))?;
        Ok(summary)
    }

    /// Performs a part of the relaxation; returns its steps.
    fn relax_on(&mut self) -> Result<u64, Error> {
        let entry = self.scenario.relax.unwrap_or_default();
        let Some(Relaxing { ending, so_far, .. }) = &mut self.relaxing else {
            return Ok(1);
        };
        let before = so_far.steps;
        *so_far = self.simulation.relax_on(&entry, so_far)?;
        if so_far.is_done(&entry) {
            self.ending = Some(*ending);
        }
        Ok((so_far.steps - before).max(1))
    }

    /// Checks whether the motion is over, and with it the run if there is no relaxation.
    fn look(&mut self) {
        let Some(ending) = self.end_of_motion() else {
            return;
        };
        if self.scenario.relax.is_some() {
            self.relaxing = Some(Relaxing {
                ending,
                time_step: self.simulation.world.time_step(),
                so_far: RelaxSummary::default(),
            });
        } else {
            self.ending = Some(ending);
        }
    }

    fn end_of_motion(&mut self) -> Option<Ending> {
        let world = &self.simulation.world;
        if world.time() >= self.scenario.duration {
            return Some(Ending::Time);
        }
        let rest = self.scenario.rest?;
        if !world.steps().is_multiple_of(STEPS_BETWEEN_LOOKS) {
            return None;
        }
        if world.kinetic_energy() >= rest.energy || self.is_more_to_come() {
            self.quiet_since = None;
            self.verifying = false;
            return None;
        }
        let now = world.time();
        if now - *self.quiet_since.get_or_insert(now) < rest.time {
            return None;
        }
        if !self.verifying {
            self.verifying = true;
            self.quiet_since = Some(now);
            return None;
        }
        self.simulation.rest().at_rest.then_some(Ending::Rest)
    }

    /// Writes the row and the frame if they are due; at the end both are.
    fn write_due(&mut self, folder: &Path) -> Result<(), Error> {
        let ended = self.ending.is_some();
        // The last step may be many intervals long, if the run is shorter than a step.
        let time = self.simulation.world.time().min(self.scenario.duration);
        let row = due(time, self.scenario.history_interval(), self.next_row);
        if row.is_some() || ended {
            self.next_row = row.unwrap_or(self.next_row);
            self.write_row();
        }
        let frame = due(time, self.scenario.frame_interval(), self.next_frame);
        if frame.is_some() || ended {
            self.next_frame = frame.unwrap_or(self.next_frame);
            self.write_frame(folder)?;
            self.flush(folder)?;
        }
        Ok(())
    }

    fn write_row(&mut self) {
        let contacts = self.simulation.contacts();
        let forces = self.simulation.forces(&contacts);
        let time = self.simulation.world.time();
        let reactions = self.simulation.reactions();
        for (peak, force) in self.peaks.iter_mut().zip(&forces.walls) {
            peak.see(force, time);
        }
        for (peak, force) in self.reaction_peaks.iter_mut().zip(&reactions) {
            peak.see(force, time);
        }
        let row = history::history_row(&self.simulation, contacts.len(), &forces, &reactions);
        self.history.row(row);
        if self.scenario.track {
            for row in history::member_rows(&self.simulation, &forces) {
                self.members.row(row);
            }
        }
    }

    fn write_frame(&mut self, folder: &Path) -> Result<(), Error> {
        let frames = folder.join("frames");
        fs::create_dir_all(&frames).map_err(|source| ViewError::Write {
            path: frames.clone(),
            source,
        })?;
        let number = self.frames.len();
        let simulation = &self.simulation;
        if simulation.world.deformable_count() > 0 {
            let path = frames.join(file_name(DEFORMABLE, number));
            write_file(path, |w| simulation.write_deformables(w))?;
        }
        if simulation.world.body_count() > 0 {
            let path = frames.join(file_name(RIGID, number));
            write_file(path, |w| simulation.write_rigid(w))?;
        }
        let path = frames.join(file_name(CONTACTS, number));
        write_file(path, |w| simulation.write_contacts(w))?;
        if self.scenario.pictures {
            let picture = self.picture(&PictureOptions::default())?;
            let path = frames.join(file_name(PICTURE, number));
            write_file(path, |w| picture.write_png(w))?;
        }
        self.frames.push(simulation.world.time());
        self.write_lists(folder)
    }

    /// `run.pvd` and `contacts.pvd`.
    fn write_lists(&self, folder: &Path) -> Result<(), Error> {
        let world = &self.simulation.world;
        let kinds = [
            (world.deformable_count() > 0, DEFORMABLE),
            (world.body_count() > 0, RIGID),
        ];
        let given = || kinds.iter().filter(|(given, _)| *given);
        let (mut bodies, mut contacts) = (Vec::new(), Vec::new());
        for (number, &time) in self.frames.iter().enumerate() {
            let path = |kind| format!("frames/{}", file_name(kind, number));
            bodies.extend(
                (0..)
                    .zip(given())
                    .map(|(part, (_, kind))| (time, part, path(*kind))),
            );
            contacts.push((time, 0, path(CONTACTS)));
        }
        write_pvd_parts(folder.join("run.pvd"), &bodies)?;
        Ok(write_pvd_parts(folder.join("contacts.pvd"), &contacts)?)
    }
}

const DEFORMABLE: (&str, &str) = ("deformable", "vtu");
const RIGID: (&str, &str) = ("rigid", "vtu");
const PICTURE: (&str, &str) = ("picture", "png");
const CONTACTS: (&str, &str) = ("contacts", "vtp");

fn file_name((stem, extension): (&str, &str), number: usize) -> String {
    format!("{stem}-{number:05}.{extension}")
}

/// The number after that of the latest due output, if any is due.
fn due(time: f64, interval: f64, next: u64) -> Option<u64> {
    let is_due = |number: u64| time >= number as f64 * interval;
    if !is_due(next) {
        return None;
    }
    let mut latest = ((time / interval) as u64).max(next);
    while is_due(latest + 1) {
        latest += 1;
    }
    while latest > next && !is_due(latest) {
        latest -= 1;
    }
    Some(latest + 1)
}

/// The scenario in a checkpoint is stored as text, because all keys of a file may be absent.
mod as_text {
    use serde::de::Error as _;
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::run::Scenario;

    pub fn serialize<S: Serializer>(scenario: &Scenario, to: S) -> Result<S::Ok, S::Error> {
        scenario.to_toml().map_err(S::Error::custom)?.serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Scenario, D::Error> {
        Scenario::from_toml(&String::deserialize(from)?).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_fall_due_once_each_and_long_steps_skip_some() {
        let mut next = 0;
        let mut written = Vec::new();
        for step in 0..=30 {
            let time = 0.1 * f64::from(step);
            if let Some(after) = due(time, 0.25, next) {
                written.push(step);
                next = after;
            }
        }
        assert_eq!(written, [0, 3, 5, 8, 10, 13, 15, 18, 20, 23, 25, 28, 30]);
        assert_eq!(due(10.0, 0.25, 3), Some(41));
        assert_eq!(due(0.2, 0.25, 1), None);
    }
}
