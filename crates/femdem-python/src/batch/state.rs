//! The state of a batch as arrays.

use femdem::contact::BodyId;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{Body, ContactBatch};
use crate::arrays::{column, table, vectors};
use crate::contacts::columns;
use crate::shape::Shape;

impl ContactBatch {
    fn own(&self) -> impl Iterator<Item = &Body> {
        self.bodies.iter().flatten()
    }
}

/// A wall: its number, its name, and the force and the torque about its origin.
type WallRow = (u32, String, [f64; 3], [f64; 3]);

#[pymethods]
impl ContactBatch {
    fn __len__(&self) -> usize {
        self.batch.len()
    }

    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<BodyId>> {
        column(py, self.batch.body_ids())
    }

    #[getter]
    fn shapes(&self) -> Vec<Shape> {
        self.own().map(|body| body.form.clone().into()).collect()
    }

    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        column(py, self.own().map(|body| body.mass))
    }

    /// Inertia tensors as rows of nine.
    #[getter]
    fn inertias<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let tensors = self.own().map(|body| body.tensor.transpose());
        // By rows: the columns of the transpose.
        table(
            py,
            tensors.map(|m| std::array::from_fn::<f64, 9, _>(|k| m[k])),
        )
    }

    #[getter]
    fn centroids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(py, self.own().map(|body| body.centroid))
    }

    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &self.batch.contacts())
    }

    #[getter]
    fn stable_step(&self) -> f64 {
        self.batch.stable_step(&self.motions)
    }

    /// Energy of the contacts and of their springs, pairs looked at and pairs in touch, as of the last update.
    #[getter]
    fn totals(&self) -> (f64, f64, usize, usize) {
        let totals = self.batch.totals();
        (
            totals.energy,
            totals.spring_energy,
            totals.candidates,
            totals.touching,
        )
    }

    fn walls(&self) -> Vec<WallRow> {
        let loads = self.batch.wall_loads();
        let walls = self.batch.walls().map(|(id, wall)| {
            let load = &loads[id as usize].total;
            let name = wall.name().to_owned();
            (id, name, load.force.into(), load.torque.into())
        });
        walls.collect()
    }
}
