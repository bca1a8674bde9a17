//! The bodies and contacts of a pack or a run in a folder.

use std::path::PathBuf;

use femdem::input::{self, InputOptions};
use femdem::results::{self, PACK_CHECKPOINT, SavedPack};
use femdem::run::{RUN_CHECKPOINT, Run, Stage};
use femdem::{ContactRow, Partner};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{column, row, table, vectors};
use crate::shape::Shape;
use crate::threads::unlocked;

/// The file of the scene in the folder of a run.
const SCENE: &str = "scene.toml";

/// Bodies and contacts at one moment.
#[pyclass(frozen, module = "femdem._femdem")]
pub struct Snapshot {
    own: femdem::Snapshot,
}

#[pymethods]
impl Snapshot {
    /// The state of the checkpoint in a folder, or of its tables.
    #[staticmethod]
    fn from_folder(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let own = unlocked(py, || {
            if folder.join(PACK_CHECKPOINT).is_file() {
                return Ok(results::snapshot(&SavedPack::read(&folder)?.packing));
            }
            if folder.join(RUN_CHECKPOINT).is_file() {
                return Run::read(&folder)?.0.simulation().snapshot();
            }
            Ok::<_, femdem::Error>(input::read_folder(&folder, &InputOptions::default())?)
        })?;
        Ok(Self { own })
    }

    #[getter]
    fn shapes(&self) -> Vec<Shape> {
        let shapes = self.own.shapes.iter();
        let pictures = shapes.map(|s| Shape::picture(s.name.clone(), s.polyhedron.clone()));
        pictures.collect()
    }

    #[getter]
    fn shape_ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        column(py, self.own.bodies.iter().map(|body| body.shape))
    }

    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(py, self.own.bodies.iter().map(|body| row(&body.pose)))
    }

    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        column(py, self.own.masses.iter().copied())
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, self.own.velocities.iter().copied())
    }

    /// The contacts as columns; walls have their names in a list.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let contacts = &self.own.contacts;
        let each = |of: fn(&ContactRow) -> f64| column(py, contacts.iter().map(of));
        let partners = contacts.iter().map(|contact| match &contact.partner {
            Partner::Body(body) => i64::from(*body),
            Partner::Wall(_) => -1,
        });
        let walls = contacts.iter().map(|contact| match &contact.partner {
            Partner::Body(_) => None,
            Partner::Wall(name) => Some(name.clone()),
        });
        let columns = PyDict::new(py);
        columns.set_item(
            "body",
            column(py, contacts.iter().map(|c| i64::from(c.body))),
        )?;
        columns.set_item("partner", column(py, partners))?;
        columns.set_item("wall", walls.collect::<Vec<_>>())?;
        columns.set_item(
            "point",
            vectors(py, contacts.iter().map(|c| c.point.coords))?,
        )?;
        columns.set_item("normal", vectors(py, contacts.iter().map(|c| c.normal))?)?;
        columns.set_item("normal_force", each(|c| c.normal_force))?;
        columns.set_item(
            "friction",
            vectors(py, contacts.iter().map(|c| c.friction))?,
        )?;
        columns.set_item("area", each(|c| c.area))?;
        columns.set_item("volume", each(|c| c.volume))?;
        let class = contacts.iter().map(|c| c.class.name());
        columns.set_item("class", class.collect::<Vec<_>>())?;
        Ok(columns)
    }
}

/// Names and folders of the stages of the scene in a folder, in their order.
#[pyfunction]
pub fn stages(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<(String, PathBuf)>> {
    let stages = unlocked(py, || Stage::read(folder.join(SCENE), Some(&folder)))?;
    let each = stages.into_iter();
    Ok(each.map(|stage| (stage.name, stage.scenario.out)).collect())
}
