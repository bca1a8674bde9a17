//! Chores of the project, run as `cargo xtask <command>`.
//!
//! `tidy` checks what the compiler does not: the documented crate graph against the real one, the tests of the
//! invariants, file lengths, leftovers, crate docs, the book's links and length. `ci` runs every check that a change
//! must pass, in the same order as `.ci/run`. `book` runs the commands of the book. `browser` tests the report page in
//! Chromium, `python` the Python bindings, `capi` those of C, `ranks` the program over MPI.

mod book;
mod browser;
mod capi;
mod ci;
mod command;
mod python;
mod ranks;
mod tidy;

use std::path::PathBuf;
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
    /// Check the crate graph, the invariants' tests, file lengths, leftovers, crate docs and the book
    Tidy,
    /// Run format, clippy, test, documentation and tidy checks; stop at the first failure
    Ci {
        /// Run the commands of the book, too
        #[arg(long)]
        full: bool,
    },
    /// Run the commands of the book and of the README, and compare what they print with what it says
    Book {
        /// Only pages whose path contains this
        #[arg(value_name = "PART")]
        only: Option<String>,
    },
    /// Try the report page in headless Chromium, installed if it is not there
    Browser,
    /// Run the tests and examples of the Python bindings, and check their types
    Python {
        /// Build the wheel, and install that
        #[arg(long)]
        wheel: bool,
    },
    /// Build the C bindings and run their examples in C, C++ and Fortran, one of them under valgrind
    Capi {
        /// Build for use and install into this folder instead
        #[arg(long, value_name = "FOLDER")]
        prefix: Option<PathBuf>,
    },
    /// Run a scene over 1 to 4 ranks by MPI, and compare the results with those of `femdem run`
    Ranks,
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
        Task::Ci { full } => ci::run(&root, full),
        Task::Book { only } => book::run(&root, only.as_deref()),
        Task::Browser => browser::run(&root),
        Task::Python { wheel: false } => python::run(&root),
        Task::Python { wheel: true } => python::wheel(&root),
        Task::Capi { prefix } => capi::run(&root, prefix.as_deref()),
        Task::Ranks => ranks::run(&root),
    }
}
