//! `cargo studies validate`: long runs of the program, compared with targets.
//!
//! Each case builds the release program, runs it in a temporary folder, reads its `summary.json`
//! and writes a page and a table with the machine, the program and the commands. With `--count` a
//! case is a trial on fewer bodies, and writes to `out/validation` instead of `records`.

mod bits;
mod bodies;
pub(crate) mod chart;
mod cost;
mod finite_ball;
mod fracture;
mod fuzz_pairs;
mod hertz;
pub(crate) mod lines;
pub(crate) mod machine;
mod pack;
pub(crate) mod program;
pub(crate) mod report;
mod scan;
mod size;
mod soft_boulders;
mod spheres;
mod statics;
mod xray_bed;

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, ValueEnum};

use program::Workshop;
use report::Report;

/// Options of `cargo studies validate`.
#[derive(Debug, Clone, Args)]
pub(crate) struct Options {
    /// What to run
    case: Case,

    /// Bodies, for a trial: its results go to out/validation (cost runs N, 2N, 4N and 8N; for
    /// fuzz-pairs the number of pairs)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    count: Option<u32>,

    /// Simulated seconds of boulders-deformable, for a trial
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,

    /// Folder with what the example of hertz (plane.tsv, two.tsv), spheres (glass.tsv, aluminium.tsv), fracture (bar.tsv,
    /// block.tsv, opened.tsv, bent.tsv, burst.tsv, notched.tsv, struck.tsv, branch.tsv, grain.tsv, crushed.tsv) or
    /// boulders-deformable (rest.tsv, frozen.tsv, 1.tsv, 2.tsv, 4.tsv, and the folder pack) printed earlier, instead of
    /// running it
    #[arg(long, value_name = "DIR")]
    lines: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Case {
    /// The main job, 500 truncated dodecahedra: time, penetration, residual
    Pack500,
    /// Processor time per body from 500 to 4,000 bodies
    Cost,
    /// Cost per body and step, and memory per body, from 1,000 to 30,000 bodies
    Size,
    /// The same bits at 1, 2 and 3 threads and without the feature `parallel`
    Threads,
    /// The same bits through an interruption and a resumption
    Restart,
    /// 288 different boulders of 40 kg dumped in the paper's bin
    Boulders,
    /// 200 dolosse poured into a cylinder
    Dolosse,
    /// Stones from a scan-like surface of 2,000 triangles
    Scan,
    /// Random pairs through every contact kernel: no panic, no number that is not finite
    FuzzPairs,
    /// Cantilever, thick sphere and Cook's membrane; Newton's method and its solvers
    Statics,
    /// Taylor's impact test: plasticity at finite strain
    Taylor,
    /// Elastic balls pressed on a plane and on each other, against Hertz's theory
    Hertz,
    /// Elastic balls that collide (Chung and Ooi, tests 1 and 2)
    Spheres,
    /// 288 deformable boulders dumped in the paper's bin: rest, time, the same bits
    BouldersDeformable,
    /// Bars, blocks, beams and grains that break, against closed forms and a published formula
    Fracture,
    /// A bed of cylinders in a tube, against X-ray tomography
    XrayBed,
    /// All of them
    All,
}

impl Case {
    /// The single cases that this one includes.
    fn parts(self) -> Vec<Self> {
        match self {
            Self::All => vec![
                Self::Pack500,
                Self::Threads,
                Self::Restart,
                Self::Boulders,
                Self::Dolosse,
                Self::Scan,
                Self::FuzzPairs,
                Self::Statics,
                Self::Taylor,
                Self::Hertz,
                Self::Spheres,
                Self::BouldersDeformable,
                Self::Fracture,
                Self::XrayBed,
                Self::Cost,
                Self::Size,
            ],
            single => vec![single],
        }
    }

    fn run(self, workshop: &Workshop, options: &Options) -> Result<Report> {
        let count = options.count;
        match self {
            Self::Hertz => hertz::hertz(workshop, options.lines.as_deref()),
            Self::Fracture => fracture::fracture(workshop, options.lines.as_deref()),
            Self::Spheres => spheres::spheres(workshop, options.lines.as_deref()),
            Self::BouldersDeformable => soft_boulders::run(
                workshop,
                count.unwrap_or(288),
                options.seconds.unwrap_or(5.5),
                options.lines.as_deref(),
            ),
            Self::Pack500 | Self::All => pack::run(workshop, count.unwrap_or(500)),
            Self::Size => size::run(workshop, count),
            Self::Cost => cost::run(workshop, count.unwrap_or(500)),
            Self::Threads => bits::threads(workshop, count.unwrap_or(200)),
            Self::Restart => bits::restart(workshop, count.unwrap_or(200)),
            Self::Statics => statics::statics(workshop),
            Self::Taylor => statics::taylor(workshop),
            Self::FuzzPairs => fuzz_pairs::run(workshop, count.unwrap_or(1_000_000)),
            Self::Boulders => bodies::boulders(workshop, count.unwrap_or(288)),
            Self::Dolosse => bodies::dolosse(workshop, count.unwrap_or(200)),
            Self::Scan => bodies::scanned(workshop, count.unwrap_or(60)),
            Self::XrayBed => xray_bed::run(workshop, count.unwrap_or(800)),
        }
    }
}

/// Runs the cases and writes their pages; returns whether every target was reached.
///
/// # Errors
/// When the program cannot be built or fails, or a page cannot be written.
pub(crate) fn run(root: &Path, options: &Options) -> Result<bool> {
    let folder = if options.count.is_some() || options.seconds.is_some() {
        root.join("out/validation")
    } else {
        root.join("records")
    };
    let workshop = Workshop::new(root)?;
    let mut reached = true;
    for case in options.case.parts() {
        let place = machine::Place::find(root)?;
        let report = case.run(&workshop, options)?;
        let mut trial = options
            .count
            .map_or(String::new(), |n| format!(" --count {n}"));
        if let Some(seconds) = options.seconds {
            trial += &format!(" --seconds {seconds}");
        }
        if options.lines.is_some() {
            trial += " --lines DIR";
        }
        let made_by = format!("cargo studies validate {}{trial}", report.name);
        let page = report.write(&folder, &place, &made_by)?;
        println!("{}\nwritten to {}", report.checks_as_text(), page.display());
        reached &= report.all_met();
    }
    Ok(reached)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_is_every_case_once() {
        let mut parts = Case::All.parts();
        let count = parts.len();
        parts.dedup();
        assert_eq!(parts.len(), count);
        for case in Case::value_variants() {
            assert_eq!(parts.contains(case), *case != Case::All, "{case:?}");
        }
    }
}
