//! Chores of the project, run as `cargo xtask <command>`.
//!
//! `tidy` checks what the compiler does not: the documented crate graph against the real one, the tests of the
//! invariants, file lengths, leftovers, crate docs, broken links. `ci` runs every check that a change must
//! pass, in the same order as `.ci/run`. `browser` tests the report page in Chromium. `validate` makes the long
//! runs whose results are in `docs/validation`, and `reproduce` the studies of the founding paper, compared
//! with its values.

mod browser;
mod ci;
mod reproduce;
mod tidy;
mod validate;

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Chores of the project")]
struct Cli {
    #[command(subcommand)]
    command: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Check the crate graph, the invariants' tests, file lengths, leftovers, crate docs and links
    Tidy,
    /// Run format, clippy, test, documentation and tidy checks; stop at the first failure
    Ci,
    /// Try the report page in headless Chromium, installed if it is not there
    Browser,
    /// Run the program against the figures it is to reach, and write docs/validation
    Validate(validate::Options),
    /// Run the founding paper's studies, and print our numbers beside its own
    Reproduce(reproduce::Options),
}

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Runs the chosen chore; `false` means that it ran and found a problem.
fn run() -> Result<bool> {
    let cli = Cli::parse();
    let root = workspace_root()?;
    match cli.command {
        Task::Tidy => tidy::run(&root),
        Task::Ci => ci::run(&root),
        Task::Browser => browser::run(&root),
        Task::Validate(options) => validate::run(&root, &options),
        Task::Reproduce(options) => reproduce::run(&root, &options),
    }
}

/// The folder of the workspace manifest: the parent of this crate's folder.
fn workspace_root() -> Result<PathBuf> {
    let manifest_dir = std::env::var_os("CARGO_MANIFEST_DIR")
        .context("CARGO_MANIFEST_DIR is not set: run this program as `cargo xtask <command>`")?;
    let mut root = PathBuf::from(manifest_dir);
    root.pop();
    Ok(root)
}
