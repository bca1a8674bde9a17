//! Space that repeats itself.

use std::mem::MaybeUninit;

use femdem_solve::mesh::{Matrix3, PeriodicCell};

use crate::border::{Failure, FemdemStatus, border, given, place};
use crate::handles::FemdemWorld;

/// A matrix.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemMatrix {
    /// Row by row.
    pub rows: [f64; 9],
}

impl From<&Matrix3> for FemdemMatrix {
    fn from(matrix: &Matrix3) -> Self {
        let mut rows = [0.0; 9];
        rows.copy_from_slice(matrix.transpose().as_slice());
        Self { rows }
    }
}

/// What a world without a cell is told.
fn no_cell(what: &str) -> Failure {
    let allowed = "of a world with a periodic cell: femdem_world_set_cell before its bodies";
    Failure::refused(what, "none", allowed)
}

/// Makes the space of a world periodic over these lengths, m; infinite: not along that axis. Before its bodies and without walls
/// across.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_cell(
    world: FemdemWorld,
    x: f64,
    y: f64,
    z: f64,
) -> FemdemStatus {
    border(|| {
        let sides = [x, y, z].map(|side| (side != f64::INFINITY).then_some(side));
        let cell = PeriodicCell::new(sides)?;
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| world.set_cell(cell))?)
        })
    })
}

/// Lets the edges of the cell, which are columns, move with velocities in m/s, and all free bodies with space.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_deform_cell(
    world: FemdemWorld,
    rates: Option<&FemdemMatrix>,
) -> FemdemStatus {
    border(|| {
        let rates = Matrix3::from_row_slice(&given("rates", rates)?.rows);
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| world.deform_cell(rates))?)
        })
    })
}

/// Writes the edges of the cell as columns, m.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_cell(
    world: FemdemWorld,
    edges: Option<&mut MaybeUninit<FemdemMatrix>>,
) -> FemdemStatus {
    border(|| {
        let to = place("edges", edges)?;
        world.with(|own| {
            let cell = own.world.cell().ok_or_else(|| no_cell("edges"))?;
            to.write(cell.edges().into());
            Ok(())
        })
    })
}

/// Writes the mean stress in a cell that repeats itself along all axes, Pa, positive in compression.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_cell_stress(
    world: FemdemWorld,
    stress: Option<&mut MaybeUninit<FemdemMatrix>>,
) -> FemdemStatus {
    border(|| {
        let to = place("stress", stress)?;
        world.with(|own| {
            let stress = own.world.cell_stress().ok_or_else(|| no_cell("stress"))?;
            to.write((&stress).into());
            Ok(())
        })
    })
}
