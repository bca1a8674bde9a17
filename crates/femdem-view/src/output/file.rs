//! Files that are whole or not there.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::ViewError;

/// Writes a file through a buffer under a temporary name first: an existing file stays complete until the new
/// one is.
///
/// # Errors
///
/// [`ViewError::Write`] with the path if the folder cannot be written to, the disk is full, or `content`
/// fails; the unfinished file is removed.
pub fn write_file(
    path: impl AsRef<Path>,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), ViewError> {
    let path = path.as_ref();
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".partial");
    let beside = path.with_file_name(name);
    let written = write_whole(&beside, content).and_then(|()| fs::rename(&beside, path));
    written.map_err(|source| {
        // The first error is reported; a file that was never created cannot be removed.
        let _ = fs::remove_file(&beside);
        ViewError::Write {
            path: path.to_path_buf(),
            source,
        }
    })
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
            Err(ViewError::Write { .. })
        ));
    }
}
