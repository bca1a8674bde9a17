//! Space that repeats itself.

use femdem::mesh::{Matrix3, PeriodicCell};
use femdem::run::ControlEntry;
use femdem::solve::Alone;
use pyo3::prelude::*;

use super::World;
use crate::error::{options, refused};
use crate::threads::unlocked;

/// The rows of a matrix.
fn rows(matrix: &Matrix3) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]))
}

#[pymethods]
impl World {
    /// Makes space periodic over these lengths; `None` where it does not repeat itself.
    fn set_cell(&mut self, py: Python<'_>, sides: [Option<f64>; 3]) -> PyResult<()> {
        let cell = PeriodicCell::new(sides).map_err(refused)?;
        unlocked(py, || self.world.set_cell(cell))
    }

    /// Lets the edges of the cell, the columns, move with velocities by rows. Its control ends.
    fn deform_cell(&mut self, py: Python<'_>, rates: [[f64; 3]; 3]) -> PyResult<()> {
        let rates = Matrix3::from_fn(|i, j| rates[i][j]);
        let (world, controls) = (&mut self.world, &mut self.controls);
        unlocked(py, || {
            world.deform_cell(rates)?;
            controls.control_cell(None, world)?;
            world.deform_cell(rates).map_err(femdem::Error::from)
        })
    }

    /// Lets the cell follow stresses, rates of strain and a shear, as a scene describes them, or ends that.
    fn control_cell(&mut self, py: Python<'_>, control: Option<&str>) -> PyResult<()> {
        let entry: Option<ControlEntry> = control.map(|x| options("control", x)).transpose()?;
        let (world, controls) = (&mut self.world, &mut self.controls);
        unlocked(py, || controls.control_cell(entry.as_ref(), world))
    }

    /// The boxes with controlled walls, and the controlled cell.
    fn controlled_cells(&self) -> PyResult<String> {
        let cells = self.controls.cells(&self.world, &mut Alone);
        let cells = cells.map_err(refused)?;
        serde_json::to_string(&cells).map_err(refused)
    }

    /// Edges of the cell as columns, by rows.
    fn cell(&self) -> Option<[[f64; 3]; 3]> {
        self.world.cell().map(|cell| rows(cell.edges()))
    }

    fn cell_stress(&self) -> Option<[[f64; 3]; 3]> {
        self.world.cell_stress().as_ref().map(rows)
    }
}
