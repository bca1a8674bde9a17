//! `cargo xtask ci`: the one list of checks that a change must pass.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};

use crate::{book, capi, python, ranks, tidy};

/// A cargo command of the list.
struct Step {
    name: &'static str,
    arguments: &'static str,
    environment: &'static [(&'static str, &'static str)],
}

/// Everything except `tidy`, the bindings and the book, which run in this process after them. Cheap steps come first.
///
/// The commands without a package option act on the default members, which are the crates of
/// `crates/` but the bindings: there, `--no-default-features` builds the serial code paths.
const STEPS: [Step; 11] = [
    Step {
        name: "format",
        arguments: "fmt --all --check",
        environment: &[],
    },
    // A separate workspace: its other engine takes too long to compile here.
    Step {
        name: "format of the peers",
        arguments: "fmt --manifest-path benches/peers/Cargo.toml --check",
        environment: &[],
    },
    // Another: it needs an MPI library.
    Step {
        name: "format of the ranks",
        arguments: "fmt --manifest-path crates/femdem-mpi/Cargo.toml --check",
        environment: &[],
    },
    // The lock files of the separate workspaces fit what their packages and the crates here depend on.
    Step {
        name: "lock file of the peers",
        arguments: "update --workspace --locked --quiet --manifest-path benches/peers/Cargo.toml",
        environment: &[],
    },
    Step {
        name: "lock file of the ranks",
        arguments: "update --workspace --locked --quiet --manifest-path crates/femdem-mpi/Cargo.toml",
        environment: &[],
    },
    Step {
        name: "lock file of the fuzz targets",
        arguments: "update --workspace --locked --quiet --manifest-path fuzz/Cargo.toml",
        environment: &[],
    },
    Step {
        name: "clippy, all features",
        arguments: "clippy --workspace --all-targets --all-features --locked -- -D warnings",
        environment: &[],
    },
    Step {
        name: "clippy, no default features",
        arguments: "clippy --all-targets --no-default-features --locked -- -D warnings",
        environment: &[],
    },
    Step {
        name: "tests",
        arguments: "test --workspace --all-features --locked",
        environment: &[],
    },
    Step {
        name: "same bits without threads",
        arguments: "test -p femdem-solve --no-default-features --test same_bits --locked",
        environment: &[],
    },
    Step {
        name: "documentation",
        arguments: "doc --workspace --no-deps --locked",
        environment: &[("RUSTDOCFLAGS", "-D warnings")],
    },
];

/// Runs the steps in order, stops at the first that fails, and prints the time each took. `full` adds the
/// bindings of other languages, the wheel and the commands of the book, which take half an hour.
///
/// # Errors
/// When cargo itself cannot be started, or the workspace cannot be read.
pub(crate) fn run(root: &Path, full: bool) -> Result<bool> {
    let mut last: Vec<Own> = vec![("tidy", "cargo xtask tidy", tidy::run)];
    if full {
        last.push(("python", "cargo xtask python", python::run));
        last.push(("wheel", "cargo xtask python --wheel", python::wheel));
        last.push(("capi", "cargo xtask capi", |root| capi::run(root, None)));
        last.push(("ranks", "cargo xtask ranks", ranks::run));
        last.push(("book", "cargo xtask book", |root| book::run(root, None)));
    }
    let total = STEPS.len() + last.len();
    let mut times = Vec::with_capacity(total);
    for (index, step) in STEPS.iter().enumerate() {
        let command = format!("cargo {}", step.arguments);
        heading(index + 1, total, step.name, &command);
        let start = Instant::now();
        let passed = run_cargo(root, step)?;
        times.push((step.name, start.elapsed()));
        if !passed {
            return Ok(finish(&times, Some((step.name, &command))));
        }
    }
    for (index, (name, command, check)) in last.into_iter().enumerate() {
        heading(STEPS.len() + 1 + index, total, name, command);
        let start = Instant::now();
        let passed = check(root)?;
        times.push((name, start.elapsed()));
        if !passed {
            return Ok(finish(&times, Some((name, command))));
        }
    }
    Ok(finish(&times, None))
}

/// A check of this program: its name, its command, and what it does.
type Own = (&'static str, &'static str, fn(&Path) -> Result<bool>);

/// Runs one step with no standard input; returns whether it passed.
fn run_cargo(root: &Path, step: &Step) -> Result<bool> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo)
        .args(step.arguments.split_whitespace())
        .envs(step.environment.iter().copied())
        .current_dir(root)
        .stdin(Stdio::null())
        .status()
        .with_context(|| format!("cannot start cargo for the step `{}`", step.name))?;
    Ok(status.success())
}

fn heading(number: usize, total: usize, name: &str, command: &str) {
    println!("\n=== {number}/{total} {name}: {command}");
}

/// Prints the summary; returns whether all steps passed.
fn finish(times: &[(&str, Duration)], failed: Option<(&str, &str)>) -> bool {
    println!("\n{}", summary(times));
    match failed {
        Some((name, command)) => {
            println!("FAILED at `{name}`; to see it alone: {command}");
            false
        }
        None => {
            println!("all checks passed");
            true
        }
    }
}

/// A table of seconds per step, with their sum.
fn summary(times: &[(&str, Duration)]) -> String {
    let sum = times.iter().map(|(_, time)| *time).sum();
    times
        .iter()
        .copied()
        .chain([("total", sum)])
        .map(|(name, time)| format!("{name:<28} {:>8.1} s", time.as_secs_f64()))
        .collect::<Vec<_>>()
        .join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_lists_each_step_and_their_sum() {
        let times = [
            ("format", Duration::from_millis(500)),
            ("tests", Duration::from_secs(62)),
        ];
        let text = summary(&times);
        let last_words: Vec<_> = text
            .lines()
            .map(|line| line.split_whitespace().collect::<Vec<_>>())
            .collect();
        assert_eq!(
            last_words,
            [
                vec!["format", "0.5", "s"],
                vec!["tests", "62.0", "s"],
                vec!["total", "62.5", "s"],
            ]
        );
    }

    #[test]
    fn every_step_that_resolves_dependencies_keeps_the_lock_file() {
        for step in STEPS
            .iter()
            .filter(|step| !step.arguments.starts_with("fmt "))
        {
            assert!(step.arguments.contains("--locked"), "{}", step.name);
        }
    }
}
