//! Surface files, and the meshes of what they hold.

use std::path::Path;

use femdem_mesh::io::{self, Options, Report};
use femdem_mesh::{MeshError, Polyhedron};

use super::Unit;
use crate::Error;

/// Reads a surface file into metres, mends it if asked to, and reports what was done.
pub(crate) fn read(path: &Path, unit: Unit, repair: bool) -> Result<(Polyhedron, Report), Error> {
    let options = if repair {
        Options::REPAIR
    } else {
        Options::default()
    };
    let (polyhedron, report) = io::read_file_with(path, &options)?;
    let polyhedron = match unit {
        Unit::M => polyhedron,
        unit => polyhedron
            .scaled(unit.metres())
            .map_err(|problem| in_file(path, problem))?,
    };
    Ok((polyhedron, report))
}

/// The error of a body with the file that it was read from.
pub(crate) fn in_file(path: &Path, problem: MeshError) -> MeshError {
    MeshError::InFile {
        path: path.to_path_buf(),
        problem: Box::new(problem),
    }
}
