//! `cargo xtask browser`: the report page in a real browser, which is installed if there is none.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};

/// Names of the browser.
const NAMES: [&str; 5] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
];

/// Folder of the pictures for inspection, from the workspace root.
const PICTURES: &str = "out/browser";

/// Runs the browser tests; returns whether they passed. Without a browser, and without a way to install one,
/// they are skipped with a message.
///
/// # Errors
/// When cargo cannot be started.
pub(crate) fn run(root: &Path) -> Result<bool> {
    if !present() && !install() {
        println!(
            "skipped: there is no Chromium, and it could not be installed; install it, or name it in \
             the variable CHROMIUM"
        );
        return Ok(true);
    }
    let pictures = root.join(PICTURES);
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args([
            "test",
            "--locked",
            "--package",
            "femdem-view",
            "--test",
            "browser",
        ])
        .args(["--", "--nocapture", "--test-threads", "1"])
        .env("FEMDEM_BROWSER", "required")
        .env("FEMDEM_SCREENSHOTS", &pictures)
        .current_dir(root)
        .status()
        .context("cannot start cargo")?;
    println!("pictures of the page: {PICTURES}");
    Ok(status.success())
}

fn present() -> bool {
    std::env::var_os("CHROMIUM").is_some() || NAMES.iter().any(|name| runs(name, &["--version"]))
}

/// Tries the package manager of Debian and its kin; whether there is a browser then.
fn install() -> bool {
    println!("no Chromium found: trying to install it with apt-get");
    runs("apt-get", &["update", "-qq"])
        && runs("apt-get", &["install", "-qq", "-y", "chromium"])
        && present()
}

/// Whether a program is there and ends well.
fn runs(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_is_not_there_does_not_run() {
        assert!(!runs("no-such-program-of-any-kind", &[]));
        assert!(runs("cargo", &["--version"]));
    }
}
