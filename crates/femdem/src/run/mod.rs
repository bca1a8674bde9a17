//! Scenarios: any mixture of rigid and deformable bodies, materials, walls and prescribed motions, in
//! a file.
//!
//! A scenario is TOML. `femdem run FILE` runs it and writes a time series for ParaView; [`Run`] does the same
//! for programs, and [`Scenario::build`] returns the world alone. The pages `docs/scene*.md` document every key.
//! Units are SI, angles degrees.
//!
//! ```
//! use femdem::run::Scenario;
//!
//! // A soft cube falls on a floor.
//! let scenario = Scenario::from_toml(r#"
//!     duration = 0.004
//!     [material.rubber]
//!     density = 1100
//!     law = "neo-hookean"
//!     young = 1e6
//!     poisson = 0.4
//!     [[wall]]
//!     name = "floor"
//!     plane = { normal = [0, 0, 1] }
//!     [[body]]
//!     shape = "cube"
//!     size = 0.02
//!     material = "rubber"
//!     behaviour = "deformable"
//!     mesh-size = 0.5
//!     position = [0, 0, 0.0101]
//! "#)?;
//! let mut simulation = scenario.build()?;
//! while simulation.world.time() < scenario.duration {
//!     simulation.step()?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adaptive;
mod body;
mod bond_results;
mod bonds;
mod books;
mod boundary;
mod breakable;
mod build;
mod cells;
mod changes;
mod contacts;
mod control;
mod course;
mod cracks;
mod depths;
mod ending;
mod facts;
mod fidelity;
mod flow;
mod focus;
mod fracture;
mod frame;
mod geometry;
mod history;
mod hopper;
mod inside;
mod job;
mod limits;
mod load;
mod loads;
mod material;
mod measured;
mod meets;
mod member;
mod member_states;
mod motion;
mod names;
mod of_pack;
mod origin;
mod overlap;
mod pair;
mod penalty;
mod periodic;
mod picture;
mod piece_surface;
mod pieces;
mod places;
mod relaxation;
mod rest;
mod revolved;
mod rotation;
mod rows;
mod saved;
mod select;
mod settings;
mod simulation;
mod stages;
mod start;
mod state;
mod stillness;
mod summary;
mod support;
mod until;
mod wall;
mod wall_surfaces;
mod watch;
mod words;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use adaptive::FIDELITY_COLUMNS;
pub use body::{Behaviour, BodyEntry, Copies, FocusEntry};
pub use bond_results::{BOND_COLUMNS, BondSummary};
pub use bonds::BondEntry;
pub use boundary::BoundaryEntry;
pub use breakable::FractureMesh;
pub use cells::{CELL_COLUMNS, WALL_HISTORY_COLUMNS};
pub use contacts::{ContactForces, ContactLine, Side};
pub use control::{AxisEntry, Cell, CellState, ControlEntry, Controls, ShearEntry, Sides};
pub use course::Course;
pub use cracks::FractureSummary;
pub use ending::Ending;
pub use fidelity::{FidelityRecord, FidelitySummary};
pub use flow::{FLOW_COLUMNS, Flow, FlowSummary, GateEntry, SourceEntry};
pub use fracture::{FractureEntry, WeibullEntry};
pub use geometry::density_factor;
pub use history::{HISTORY_COLUMNS, MEMBER_COLUMNS};
pub use hopper::HopperEntry;
pub use job::{Part, Run};
pub use load::{Axes, BodyLoads, LoadEntry};
pub use material::{Law, MaterialEntry};
pub use member::Member;
pub use motion::MotionEntry;
pub use origin::Origin;
pub use overlap::Overlap;
pub use penalty::{ExpectedDepth, Forecast};
pub use periodic::CellEntry;
pub(crate) use picture::unit_of;
pub use relaxation::{RelaxEntry, RelaxSummary};
pub use rest::RestSummary;
pub use revolved::{ConeEntry, CylinderEntry, Ends, PlateEntry, SiloEntry};
pub use rotation::RotationEntry;
pub use saved::RUN_CHECKPOINT;
pub use select::{RegionEntry, SelectEntry, Zone};
pub use settings::{ContactEntry, MediumEntry, RestEntry, StepEntry};
pub use simulation::{NamedWall, Penalty, Simulation, Support};
pub use stages::Stage;
pub use summary::{
    BodySummary, PenetrationSummary, RUN_SCHEMA, ReactionSummary, RunEnergy, RunSummary,
    StrainSummary, WallSummary,
};
pub use until::{Reached, UntilEntry};
pub use wall::{BoxEntry, PlaneEntry, WallEntry};

use crate::scene::gravity_vector;
pub use crate::scene::{BridgeEntry, PairEntry};
use crate::{Error, toml_file};

/// A simulation to run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Scenario {
    /// One line that describes the scenario.
    pub title: String,
    /// Simulated time \[s\].
    pub duration: f64,
    /// Time between frames \[s\]. `None`: a hundredth of the duration.
    pub every: Option<f64>,
    /// Time between rows of the history \[s\]. `None`: a tenth of that between frames.
    pub history_every: Option<f64>,
    /// Whether the history has a row for every body, too.
    pub track: bool,
    /// Whether every frame is drawn too.
    pub pictures: bool,
    /// Whether every frame has tables of its bodies, contacts and walls too.
    pub tables: bool,
    /// Ends the run early once all bodies are at rest.
    pub rest: Option<RestEntry>,
    /// Limits of numbers in the tables over time that end the run early.
    pub until: Vec<UntilEntry>,
    /// Brings all bodies to rest after the duration, under the forces that act then. `None`: the run ends in
    /// motion.
    pub relax: Option<RelaxEntry>,
    /// Acceleration of gravity \[m/s²\]. `None`: that of the pack from which it starts, or 9.81 along −z.
    #[serde(deserialize_with = "gravity_vector")]
    pub gravity: Option<[f64; 3]>,
    /// The contact law of all pairs of materials without one of their own.
    pub contact: ContactEntry,
    /// Contact laws of pairs of materials.
    pub pair: Vec<PairEntry>,
    /// The choice of the time step.
    pub time_step: StepEntry,
    /// Error of the energy ledger over the energy turned over, above which the run stops.
    pub energy_error_limit: f64,
    /// Damping by the medium.
    pub medium: MediumEntry,
    /// Whether rigid bodies at rest are frozen.
    pub sleeping: bool,
    /// Whether deformable bodies at rest are frozen too.
    pub sleeping_deformables: bool,
    /// The periodic cell.
    pub cell: Option<CellEntry>,
    /// Materials by name.
    pub material: BTreeMap<String, MaterialEntry>,
    /// Walls.
    pub wall: Vec<WallEntry>,
    /// Bodies.
    pub body: Vec<BodyEntry>,
    /// Bonds between bodies.
    pub bond: Vec<BondEntry>,
    /// Loads on bodies.
    pub load: Vec<LoadEntry>,
    /// Sources of bodies.
    pub source: Vec<SourceEntry>,
    /// Where bodies leave.
    pub sink: Vec<GateEntry>,
    /// Where bodies that pass are counted.
    pub gauge: Vec<GateEntry>,
    /// Folder of another run of a scene, or of a pack, from whose checkpoint this one starts. `None`: bodies start where
    /// their entries place them.
    pub from: Option<PathBuf>,
    /// Walls of the pack that are taken away, by name.
    pub remove: Vec<String>,
    /// Folder for the results.
    pub out: PathBuf,
    /// Threads. `None`: one for each core.
    pub threads: Option<usize>,
    /// Time between checkpoints \[s of wall clock\].
    pub checkpoint_every: f64,
}

impl Default for Scenario {
    fn default() -> Self {
        Self {
            title: String::new(),
            duration: 1.0,
            every: None,
            history_every: None,
            track: false,
            pictures: false,
            tables: false,
            rest: None,
            until: Vec::new(),
            relax: None,
            gravity: None,
            contact: ContactEntry::default(),
            pair: Vec::new(),
            time_step: StepEntry::default(),
            energy_error_limit: books::LIMIT,
            medium: MediumEntry::default(),
            sleeping: true,
            sleeping_deformables: false,
            cell: None,
            material: BTreeMap::new(),
            wall: Vec::new(),
            body: Vec::new(),
            bond: Vec::new(),
            load: Vec::new(),
            source: Vec::new(),
            sink: Vec::new(),
            gauge: Vec::new(),
            from: None,
            remove: Vec::new(),
            out: PathBuf::from("out/run"),
            threads: None,
            checkpoint_every: 60.0,
        }
    }
}

impl Scenario {
    /// Reads a scenario file.
    ///
    /// # Errors
    ///
    /// [`Error::Read`], or [`Error::Scene`] with the place where the text is not a scenario.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        toml_file::read(path.as_ref())
    }

    /// Reads a scenario from text.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`], with the line and what is allowed there.
    pub fn from_toml(text: &str) -> Result<Self, Error> {
        toml_file::parse(text, Path::new("scenario"))
    }

    /// The scenario as text, which reads back equal.
    ///
    /// # Errors
    ///
    /// [`Error::Scene`] if a value cannot be written in TOML, such as a path that is not Unicode.
    pub fn to_toml(&self) -> Result<String, Error> {
        toml_file::write(self, Path::new("scenario"))
    }

    /// Time between frames \[s\].
    #[must_use]
    pub fn frame_interval(&self) -> f64 {
        self.every.unwrap_or(0.01 * self.duration)
    }

    /// Time between rows of the history \[s\].
    #[must_use]
    pub fn history_interval(&self) -> f64 {
        self.history_every.unwrap_or(0.1 * self.frame_interval())
    }
}
