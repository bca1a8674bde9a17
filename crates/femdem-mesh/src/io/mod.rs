//! Surface files: Wavefront OBJ and STL.

pub mod obj;
pub mod stl;

use crate::{MeshError, Point3, Polyhedron, Pose};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Largest file that is read \[bytes\].
pub const MAX_FILE_BYTES: u64 = 1 << 30;

/// Reads a body from a file; the ending of its name, .obj or .stl in any case, tells the format.
///
/// # Errors
///
/// If the ending is another one, the file cannot be read, or it does not hold one closed surface;
/// the message names the file.
pub fn read_file(path: impl AsRef<Path>) -> Result<Polyhedron, MeshError> {
    let path = path.as_ref();
    let ending = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_ascii_lowercase();
    let read: fn(BufReader<File>) -> Result<Polyhedron, MeshError> = match ending.as_str() {
        "obj" => obj::read,
        "stl" => stl::read,
        _ => {
            return Err(MeshError::UnknownFormat {
                path: path.to_path_buf(),
            });
        }
    };
    File::open(path)
        .map_err(MeshError::from)
        .and_then(|file| read(BufReader::new(file)))
        .map_err(|problem| MeshError::InFile {
            path: path.to_path_buf(),
            problem: Box::new(problem),
        })
}

/// All bytes of a reader, or an error if there are more than `allowed`.
fn read_limited(reader: impl Read, allowed: u64) -> Result<Vec<u8>, MeshError> {
    let mut bytes = Vec::new();
    reader.take(allowed + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > allowed {
        return Err(MeshError::FileTooLarge { allowed });
    }
    Ok(bytes)
}

/// World coordinates of a body's vertices; an error if a pose makes them anything but numbers.
fn posed_vertices(body: &Polyhedron, pose: &Pose) -> Result<Vec<Point3>, MeshError> {
    let vertices: Vec<Point3> = body.vertices().iter().map(|v| pose * v).collect();
    let bad = vertices
        .iter()
        .position(|v| !v.iter().all(|x| x.is_finite()));
    match bad {
        None => Ok(vertices),
        Some(vertex) => {
            let Point3 { coords } = vertices[vertex];
            Err(MeshError::NotFinite {
                vertex,
                x: coords.x,
                y: coords.y,
                z: coords.z,
            })
        }
    }
}

/// Reads a coordinate.
fn coordinate(word: &str, line: usize) -> Result<f64, MeshError> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(MeshError::Parse {
            line,
            problem: format!("\"{}\" is not a finite number", shortened(word)),
        }),
    }
}

/// The start of a word, for messages about files that are no text at all.
fn shortened(word: &str) -> String {
    word.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endless_input_is_cut_off() {
        let endless = read_limited(std::io::repeat(b'v'), 1000);
        assert!(matches!(
            endless,
            Err(MeshError::FileTooLarge { allowed: 1000 })
        ));
        assert_eq!(read_limited(&[7; 1000][..], 1000).unwrap(), [7; 1000]);
    }
}
