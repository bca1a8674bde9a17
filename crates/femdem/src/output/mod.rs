//! The files that a run writes: tables, ParaView files, surfaces.
//!
//! | file | module | for |
//! |---|---|---|
//! | `bodies.csv`, `contacts.csv` | [`csv`] | spreadsheets and scripts |
//! | `pack.vtu` | [`vtu`] | ParaView: the bodies as polyhedra |
//! | `contacts.vtp` | [`vtp`] | ParaView: the contacts as points with forces |
//! | `analysis/density-map.vti` | [`vti`] | ParaView: local packing density |
//! | `pack.stl`, `shape-<name>.obj` | [`surface`] | CFD meshing; one body alone |
//! | `*.pvd` | [`write_pvd`] | ParaView: files of a time series with their times |
//!
//! Every function takes a [`Snapshot`](crate::Snapshot) and a writer, so that a host can write anywhere;
//! [`write_file`] writes the output of such a function to a file.

pub mod csv;
mod pvd;
pub mod surface;
pub mod vti;
pub(crate) mod vtk;
pub mod vtp;
pub mod vtu;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

pub use pvd::{write_pvd, write_pvd_parts};

use crate::Error;

/// Writes a file through a buffer under a temporary name first: an existing file stays complete until the new
/// one is.
///
/// # Errors
///
/// [`Error::Write`] with the path if the folder cannot be written to, the disk is full, or `content`
/// fails; the unfinished file is removed.
pub fn write_file(
    path: impl AsRef<Path>,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Error> {
    let path = path.as_ref();
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".partial");
    let beside = path.with_file_name(name);
    let written = write_whole(&beside, content).and_then(|()| fs::rename(&beside, path));
    written.map_err(|source| {
        // The first error is reported; a file that was never created cannot be removed.
        let _ = fs::remove_file(&beside);
        Error::Write {
            path: path.to_path_buf(),
            source,
        }
    })
}

/// Bytes as base64 with padding.
pub(crate) fn base64(bytes: &[u8]) -> String {
    let mut text = String::new();
    vtk::encode(bytes, &mut text);
    text
}

fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::with_capacity(1 << 18, File::create(path)?);
    content(&mut writer)?;
    writer.flush()?;
    // A full disk may be reported only here.
    writer.get_ref().sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_keeps_the_old_file_and_names_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write_file(&path, |w| writeln!(w, "old")).unwrap();
        let error = write_file(&path, |w| {
            writeln!(w, "new")?;
            Err(io::Error::other("disk full"))
        })
        .unwrap_err()
        .to_string();
        assert!(
            error.contains("a.csv") && error.contains("disk full"),
            "{error}"
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "old\n");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_does_not_exist_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none").join("a.csv");
        assert!(matches!(
            write_file(&path, |_| Ok(())),
            Err(Error::Write { .. })
        ));
    }
}
