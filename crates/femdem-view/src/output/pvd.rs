//! Time series for ParaView: a list of files, each with its time.

use std::io::Write as _;
use std::path::Path;

use super::file::write_file;
use crate::ViewError;

/// Writes a `.pvd` file that lists the files of a time series, so that ParaView opens them as one.
///
/// Each step is its time \[s\] and its file (`.vtu` or `.vtp`), named relative to the folder of the `.pvd`
/// file. The list may grow: if it is written again after every output it is always complete, because the old
/// file remains until the new one is complete.
///
/// ```
/// # let folder = std::env::temp_dir().join("femdem-doc-pvd");
/// # std::fs::create_dir_all(&folder)?;
/// use femdem_view::output::write_pvd;
/// write_pvd(folder.join("run.pvd"), &[(0.0, "step-0000.vtu"), (0.01, "step-0001.vtu")])?;
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`ViewError::Option`] for a time that is not finite, [`ViewError::Write`] if the file cannot be written.
pub fn write_pvd<P: AsRef<Path>>(
    path: impl AsRef<Path>,
    steps: &[(f64, P)],
) -> Result<(), ViewError> {
    let steps: Vec<_> = steps.iter().map(|(time, file)| (*time, 0, file)).collect();
    write_pvd_parts(path, &steps)
}

/// As [`write_pvd`] for steps of several files: each is its time \[s\], the number of its part, and its file.
/// ParaView shows all parts of a time together.
///
/// # Errors
///
/// As [`write_pvd`].
pub fn write_pvd_parts<P: AsRef<Path>>(
    path: impl AsRef<Path>,
    steps: &[(f64, u32, P)],
) -> Result<(), ViewError> {
    for (time, ..) in steps {
        if !time.is_finite() {
            return Err(ViewError::Option {
                name: "time",
                value: time.to_string(),
                allowed: "a finite number of seconds",
            });
        }
    }
    write_file(path, |out| {
        writeln!(
            out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
             byte_order=\"LittleEndian\">\n<Collection>"
        )?;
        for (time, part, file) in steps {
            let file = attribute(&file.as_ref().to_string_lossy());
            writeln!(
                out,
                "<DataSet timestep=\"{time}\" part=\"{part}\" file=\"{file}\"/>"
            )?;
        }
        writeln!(out, "</Collection>\n</VTKFile>")
    })
}

/// Text for an XML attribute, with forward slashes in paths.
fn attribute(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\\' => out.push('/'),
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_has_its_time_and_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        write_pvd(&path, &[(0.0, "s/0.vtu"), (0.1, "a&\"b\".vtu")]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows: Vec<&str> = text
            .lines()
            .filter(|line| line.contains("DataSet"))
            .collect();
        assert_eq!(
            rows,
            [
                "<DataSet timestep=\"0\" part=\"0\" file=\"s/0.vtu\"/>",
                "<DataSet timestep=\"0.1\" part=\"0\" file=\"a&amp;&quot;b&quot;.vtu\"/>",
            ]
        );
        assert!(text.ends_with("</Collection>\n</VTKFile>\n"));
    }

    #[test]
    fn a_time_that_is_not_finite_is_refused_and_nothing_is_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        let error = write_pvd(&path, &[(f64::NAN, "0.vtu")]).unwrap_err();
        assert!(error.to_string().contains("time = NaN"), "{error}");
        assert!(!path.exists());
    }
}
