//! Surfaces: all bodies as one STL, a shape as OBJ.

use std::io::{self, Write};

use femdem_mesh::io::{obj, stl};
use femdem_mesh::{MeshError, Polyhedron};

use super::csv::invalid;
use crate::Snapshot;

/// Writes all bodies as one binary STL \[m\], for CFD meshing.
///
/// The surfaces are those of the bodies: touching bodies overlap by the penetration.
///
/// # Errors
///
/// If writing fails, or the snapshot does not pass [`Snapshot::check`] (as
/// [`io::ErrorKind::InvalidInput`]).
pub fn write_pack_stl(snapshot: &Snapshot, writer: impl Write) -> io::Result<()> {
    snapshot.check().map_err(invalid)?;
    let bodies = snapshot
        .bodies
        .iter()
        .map(|body| (&snapshot.shape_of(body).polyhedron, &body.pose));
    stl::write_binary_posed(bodies, writer).map_err(as_io)
}

/// Writes a shape as OBJ, in the coordinates that the poses of `bodies.csv` act on \[m\].
///
/// # Errors
///
/// If writing fails.
pub fn write_shape_obj(shape: &Polyhedron, writer: impl Write) -> io::Result<()> {
    obj::write(shape, writer).map_err(as_io)
}

fn as_io(error: MeshError) -> io::Error {
    match error {
        MeshError::Io(source) => source,
        other => io::Error::new(io::ErrorKind::InvalidInput, other),
    }
}

/// Name of the file of a shape: `shape-<name>.obj`, where `_` replaces every character except letters, digits,
/// `-`, `_` and `+`. For a pack with several shapes see [`shape_file_names`].
#[must_use]
pub fn shape_file_name(name: &str) -> String {
    file_name(name, |_| "_".to_owned())
}

/// [`shape_file_name`] with the UTF-8 bytes of each replaced character as `%XX` instead, so that no two names
/// share a file.
pub(crate) fn distinct_file_name(name: &str) -> String {
    file_name(name, |c| {
        let bytes = c.to_string().into_bytes();
        bytes.iter().map(|byte| format!("%{byte:02X}")).collect()
    })
}

/// Names of the files of the shapes of a pack: [`shape_file_name`], but where several shapes would share one,
/// `%XX` for the bytes of each replaced character.
#[must_use]
pub fn shape_file_names(names: &[&str]) -> Vec<String> {
    let short: Vec<String> = names.iter().map(|name| shape_file_name(name)).collect();
    let shared = |file: &String| short.iter().filter(|other| *other == file).count() > 1;
    let own = |(name, file): (&&str, &String)| {
        if shared(file) {
            distinct_file_name(name)
        } else {
            file.clone()
        }
    };
    names.iter().zip(&short).map(own).collect()
}

fn file_name(name: &str, replaced: impl Fn(char) -> String) -> String {
    let safe = |c: char| {
        if c.is_alphanumeric() || "-_+".contains(c) {
            c.to_string()
        } else {
            replaced(c)
        }
    };
    format!("shape-{}.obj", name.chars().map(safe).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    #[test]
    fn two_cubes_are_24_triangles() {
        let mut bytes = Vec::new();
        write_pack_stl(&two_cubes(), &mut bytes).unwrap();
        assert_eq!(bytes.len(), 84 + 24 * 50);
        assert_eq!(bytes[80..84], 24_u32.to_le_bytes());
    }

    #[test]
    fn a_shape_is_read_back_equal() {
        let cube = &two_cubes().shapes[0].polyhedron;
        let mut bytes = Vec::new();
        write_shape_obj(cube, &mut bytes).unwrap();
        assert_eq!(
            &obj::parse(std::str::from_utf8(&bytes).unwrap()).unwrap(),
            cube
        );
    }

    #[test]
    fn file_names_hold_no_separators() {
        assert_eq!(shape_file_name("../a b"), "shape-___a_b.obj");
        assert_eq!(shape_file_name("A10"), "shape-A10.obj");
    }

    /// The short name is left to one shape alone, so that a reader may look for the other first.
    #[test]
    fn shapes_of_a_pack_have_a_file_each() {
        assert_eq!(
            shape_file_names(&["a b", "P5", "a_b", "a.b", "sphere:level=3"]),
            [
                "shape-a%20b.obj",
                "shape-P5.obj",
                "shape-a_b.obj",
                "shape-a%2Eb.obj",
                "shape-sphere_level_3.obj"
            ]
        );
    }
}
