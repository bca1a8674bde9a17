//! `femdem report`: one page that shows a pack.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use femdem::analysis::{TableOptions, Tables};
use femdem::pack::Packing;
use femdem::report::Report;
use femdem::{Scene, Summary, Usage, output, results};

use super::job::{Outcome, in_pool};
use super::{folder, say};

/// Name of the page.
const PAGE: &str = "report.html";

/// Folder of the plots beside it.
const PLOTS: &str = "plots";

/// Options of `femdem report`.
#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Folder of the run, which holds pack.ckpt
    pub folder: PathBuf,

    /// Folder for report.html and the plots [default: the folder of the run]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// Nothing on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,
}

pub(crate) fn run(args: &ReportArgs) -> Result<Outcome> {
    in_pool(args.threads.map(usize::from), |_| {
        let saved = folder::load(&args.folder)?;
        let out = args.out.as_ref().unwrap_or(&args.folder);
        fs::create_dir_all(out)
            .with_context(|| format!("cannot make the folder {}", out.display()))?;
        let page = write(&args.folder, out, &saved.packing, &saved.usage)?;
        if !args.quiet {
            say(&format!("wrote {}: open it in a browser", page.display()));
        }
        Ok(Outcome::Finished)
    })
}

/// Writes the page of a job whose scene is in `folder`, and the plots; returns the path of the page.
pub(crate) fn write(
    folder: &Path,
    out: &Path,
    packing: &Packing,
    usage: &Usage,
) -> Result<PathBuf> {
    let snapshot = results::snapshot(packing);
    let summary = Summary::of(packing, &snapshot, usage)?;
    let tables = Tables::compute(&snapshot, &TableOptions::default())?;
    let mut report = Report::new(&snapshot)
        .with_summary(&summary)
        .with_tables(&tables);
    // Runs from elsewhere may have no scene.
    let path = folder.join("scene.toml");
    let scene = path.is_file().then(|| Scene::read(&path)).transpose()?;
    if let Some(scene) = &scene {
        report = report.with_scene(scene);
    }
    let page = out.join(PAGE);
    let html = report.html()?;
    output::write_file(&page, |w| std::io::Write::write_all(w, html.as_bytes()))?;
    let plots = out.join(PLOTS);
    fs::create_dir_all(&plots)
        .with_context(|| format!("cannot make the folder {}", plots.display()))?;
    for plot in report.plots() {
        output::write_file(plots.join(format!("{}.svg", plot.name)), |w| {
            plot.write_svg(w)
        })?;
    }
    Ok(page)
}
