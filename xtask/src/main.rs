//! Chores of the project, run as `cargo xtask <command>`.
//!
//! `tidy` checks what the compiler does not: the documented crate graph against the real one, the tests of the
//! invariants, file lengths, leftovers, crate docs, broken links. `ci` runs every check that a change must
//! pass, in the same order as `.ci/run`. `browser` tests the report page in Chromium.

mod browser;
mod ci;
mod tidy;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(bin_name = "cargo xtask", about = "Chores of the project")]
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
}

fn main() -> ExitCode {
    xtask::end(run())
}

/// Runs the chosen chore; `false` means that it ran and found a problem.
fn run() -> Result<bool> {
    let cli = Cli::parse();
    let root = xtask::workspace_root()?;
    match cli.command {
        Task::Tidy => tidy::run(&root),
        Task::Ci => ci::run(&root),
        Task::Browser => browser::run(&root),
    }
}
