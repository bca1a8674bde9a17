//! The femdem program: pack bodies, run scenes, resume, analyse, list shapes.

mod program;

use std::process::ExitCode;

use clap::Parser;
use program::cli::{Cli, Command};
use program::job;
use program::running::Outcome;
use program::{
    analyse, complain, described, picture, pores, report, resolve, shapes, stages, sweep,
};

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Pack(args) => job::pack(&args),
        Command::Run(args) => stages::run(&args),
        Command::Resume(args) => job::resume(&args),
        Command::Analyse(args) => analyse::run(&args),
        Command::Picture(args) => picture::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Pores(args) => pores::run(&args),
        Command::Resolve(args) => resolve::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Shapes(args) => shapes::run(&args).map(|()| Outcome::Finished),
    };
    match outcome {
        Ok(Outcome::Finished) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted) => ExitCode::from(program::INTERRUPTED),
        Err(error) => {
            complain(&format!("error: {}", described(&error)));
            ExitCode::FAILURE
        }
    }
}
