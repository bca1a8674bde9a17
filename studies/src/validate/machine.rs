//! Machine and program of a result.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};

/// The machine and the program of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) processor: String,
    pub(crate) cores: usize,
    /// Mean number of busy cores in the minute before; `None` if the system does not report it.
    pub(crate) load: Option<String>,
    /// Version and date of the program.
    pub(crate) program: String,
}

impl Place {
    /// Asks the system and git.
    ///
    /// # Errors
    /// When git cannot be asked.
    pub(crate) fn find(root: &Path) -> Result<Self> {
        let date = answer(root, "git", &["log", "-1", "--format=%cs"])?;
        let changes = answer(
            root,
            "git",
            &["status", "--porcelain", "--untracked-files=no"],
        )?;
        let cpuinfo = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        Ok(Self {
            processor: processor(&cpuinfo),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            load: fs::read_to_string("/proc/loadavg")
                .ok()
                .and_then(|text| text.split_whitespace().next().map(str::to_owned)),
            program: program(&date, &changes),
        })
    }

    /// The lines of a page.
    pub(crate) fn to_markdown(&self) -> String {
        let load = match &self.load {
            Some(load) => format!("; load {load} before the run"),
            None => String::new(),
        };
        format!(
            "- machine: {}, {} cores{load}\n- program: {}\n",
            self.processor, self.cores, self.program
        )
    }
}

/// What a command prints, without the last line break.
fn answer(root: &Path, program: &str, arguments: &[&str]) -> Result<String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(root)
        .output()
        .with_context(|| format!("cannot start {program}"))?;
    anyhow::ensure!(
        output.status.success(),
        "{program} {} failed: {}",
        arguments.join(" "),
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(String::from_utf8_lossy(&output.stdout)
        .trim_end()
        .to_owned())
}

/// The model in the text of `/proc/cpuinfo`.
fn processor(cpuinfo: &str) -> String {
    let model = cpuinfo
        .lines()
        .filter_map(|line| line.split_once(':'))
        .find(|(key, _)| key.trim() == "model name");
    match model {
        Some((_, name)) => name.trim().to_owned(),
        None => format!("{} processor", std::env::consts::ARCH),
    }
}

fn program(date: &str, changes: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let changed = if changes.is_empty() {
        ""
    } else {
        ", with changes"
    };
    format!("femdem {version} of {date}{changed}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_model_is_found_among_the_other_keys() {
        let text =
            "processor\t: 0\nmodel\t\t: 49\nmodel name\t: Brand 7 (16 cores)\nflags\t: a b\n";
        assert_eq!(processor(text), "Brand 7 (16 cores)");
        assert!(processor("").ends_with("processor"));
    }

    #[test]
    fn changes_are_told() {
        assert!(program("2026-01-02", "").ends_with(" of 2026-01-02"));
        assert!(program("2026-01-02", " M a.rs").ends_with("2026-01-02, with changes"));
    }

    #[test]
    fn a_page_without_a_load_does_not_mention_one() {
        let mut place = Place {
            processor: "P".to_owned(),
            cores: 2,
            load: Some("0.10".to_owned()),
            program: "femdem 1".to_owned(),
        };
        assert!(
            place
                .to_markdown()
                .contains("P, 2 cores; load 0.10 before the run\n")
        );
        place.load = None;
        assert!(place.to_markdown().starts_with("- machine: P, 2 cores\n"));
    }
}
