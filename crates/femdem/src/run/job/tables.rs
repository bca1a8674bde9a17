//! Tables of a frame, in the form of those of a pack.

use std::fs;
use std::path::{Path, PathBuf};

use femdem_view::ViewError;
use femdem_view::input::{BODIES, CONTACTS, InputOptions, WALLS, read_folder, read_walls};
use femdem_view::output::{csv, surface, write_file};

use crate::run::Run;
use crate::run::inside::inside;
use crate::{Error, Snapshot};

/// Folder of all frames.
pub(super) const FRAMES: &str = "frames";

fn folder_name(number: usize) -> String {
    format!("{number:05}")
}

impl Run {
    /// Folder of the tables of a frame, in the folder of the run.
    #[must_use]
    pub fn tables_of(&self, folder: &Path, number: usize) -> PathBuf {
        folder.join(FRAMES).join(folder_name(number))
    }

    /// Reads a frame from its tables: what [`Simulation::snapshot`](crate::run::Simulation::snapshot) was then, without the
    /// gap of the classes of deformable bodies' contacts. Gravity is that of the present scene, and so is a periodic cell.
    ///
    /// # Errors
    ///
    /// [`Error::View`] with the file at fault: the tables are written where the scene says so.
    pub fn read_frame(&self, folder: &Path, number: usize) -> Result<Snapshot, Error> {
        let tables = self.tables_of(folder, number);
        let simulation = self.simulation();
        let options = InputOptions {
            gravity: simulation.level_gravity(),
            ..InputOptions::default()
        };
        let mut snapshot = read_folder(&tables, &options)?;
        let poses = read_walls(&tables.join(WALLS))?;
        let walls = poses.iter().map(|(name, pose)| {
            let mut walls = simulation.world.walls();
            let known = walls.find(|(_, wall)| wall.name() == name);
            known.map(|(_, wall)| (wall, *pose))
        });
        snapshot.space = simulation.space();
        // Without one of the walls the container is not known.
        let walls: Option<Vec<_>> = walls.collect();
        snapshot.container = walls.and_then(|walls| inside(walls.into_iter(), &snapshot));
        Ok(snapshot)
    }

    /// Writes the tables of a frame into its folder, and the shapes: those that stay the same into the folder of all frames.
    pub(super) fn write_tables(&self, frames: &Path, number: usize) -> Result<(), Error> {
        let folder = frames.join(folder_name(number));
        fs::create_dir_all(&folder).map_err(|source| ViewError::Write {
            path: folder.clone(),
            source,
        })?;
        let simulation = self.simulation();
        let snapshot = simulation.snapshot()?;
        let names: Vec<&str> = snapshot.shapes.iter().map(|s| s.name.as_str()).collect();
        let rigid = simulation.world.shapes().len();
        let files = surface::shape_file_names(&names).into_iter();
        for (i, (shape, file)) in snapshot.shapes.iter().zip(files).enumerate() {
            let path = if i < rigid { frames } else { &folder }.join(file);
            if i >= rigid || number == 0 || !path.exists() {
                write_file(path, |w| surface::write_shape_obj(&shape.polyhedron, w))?;
            }
        }
        write_file(folder.join(CONTACTS), |w| csv::write_contacts(&snapshot, w))?;
        write_file(folder.join(WALLS), |w| simulation.write_walls(w))?;
        Ok(write_file(folder.join(BODIES), |w| {
            csv::write_bodies(&snapshot, w)
        })?)
    }
}
