//! Tables over time of walls that move: `wall_history.csv`, and `cells.csv` of controlled boxes.

use femdem_view::output::csv::quoted;

use super::history::{number, vector};
use super::{ContactForces, Simulation};

/// Columns of `wall_history.csv`.
pub const WALL_HISTORY_COLUMNS: [&str; 8] = ["time", "wall", "x", "y", "z", "fx", "fy", "fz"];

/// Columns of `cells.csv`.
pub const CELL_COLUMNS: [&str; 17] = [
    "time",
    "cell",
    "size_x",
    "size_y",
    "size_z",
    "volume",
    "solid_fraction",
    "stress_x",
    "stress_y",
    "stress_z",
    "strain_x",
    "strain_y",
    "strain_z",
    "volumetric_strain",
    "error_x",
    "error_y",
    "error_z",
];

/// Rows of `wall_history.csv`: how far each wall is from where the scenario places it, and the force of the bodies on it.
/// Walls that have been taken away have none.
pub(super) fn wall_rows(simulation: &Simulation, forces: &ContactForces) -> Vec<Vec<String>> {
    let world = &simulation.world;
    let walls = simulation.walls.iter().zip(&forces.walls);
    let rows = walls.filter_map(|(wall, force)| {
        let pose = world.wall_pose(wall.id)?;
        let mut row = vec![number(world.time()), quoted(&wall.name)];
        row.extend(vector(&pose.translation.vector));
        row.extend(vector(force));
        Some(row)
    });
    rows.collect()
}

/// Rows of `cells.csv`.
pub(super) fn cell_rows(simulation: &Simulation) -> Vec<Vec<String>> {
    let world = &simulation.world;
    let controls = &simulation.controls;
    let rows = controls.cells().iter().enumerate().map(|(k, cell)| {
        let state = cell.state(world);
        let mut row = vec![number(world.time()), quoted(&cell.name)];
        row.extend(state.sides.map(number));
        row.extend([state.volume(), state.solid_fraction].map(number));
        row.extend(state.stress.map(number));
        row.extend(state.strain.map(number));
        row.push(number(state.volumetric_strain()));
        let errors = [0, 1, 2].map(|axis| controls.stress_error(k, axis, world));
        row.extend(errors.map(|error| error.map_or(String::new(), number)));
        row
    });
    rows.collect()
}
