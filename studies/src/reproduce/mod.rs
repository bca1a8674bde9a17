//! `cargo studies reproduce`: the studies of the founding paper, and of what it does not state.
//!
//! Each study is a list of runs of the release program and a page made from them. A run has its own folder,
//! named after its options, under `--runs`. A complete run that exists is used, so that the runs of a study may
//! be made beforehand, side by side, by the commands that `--list` prints, and the page afterwards. `--quick`
//! uses small packs and writes to `out/reproduce` instead of `records`.

mod case;
mod dice;
mod dots;
mod figure1;
mod figure6;
mod figure7;
mod job;
mod orientation;
mod pack;
mod page;
mod paper;
mod readings;
mod record;
mod run;
mod runs;
mod sensitivity;
mod shaken;
mod statistics;
mod table1;

use std::collections::BTreeSet;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use crate::validate::machine::Place;
use crate::validate::program::Workshop;
use crate::validate::report::Report;
use case::Case;
use runs::Runs;

/// Options of `cargo studies reproduce`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Options {
    /// What to reproduce
    study: Study,

    /// Small packs, for a trial in minutes; its pages go to out/reproduce
    #[arg(long)]
    quick: bool,

    /// Threads: small packs run side by side on one each, large ones one after another on all
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,

    /// Folder of the runs [default: out/reproduce/runs]
    #[arg(long, value_name = "DIR")]
    runs: Option<PathBuf>,

    /// Print the commands of the runs that the study needs, and run nothing
    #[arg(long)]
    list: bool,

    /// Make the pages of the runs that are there, and start no others. Where the table of the last page
    /// tells enough of a run, its folder may be gone (Table 1, Figure 6, dice, sensitivity)
    #[arg(long)]
    as_found: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Study {
    /// Packing densities of the 18 solids
    Table1,
    /// Time against threads, 288 deformable boulders
    Figure1,
    /// Packing density of truncated tetrahedra against friction
    Figure6,
    /// Numbers of contacts and force chains of A5, A10 and P3
    Figure7,
    /// Stereonets of cylinders and of the faces of A10
    Orientation,
    /// Platonic solids beside experiments on dice
    Dice,
    /// Dice in a tapped box
    Shaken,
    /// Protocol, damping, penetration, size, gravity and inset, one changed at a time
    Sensitivity,
    /// All of them
    All,
}

/// Size of the packs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scale {
    Quick,
    Full,
}

impl Study {
    /// The single studies that this one includes.
    fn parts(self) -> Vec<Self> {
        match self {
            Self::All => Self::value_variants()
                .iter()
                .copied()
                .filter(|study| *study != Self::All)
                .collect(),
            single => vec![single],
        }
    }

    fn cases(self, scale: Scale) -> Vec<Case> {
        match self {
            Self::Table1 => table1::cases(scale),
            Self::Figure6 => figure6::cases(scale),
            Self::Figure7 => figure7::cases(scale),
            Self::Orientation => orientation::cases(scale),
            Self::Dice => dice::cases(scale),
            Self::Sensitivity => sensitivity::cases(scale),
            Self::Figure1 | Self::Shaken | Self::All => Vec::new(),
        }
    }

    fn run(self, runs: &Runs, scale: Scale) -> Result<Report> {
        match self {
            Self::Table1 => table1::run(runs, scale),
            Self::Figure6 => figure6::run(runs, scale),
            Self::Figure7 => figure7::run(runs, scale),
            Self::Orientation => orientation::run(runs, scale),
            Self::Dice => dice::run(runs, scale),
            Self::Sensitivity => sensitivity::run(runs, scale),
            Self::Shaken => shaken::run(runs, scale),
            Self::Figure1 => figure1::run(runs, scale),
            Self::All => bail!("all is no study of its own"),
        }
    }

    fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Runs the studies and writes their pages; returns whether all runs are present and at rest.
///
/// # Errors
/// When the program cannot be built or fails, or a page cannot be written.
pub(crate) fn run(root: &Path, options: &Options) -> Result<bool> {
    let scale = if options.quick {
        Scale::Quick
    } else {
        Scale::Full
    };
    let default = root.join("out/reproduce/runs");
    let folder = options.runs.clone().unwrap_or(default);
    let threads = usize::from(options.threads);
    if options.list {
        print(&list(options.study, scale, &folder, threads))?;
        return Ok(true);
    }
    let pages = match scale {
        Scale::Quick => root.join("out/reproduce"),
        Scale::Full => root.join("records"),
    };
    let workshop = Workshop::new(root)?;
    let runs = Runs::open(&workshop, &folder, threads, options.as_found)?;
    let mut complete = true;
    for study in options.study.parts() {
        let place = Place::find(root)?;
        let report = study.run(&runs, scale)?;
        if report.rows.is_empty() {
            println!(
                "{}: none of its runs is there, so no page is written",
                study.name()
            );
            complete = false;
            continue;
        }
        let quick = if options.quick { " --quick" } else { "" };
        let found = if options.as_found { " --as-found" } else { "" };
        let made_by = format!(
            "cargo studies reproduce {}{quick}{found} --threads {threads}",
            study.name()
        );
        let page = report.write(&pages, &place, &made_by)?;
        println!("{}\nwritten to {}", report.checks_as_text(), page.display());
        complete &= report.all_met();
    }
    Ok(complete)
}

/// The commands of the runs, each once, a line each.
fn list(study: Study, scale: Scale, folder: &Path, threads: usize) -> String {
    let mut known = BTreeSet::new();
    let mut commands = Vec::new();
    for study in study.parts() {
        let jobs = study.cases(scale).into_iter().flat_map(|case| case.jobs);
        let new = jobs.filter(|job| known.insert(job.key()));
        commands.extend(new.map(|job| runs::command(folder, &job, threads)));
        match study {
            Study::Figure1 => commands.extend(figure1::commands(folder, scale)),
            Study::Shaken => commands.push(format!(
                "cargo studies reproduce shaken --runs {}",
                folder.display()
            )),
            _ => {}
        }
    }
    commands.into_iter().map(|command| command + "\n").collect()
}

/// Prints a text, of which a reader such as `head` may take the first lines only.
fn print(text: &str) -> Result<()> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        end => end.context("cannot print"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_is_every_study_once_and_each_has_its_runs() {
        let parts = Study::All.parts();
        assert_eq!(parts.len() + 1, Study::value_variants().len());
        for study in parts {
            for scale in [Scale::Quick, Scale::Full] {
                let is_empty = study.cases(scale).is_empty();
                let others = [Study::Figure1, Study::Shaken];
                assert_eq!(is_empty, others.contains(&study), "{study:?}");
            }
        }
    }

    /// A tenth of the bodies of the main job's minute, or so, for each.
    #[test]
    fn a_quick_run_has_few_bodies() {
        let mut jobs = std::collections::BTreeMap::new();
        for study in Study::All.parts() {
            for job in study
                .cases(Scale::Quick)
                .into_iter()
                .flat_map(|case| case.jobs)
            {
                jobs.insert(job.key(), job.bodies);
            }
        }
        let bodies: u32 = jobs.values().sum();
        assert!(bodies < 18_000, "{bodies}");
    }
}
