//! The state of a world as arrays.

use femdem::solve::Deformable;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{World, no_such};
use crate::arrays::{column, row, table, vectors};
use crate::contacts::columns;
use crate::error::refused;
use crate::shape::Shape;
use crate::threads::unlocked;

/// Tetrahedra and triangles.
type Cells<'py> = (Bound<'py, PyArray2<u32>>, Bound<'py, PyArray2<u32>>);

impl World {
    pub(super) fn soft(&self, id: u32) -> PyResult<Deformable<'_>> {
        let count = || self.world.deformable_ids().count();
        let body = self.world.deformable(id);
        body.ok_or_else(|| no_such("deformable body", id, count()))
    }
}

#[pymethods]
impl World {
    #[getter]
    fn time(&self) -> f64 {
        self.world.time()
    }

    #[getter]
    fn steps(&self) -> u64 {
        self.world.steps()
    }

    #[getter]
    fn time_step(&self) -> f64 {
        self.world.time_step()
    }

    #[getter]
    fn stable_step(&self) -> f64 {
        self.world.time_step_bound()
    }

    fn __len__(&self) -> usize {
        self.world.body_count()
    }

    #[getter]
    fn awake_count(&self) -> usize {
        self.world.awake_count()
    }

    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        column(py, self.world.body_ids())
    }

    #[getter]
    fn rigid_ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        column(py, self.world.rigid_ids())
    }

    #[getter]
    fn deformable_ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        column(py, self.world.deformable_ids())
    }

    /// Of the rigid bodies.
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let poses = self.world.rigid_ids().filter_map(|id| self.world.pose(id));
        table(py, poses.map(|pose| row(&pose)))
    }

    #[getter]
    fn angular_velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let ids = self.world.rigid_ids();
        vectors(py, ids.filter_map(|id| self.world.angular_velocity(id)))
    }

    #[getter]
    fn shape_ids<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let ids = self.world.rigid_ids();
        column(py, ids.filter_map(|id| self.world.shape_of(id)))
    }

    /// Of all bodies.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(
            py,
            self.world
                .body_ids()
                .filter_map(|id| self.world.position(id)),
        )
    }

    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        vectors(
            py,
            self.world
                .body_ids()
                .filter_map(|id| self.world.velocity(id)),
        )
    }

    #[getter]
    fn masses<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        column(
            py,
            self.world.body_ids().filter_map(|id| self.world.mass(id)),
        )
    }

    #[getter]
    fn kinetic_energies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let ids = self.world.body_ids();
        column(py, ids.filter_map(|id| self.world.body_kinetic_energy(id)))
    }

    #[getter]
    fn asleep<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        column(py, self.world.body_ids().map(|id| self.world.is_asleep(id)))
    }

    /// The rigid shapes.
    #[getter]
    fn shapes(&self) -> Vec<Shape> {
        self.shapes.iter().cloned().map(Shape::from).collect()
    }

    /// Nodes of a deformable body, with their velocities.
    fn nodes<'py>(&self, py: Python<'py>, body: u32) -> PyResult<[Bound<'py, PyArray2<f64>>; 2]> {
        let body = self.soft(body)?;
        Ok([
            vectors(py, body.positions().iter().copied())?,
            vectors(py, body.velocities().iter().copied())?,
        ])
    }

    /// Tetrahedra of a deformable body, and the triangles of its skin, by its nodes.
    fn cells<'py>(&self, py: Python<'py>, body: u32) -> PyResult<Cells<'py>> {
        let body = self.soft(body)?;
        let mesh = body.model().mesh();
        let tets = table(py, mesh.tets().iter().copied())?;
        Ok((tets, table(py, mesh.skin().iter().copied())?))
    }

    /// Cauchy stresses of the elements of a deformable body: xx, yy, zz, xy, yz, zx.
    fn stresses<'py>(&self, py: Python<'py>, body: u32) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let body = self.soft(body)?;
        let stresses = body.stresses().map_err(refused)?;
        let components = stresses.iter().map(|element| {
            let s = &element.cauchy;
            [
                s[(0, 0)],
                s[(1, 1)],
                s[(2, 2)],
                s[(0, 1)],
                s[(1, 2)],
                s[(2, 0)],
            ]
        });
        table(py, components)
    }

    /// The contacts as columns.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        columns(py, &self.world.contacts())
    }

    /// The walls: number, name, force and torque about its origin.
    fn walls(&self) -> Vec<(u32, String, [f64; 3], [f64; 3])> {
        let walls = self.world.walls().map(|(id, wall)| {
            let load = self.world.wall_load(id).map(|load| load.total);
            let load = load.unwrap_or_default();
            (
                id,
                wall.name().to_owned(),
                load.force.into(),
                load.torque.into(),
            )
        });
        walls.collect()
    }

    /// The energy ledger, with its sums.
    fn ledger(&self) -> PyResult<(String, f64, f64)> {
        let ledger = self.world.ledger();
        let text = serde_json::to_string(&ledger).map_err(refused)?;
        Ok((text, ledger.error(), ledger.error_relative()))
    }

    fn residuals(&self) -> PyResult<String> {
        serde_json::to_string(&self.world.residuals()).map_err(refused)
    }

    /// The measured limit of the step, and the step.
    fn stability(&self, py: Python<'_>) -> PyResult<Option<(f64, f64)>> {
        let measured = unlocked(py, || self.world.stability())?;
        Ok(measured.map(|found| (found.limit, found.step)))
    }
}
