//! `cargo xtask browser`: the report page in a real browser, which is installed if there is none.

use anyhow::{Context, Result};
use std::path::Path;

use crate::command::{apt_get, cargo, runs};

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
    let status = cargo()
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

/// Tries to install it; whether there is a browser then.
fn install() -> bool {
    println!("no Chromium found");
    apt_get(&["chromium"]) && present()
}
