//! `walls.csv`.

use std::path::Path;

use femdem_mesh::Pose;

use super::bodies::pose;
use super::csv::{Record, Text};
use crate::ViewError;

/// Name of the table of walls.
pub const WALLS: &str = "walls.csv";

/// Reads the walls of a frame of a run: their names and poses, from the coordinates of the scene to the world.
///
/// # Errors
///
/// [`ViewError::Read`], and [`ViewError::Table`] with file and line.
pub fn read_walls(path: &Path) -> Result<Vec<(String, Pose)>, ViewError> {
    let text = Text::read(path)?;
    let name = text.need("wall")?;
    let place = text.need_all(["x", "y", "z"])?;
    let turn = text.need_all(["qw", "qx", "qy", "qz"])?;
    let wall = |record: Record| {
        let pose = pose(&record, place, turn)?;
        Ok((record.text(name).to_owned(), pose))
    };
    text.records().map(wall).collect()
}
