//! The parts of the program.

pub(crate) mod analyse;
mod args;
#[cfg(test)]
mod book;
mod check;
pub(crate) mod cli;
mod folder;
pub(crate) mod job;
mod meter;
mod overlaps;
pub(crate) mod picture;
pub(crate) mod pores;
mod progress;
pub(crate) mod report;
pub(crate) mod resolve;
pub(crate) mod run;
pub(crate) mod running;
pub(crate) mod shapes;
mod source;
pub(crate) mod stages;
pub(crate) mod sweep;

use std::io::Write;

use femdem::scene::ShapeNote;

/// Exit code after Ctrl-C, as in shells: 128 + SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

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
