//! A world: bodies between walls, and their step.

mod add;
mod bonds;
mod cell;
mod cracks;
mod hand;
mod state;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use femdem::contact::{ContactParameters, MaterialId};
use femdem::mesh::Vector3;
use femdem::results::{PACK_CHECKPOINT, SavedPack};
use femdem::run::{Controls, Run};
use femdem::solve::checkpoint::{decode, encode};
use femdem::solve::{self, ModelId, SolveError, WorldParameters};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};

use crate::error::{options, refused};
use crate::shape::Form;
use crate::threads::unlocked;

/// Time of stepping after which Ctrl-C is looked for.
const BREATH: Duration = Duration::from_millis(80);

/// Rigid and deformable bodies between walls.
#[pyclass(module = "femdem._femdem")]
pub struct World {
    world: solve::World,
    /// Its rigid shapes by their numbers.
    shapes: Vec<Arc<Form>>,
    /// The models of deformable bodies that came from here: of what shape, and how they were made.
    models: Vec<(Arc<Form>, String, ModelId)>,
    /// What its controlled walls and its cell are to do.
    controls: Controls,
}

/// A world as bytes.
#[derive(Serialize, Deserialize)]
struct Stored<C> {
    world: Vec<u8>,
    controls: C,
}

impl World {
    fn of(world: solve::World, controls: Controls) -> Self {
        let shapes = world.shapes().iter();
        Self {
            shapes: shapes.map(|shape| Arc::new(Form::from(shape))).collect(),
            models: Vec::new(),
            world,
            controls,
        }
    }
}

#[pymethods]
impl World {
    #[new]
    fn new(parameters: &str) -> PyResult<Self> {
        let parameters: WorldParameters = options("World", parameters)?;
        let world = solve::World::new(parameters).map_err(refused)?;
        Ok(Self::of(world, Controls::default()))
    }

    /// The world of the bytes of `to_bytes`.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let (world, controls) = unlocked(py, || {
            let stored: Stored<Controls> = decode(bytes)?;
            let world = solve::World::from_bytes(&stored.world)?;
            Ok::<_, SolveError>((world, stored.controls))
        })?;
        Ok(Self::of(world, controls))
    }

    /// The world of a checkpoint in the folder of a pack or a run.
    #[staticmethod]
    fn from_folder(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let (world, controls) = unlocked(py, || {
            if folder.join(PACK_CHECKPOINT).is_file() {
                let packing = SavedPack::read(&folder)?.packing;
                return Ok((packing.into_world(), Controls::default()));
            }
            let (run, _) = Run::read(&folder)?;
            let simulation = run.simulation();
            let parts = (simulation.world.clone(), simulation.controls.clone());
            Ok::<_, femdem::Error>(parts)
        })?;
        Ok(Self::of(world, controls))
    }

    /// The whole state.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = unlocked(py, || {
            let world = self.world.to_bytes()?;
            let controls = &self.controls;
            encode(&Stored { world, controls })
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// A checksum of the state of bodies, walls and contacts.
    fn state_hash(&self, py: Python<'_>) -> PyResult<u64> {
        unlocked(py, || self.world.state_hash())
    }

    /// Takes at most so many steps, or steps until a time is reached, without the interpreter lock; returns how many it took.
    /// Ctrl-C ends it between two of them.
    fn step(&mut self, py: Python<'_>, steps: u64, until: f64) -> PyResult<u64> {
        let (world, controls) = (&mut self.world, &mut self.controls);
        let first = world.steps();
        let last = first.saturating_add(steps);
        while world.steps() < last && world.time() < until {
            unlocked(py, || {
                let began = Instant::now();
                while world.steps() < last && world.time() < until && began.elapsed() < BREATH {
                    if controls.is_empty() {
                        world.step()?;
                    } else {
                        controls.step(world)?;
                    }
                }
                Ok::<_, SolveError>(())
            })?;
            py.check_signals()?;
        }
        Ok(world.steps() - first)
    }

    /// Replaces the contact law of all pairs of materials without one of their own.
    fn set_contact(&mut self, py: Python<'_>, law: &str) -> PyResult<()> {
        let law: ContactParameters = options("contact", law)?;
        unlocked(py, || self.world.set_contact(law))
    }

    /// Gives a pair of materials a law of its own.
    fn set_law(&mut self, py: Python<'_>, a: u8, b: u8, law: Option<&str>) -> PyResult<()> {
        let law: Option<ContactParameters> = law.map(|law| options("law", law)).transpose()?;
        unlocked(py, || self.world.set_law(MaterialId(a), MaterialId(b), law))
    }

    fn set_gravity(&mut self, gravity: [f64; 3]) -> PyResult<()> {
        self.world
            .set_gravity(Vector3::from(gravity))
            .map_err(refused)
    }

    fn set_sleeping(&mut self, enabled: bool) {
        self.world.set_sleeping(enabled);
    }

    fn parameters(&self) -> PyResult<String> {
        serde_json::to_string(self.world.parameters()).map_err(refused)
    }

    fn restart_ledger(&mut self) {
        self.world.restart_ledger();
    }
}

/// Things that there are none of.
fn no_such(what: &'static str, index: u32, count: usize) -> PyErr {
    let index = index as usize;
    refused(SolveError::NoSuch { what, index, count })
}
