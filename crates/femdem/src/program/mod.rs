//! The parts of the program.

pub(crate) mod analyse;
mod check;
pub(crate) mod cli;
mod folder;
pub(crate) mod job;
mod meter;
pub(crate) mod picture;
mod progress;
pub(crate) mod report;
pub(crate) mod resolve;
pub(crate) mod run;
pub(crate) mod shapes;
mod source;

use std::io::Write;

/// Exit code after Ctrl-C, as shells have it: 128 + SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Writes a line to standard output. A reader that has gone away, such as `head`, is no error.
pub(crate) fn say(text: &str) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Writes a line to standard error.
pub(crate) fn complain(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
