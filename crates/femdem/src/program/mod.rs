//! The program: its command line, and every command of it for a host of another language.
//!
//! This is the only module that prints and starts threads. Rust code is better served by the libraries, which take
//! and return data.

mod analyse;
mod args;
#[cfg(test)]
mod book;
mod check;
mod cli;
mod folder;
mod job;
mod meter;
mod overlaps;
mod picture;
mod pores;
mod progress;
mod report;
mod resolve;
mod run;
mod running;
mod shapes;
mod source;
mod stages;
mod stresses;
mod sweep;

use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use anyhow::Result;
use clap::Parser;
use femdem::Scene;
use femdem::scene::ShapeNote;

use cli::{Cli, Command};
pub use folder::Claim;
pub use running::Outcome;

/// Runs the command of this process's command line, says what went wrong, and returns the exit code.
pub fn main() -> ExitCode {
    match carry_out(Cli::parse().command) {
        Ok(Outcome::Finished) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted) => ExitCode::from(INTERRUPTED),
        Err(error) => {
            complain(&format!("error: {}", described(&error)));
            ExitCode::FAILURE
        }
    }
}

/// Runs the command that `words` are, without the name of the program, for a host that watches for Ctrl-C itself: while it
/// runs, the host may raise `stop`, and `pack`, `run`, `resume` and `sweep` end with a checkpoint; other commands run to
/// their end. No signal handler is set.
///
/// ```
/// use femdem::program::{Outcome, call};
///
/// let refused = call(["pack", "--count", "0", "--check"], &Default::default());
/// assert!(refused.is_err_and(|why| why.contains("count")));
/// let listed = call(["shapes", "--json"], &Default::default())?;
/// assert_eq!(listed, Outcome::Finished);
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
///
/// What the program would say.
pub fn call<W>(
    words: impl IntoIterator<Item = W>,
    stop: &Arc<AtomicBool>,
) -> Result<Outcome, String>
where
    W: Into<OsString>,
{
    let program = OsString::from("femdem");
    let words = std::iter::once(program).chain(words.into_iter().map(Into::into));
    let mut command = match Cli::try_parse_from(words) {
        Ok(cli) => cli.command,
        Err(refusal) if refusal.use_stderr() => return Err(refused(&refusal)),
        // Help and the version are what was asked for.
        Err(text) => {
            say(text.to_string().trim_end());
            return Ok(Outcome::Finished);
        }
    };
    command.stop_by(stop);
    carry_out(command).map_err(|error| described(&error))
}

/// Claims a folder for a job that writes into it, until the claim is dropped.
///
/// # Errors
///
/// What the program would say, if another job has claimed the folder. Where folders cannot be locked, none is noticed.
pub fn claim(folder: &Path) -> Result<Claim, String> {
    folder::claim(folder).map_err(|error| described(&error))
}

/// The scene of a pack that `words` are, the options of `femdem pack`, for a program that packs in its own way.
///
/// ```
/// let scene = femdem::program::pack_scene(["--count", "7", "--box", "4x5"])?;
/// assert_eq!(scene.count, 7);
/// # Ok::<(), String>(())
/// ```
///
/// # Errors
///
/// What the program would say, and options that do not belong to a scene, such as `--check`.
pub fn pack_scene<W>(words: impl IntoIterator<Item = W>) -> Result<Scene, String>
where
    W: Into<OsString>,
{
    let program = ["femdem", "pack"].map(OsString::from).into_iter();
    let words = program.chain(words.into_iter().map(Into::into));
    let args = match Cli::try_parse_from(words) {
        Ok(Cli {
            command: Command::Pack(args),
        }) => args,
        Ok(_) => return Err("these are no options of a pack".to_owned()),
        Err(refusal) => return Err(refused(&refusal)),
    };
    if let Some(option) = args.beside_the_scene() {
        return Err(format!("--{option} is not possible here: leave it out"));
    }
    args.scene().map_err(|error| error.to_string())
}

/// What the parser of the command line refuses, without its advice for the terminal.
fn refused(refusal: &clap::Error) -> String {
    let text = refusal.to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let advice = text
        .find("\n\nUsage:")
        .or(text.find("\n\nFor more information"));
    text[..advice.unwrap_or(text.len())].trim_end().to_owned()
}

fn carry_out(command: Command) -> Result<Outcome> {
    match command {
        Command::Pack(args) => job::pack(&args),
        Command::Run(args) => stages::run(&args),
        Command::Resume(args) => job::resume(&args),
        Command::Analyse(args) => analyse::run(&args),
        Command::Picture(args) => picture::run(&args),
        Command::Report(args) => report::run(&args),
        Command::Pores(args) => pores::run(&args),
        Command::Resolve(args) => resolve::run(&args),
        Command::Stresses(args) => stresses::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Shapes(args) => shapes::run(&args).map(|()| Outcome::Finished),
    }
}

/// Exit code after Ctrl-C, as in shells: 128 + SIGINT.
const INTERRUPTED: u8 = 130;

/// Writes a line to standard output. A closed reader, such as `head`, is not an error.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Says how surface files were read and bodies meshed.
pub(crate) fn say_notes(notes: &[ShapeNote]) {
    for note in notes.iter().filter(|note| note.is_news()) {
        say(&note.to_string());
    }
}

/// An error with its causes, each stated once: many messages contain their cause already.
pub(crate) fn described(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text
}

/// Writes a line to standard error.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn help_and_the_version_are_no_errors() {
        for words in [&["--version"][..], &["--help"], &["pack", "--help"]] {
            assert_eq!(call(words, &Arc::default()), Ok(Outcome::Finished));
        }
        let refused = call(["pack", "--helq"], &Arc::default());
        assert!(refused.is_err_and(|why| why.contains("--helq")));
    }

    #[test]
    fn a_cause_is_said_once() {
        let source = std::io::Error::other("no room");
        let path = "a.csv".into();
        let error = Err::<(), _>(femdem::ViewError::Write { path, source })
            .context("the table was not written")
            .unwrap_err();
        let text = described(&error);
        assert_eq!(text.matches("no room").count(), 1, "{text}");
        assert!(
            text.starts_with("the table was not written: cannot write a.csv: no room"),
            "{text}"
        );
    }
}
