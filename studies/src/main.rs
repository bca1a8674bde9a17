//! Long numerical studies, run as `cargo studies <command>`.
//!
//! `validate` compares runs of the program with the figures it is to reach, and `reproduce` makes the studies of
//! the founding paper, compared with its values. Both write the pages of `records`.

mod reproduce;
mod validate;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(
    bin_name = "cargo studies",
    about = "Long numerical studies",
    flatten_help = true
)]
struct Cli {
    #[command(subcommand)]
    command: Study,
}

#[derive(Subcommand)]
enum Study {
    /// Run the program against the figures it is to reach, and write records
    Validate(validate::Options),
    /// Run the founding paper's studies, and print our numbers beside its own
    Reproduce(reproduce::Options),
}

fn main() -> ExitCode {
    xtask::end(run())
}

/// Runs the chosen study; `false` means that it missed a target or lacks a run.
fn run() -> Result<bool> {
    let cli = Cli::parse();
    let root = xtask::workspace_root()?;
    match cli.command {
        Study::Validate(options) => validate::run(&root, &options),
        Study::Reproduce(options) => reproduce::run(&root, &options),
    }
}
