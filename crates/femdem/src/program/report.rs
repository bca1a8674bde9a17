//! `femdem report`: one page that shows a pack.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use femdem::analysis::{TableOptions, Tables};
use femdem::pack::Packing;
use femdem::plot::Plot;
use femdem::report::{Report, RunFacts};
use femdem::results::run_facts;
use femdem::run::RunSummary;
use femdem::{Fracture, Scene, Snapshot, Summary, Usage, output};

use super::running::{Outcome, in_pool};
use super::say;
use super::source::{self, ForeignArgs, FrameArgs, Origin};

/// Name of the page.
const PAGE: &str = "report.html";

/// Folder of the plots beside it.
const PLOTS: &str = "plots";

/// Options of `femdem report`.
#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Folder of a run, which holds pack.ckpt or run.ckpt, or of a pack from elsewhere, which holds bodies.csv
    pub folder: PathBuf,

    /// Folder for report.html and the plots [default: the folder of the run, or of the tables of the frame]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    #[command(flatten)]
    pub frame: FrameArgs,

    #[command(flatten)]
    pub foreign: ForeignArgs,

    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// Nothing on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,
}

pub(crate) fn run(args: &ReportArgs) -> Result<Outcome> {
    in_pool(args.threads.map(usize::from), |_| {
        let found = source::read_any(&args.folder, &args.foreign, &args.frame)?;
        found.refuse_moved_cell()?;
        let out = args.out.as_ref().unwrap_or(&found.folder);
        let snapshot = &found.snapshot;
        let page = match &found.origin {
            Origin::Pack(saved) => {
                let run = (&saved.packing, &saved.usage);
                write(&args.folder, out, snapshot, Some(run))?
            }
            Origin::Elsewhere => write(&args.folder, out, snapshot, None)?,
            Origin::Run(_, Some(_)) => {
                found.refuse_empty(&args.folder)?;
                let lead = found.lead();
                write_page(
                    out,
                    snapshot,
                    RunFacts {
                        lead,
                        ..RunFacts::default()
                    },
                    None,
                    Vec::new(),
                )?
            }
            Origin::Run(saved, None) => {
                let mut facts = RunSummary::of(&saved.0, &saved.1)?.facts();
                let fracture = saved.0.fracture(&args.folder)?;
                let course = saved.0.course(&args.folder)?;
                facts.tables.extend(course.tables);
                write_page(out, snapshot, facts, fracture.as_ref(), course.plots)?
            }
        };
        if !args.quiet {
            say(&format!("wrote {}: open it in a browser", page.display()));
        }
        Ok(Outcome::Finished)
    })
}

/// Writes the page and the plots of a pack, with the results of the run that made it, if known, and the scene
/// in `folder`; returns the path of the page.
pub(crate) fn write(
    folder: &Path,
    out: &Path,
    snapshot: &Snapshot,
    run: Option<(&Packing, &Usage)>,
) -> Result<PathBuf> {
    let summary = run.map(|(packing, usage)| Summary::of(packing, snapshot, usage));
    let summary = summary.transpose()?;
    // Packs from elsewhere have no scene.
    let path = folder.join("scene.toml");
    let scene = path.is_file().then(|| Scene::read(&path)).transpose()?;
    let facts = run_facts(summary.as_ref(), scene.as_ref());
    write_page(out, snapshot, facts, None, Vec::new())
}

/// Writes the page and the plots with what is known of the run, of fracture and of the course.
fn write_page(
    out: &Path,
    snapshot: &Snapshot,
    facts: RunFacts,
    fracture: Option<&Fracture>,
    course: Vec<Plot>,
) -> Result<PathBuf> {
    let plots = out.join(PLOTS);
    fs::create_dir_all(&plots)
        .with_context(|| format!("cannot make the folder {}", plots.display()))?;
    // Bodies may all have left a run; what it has measured remains.
    let has_bodies = !snapshot.bodies.is_empty() || course.is_empty();
    let tables = has_bodies.then(|| Tables::compute(snapshot, &TableOptions::default()));
    let tables = tables.transpose()?;
    // Lines between the bodies would show forces that are not known.
    let without = snapshot.gaps.forces.then(|| Snapshot {
        contacts: Vec::new(),
        ..snapshot.clone()
    });
    let shown = without.as_ref().unwrap_or(snapshot);
    let mut report = Report::new(shown).with_run(facts).with_course(course);
    if let Some(tables) = &tables {
        report = report.with_tables(tables);
    }
    if let Some(fracture) = fracture {
        report = report.with_fracture(fracture);
    }
    let page = out.join(PAGE);
    let html = report.html()?;
    output::write_file(&page, |w| std::io::Write::write_all(w, html.as_bytes()))?;
    for plot in report.plots() {
        output::write_file(plots.join(format!("{}.svg", plot.name)), |w| {
            plot.write_svg(w)
        })?;
    }
    Ok(page)
}
