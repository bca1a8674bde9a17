//! Tables over time of walls that move: `wall_history.csv`, and `cells.csv` of controlled boxes and of the periodic cell.

use femdem_view::output::csv::quoted;

use super::history::{number, vector};
use super::measured::Measured;
use super::{CellState, Simulation};

/// Columns of `wall_history.csv`.
pub const WALL_HISTORY_COLUMNS: [&str; 9] =
    ["time", "wall", "x", "y", "z", "fx", "fy", "fz", "pressing"];

/// Columns of `cells.csv`.
pub const CELL_COLUMNS: [&str; 19] = [
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
    "shear_stress",
    "shear_strain",
    "error_x",
    "error_y",
    "error_z",
];

/// Rows of `wall_history.csv`: how far each wall is from where the scenario places it, and the force of the bodies on it,
/// as a vector and as what they press. Walls that have been taken away have none.
pub(super) fn wall_rows(simulation: &Simulation, seen: &Measured) -> Vec<Vec<String>> {
    let world = &simulation.world;
    let on_walls = seen.walls.iter().zip(&seen.pressing);
    let walls = simulation.walls.iter().zip(on_walls);
    let rows = walls.filter_map(|(wall, (force, pressing))| {
        let pose = world.wall_pose(wall.id)?;
        let mut row = vec![number(world.time()), quoted(&wall.name)];
        row.extend(vector(&pose.translation.vector));
        row.extend(vector(force));
        row.push(number(*pressing));
        Some(row)
    });
    rows.collect()
}

/// Rows of `cells.csv` at a time \[s\].
pub(super) fn cell_rows(time: f64, cells: &[CellState]) -> Vec<Vec<String>> {
    let rows = cells.iter().map(|state| {
        let mut row = vec![number(time), quoted(&state.name)];
        row.extend(state.sides.map(number));
        row.extend([state.volume(), state.solid_fraction].map(number));
        row.extend(state.stress.map(number));
        row.extend(state.strain.map(number));
        row.push(number(state.volumetric_strain()));
        let if_there = |value: Option<f64>| value.map_or(String::new(), number);
        row.extend([state.shear_stress, state.shear_strain].map(if_there));
        row.extend(state.errors.map(if_there));
        row
    });
    rows.collect()
}
