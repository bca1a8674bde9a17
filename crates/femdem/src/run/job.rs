//! A run: a scenario in progress.

mod advance;
mod elsewhere;
mod files;
mod fixtures;
mod part;
mod resume;
mod show;
mod shown;
mod tables;

use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

use super::history::{self, Table};
use super::relaxation::Relaxing;
use super::stillness::Stillness;
use super::until::Until;
use super::watch::{Deepest, Watch};
use super::{
    CELL_COLUMNS, Ending, FLOW_COLUMNS, Reached, RelaxSummary, Scenario, Simulation,
    WALL_HISTORY_COLUMNS,
};
use crate::Error;
pub use part::Part;

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
    walls: Table,
    cells: Table,
    flow: Table,
    peaks: Vec<Peak>,
    reaction_peaks: Vec<Peak>,
    watch: Watch,
    stillness: Stillness,
    until: Until,
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
        let (scenario, simulation) = scenario.begin()?;
        Self::at_start(scenario, simulation)
    }

    /// A run of another scene that starts from the present state of this one, whatever its `from` says, with time and ledger at 0.
    ///
    /// # Errors
    ///
    /// As [`Scenario::build`]; [`Error::Fixed`] if the other scene has other materials, bodies or walls.
    pub fn followed_by(&self, next: &Scenario) -> Result<Self, Error> {
        next.check()?;
        let state = format!("the run of \"{}\"", self.scenario.out.display());
        let (scenario, simulation) =
            next.start_after(&self.scenario, self.simulation.clone(), &state)?;
        Self::at_start(scenario, simulation)
    }

    fn at_start(scenario: Scenario, simulation: Simulation) -> Result<Self, Error> {
        scenario.check_until(&simulation)?;
        let [mut history, mut members, mut walls, mut cells, mut flow] =
            [const { Table::EMPTY }; 5];
        history.row(history::history_header(&simulation));
        members.row(history::MEMBER_COLUMNS.map(str::to_owned));
        walls.row(WALL_HISTORY_COLUMNS.map(str::to_owned));
        cells.row(CELL_COLUMNS.map(str::to_owned));
        flow.row(FLOW_COLUMNS.map(str::to_owned));
        Ok(Self {
            peaks: vec![Peak::default(); simulation.walls.len()],
            reaction_peaks: vec![Peak::default(); simulation.supports.len()],
            watch: Watch::default(),
            scenario,
            simulation,
            frames: Vec::new(),
            next_frame: 0,
            next_row: 0,
            history,
            members,
            walls,
            cells,
            flow,
            stillness: Stillness::default(),
            until: Until::default(),
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
        self.stillness.verifying
    }

    /// Why the run has ended; `None` while it has not.
    #[must_use]
    pub fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// The limit that ended the motion; `None` while none has.
    #[must_use]
    pub fn reached(&self) -> Option<&Reached> {
        self.until.reached.as_ref()
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
