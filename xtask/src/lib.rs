//! What the programs `xtask` and `studies` share: where the workspace is, and how they end.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result};

/// The folder of the workspace manifest: the parent of the folder of the package that cargo runs.
///
/// # Errors
/// When the program was not started by cargo.
pub fn workspace_root() -> Result<PathBuf> {
    let package = std::env::var_os("CARGO_MANIFEST_DIR")
        .context("CARGO_MANIFEST_DIR is not set: run this program by cargo")?;
    let mut root = PathBuf::from(package);
    root.pop();
    Ok(root)
}

/// The folder of what cargo builds for the workspace at `root`, from where cargo is run.
#[must_use]
pub fn target_folder(root: &Path) -> PathBuf {
    let own = std::env::var_os("CARGO_TARGET_DIR");
    // A folder that is not relative stays what it is.
    root.join(own.unwrap_or_else(|| "target".into()))
}

/// The exit code of a command that ran without a problem (`true`), found one, or failed; prints the failure.
pub fn end(result: Result<bool>) -> ExitCode {
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
