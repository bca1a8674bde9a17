//! `femdem analyse`: all measurements of a run or of a pack from elsewhere.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Result, bail};
use clap::Args;
use femdem::analysis::{
    BodyAxes, CoreOptions, FOLDER, FieldOptions, JSON, MixingSeries, Table, TableOptions, Tables,
};
use femdem::input::BODIES;
use femdem::{Snapshot, output, results};

use super::args::WorkArgs;
use super::job::report;
use super::running::{Outcome, in_pool};
use super::say;
use super::source::{self, ForeignArgs, Found, FrameArgs, Origin};

/// Smallest extent of the core that a given inset must leave, in d.
const SMALLEST_CORE: f64 = 0.5;

pub(crate) const HELP: &str = "\
A run of `femdem pack` is measured from its checkpoint, and its files are written again. Of a run of
`femdem run` the end is measured, from its checkpoint, or a frame that has tables. A pack from elsewhere
is measured from
  bodies.csv                 shape,x,y,z,qw,qx,qy,qz and, if known, id and mass (kg)
  shape-NAME.obj             the surface of each shape, in m
  contacts.csv               if known: i,j,x,y,z,nx,ny,nz,normal_force and tx,ty,tz (friction on j), class;
                             without it contacts are found from the overlaps, and forces are not known

All get
  analysis.json              all results but the long lists, and what could not be found, with the reason
  analysis/*.csv             the tables; docs/analysis.md has their columns
  analysis/density-map.vti   local packing density, for ParaView
  analysis/mixing-over-time.csv  with --over-time: mixing in all frames of a run
  analysis/fields.vti        with --fields: density, velocity, stress and fabric as fields on a grid";

/// Options of `femdem analyse`.
#[derive(Debug, Args)]
pub(crate) struct AnalyseArgs {
    /// Folder of a run, which holds pack.ckpt or run.ckpt, or of a pack from elsewhere, which holds bodies.csv
    pub folder: PathBuf,

    /// Normal force in N, pressing or pulling, above which two bodies count as touching [default: 0]
    #[arg(long, value_name = "N")]
    pub threshold: Option<f64>,

    /// Axes of the stereonet and the order parameters: long, short, principal, faces, faces:SIDES, or
    /// directions in the body frame as X,Y,Z with ; between them [default: by the shapes]
    #[arg(long, value_name = "AXES", allow_hyphen_values = true)]
    pub axes: Option<Axes>,

    /// Distance of the core from walls, floor and mean top in d, 0 or more, kept even where the core gets
    /// small [default: 5, less where a core of 3 d would not remain]
    #[arg(long, value_name = "X")]
    pub core_inset: Option<f64>,

    /// Coarse-grained fields for ParaView: density, momentum, stress and fabric in analysis/fields.vti
    #[arg(long)]
    pub fields: bool,

    /// Radius of the coarse-graining function of --fields in d [default: 1.5]
    #[arg(long, value_name = "X", requires = "fields")]
    pub fields_width: Option<f64>,

    /// Distance of the points of --fields in d, at most the width [default: 0.5]
    #[arg(long, value_name = "X", requires = "fields")]
    pub fields_spacing: Option<f64>,

    /// Mixing of shapes and sizes over all frames of a run with tables, in analysis/mixing-over-time.csv
    #[arg(long, conflicts_with_all = ["frame", "time"])]
    pub over_time: bool,

    /// Folder for analysis.json and the tables [default: the folder of the pack, or of the tables of the frame]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    #[command(flatten)]
    pub frame: FrameArgs,

    #[command(flatten)]
    pub foreign: ForeignArgs,

    #[command(flatten)]
    pub work: WorkArgs,
}

/// Axes of bodies, as given on the command line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axes(BodyAxes);

impl FromStr for Axes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "give long, short, principal, faces, faces:SIDES, or X,Y,Z;X,Y,Z ...";
        let axes = match text {
            "long" => BodyAxes::Long,
            "short" => BodyAxes::Short,
            "principal" => BodyAxes::Principal,
            "faces" => BodyAxes::FaceNormals { sides: None },
            _ => match text.strip_prefix("faces:") {
                Some(sides) => BodyAxes::FaceNormals {
                    sides: Some(sides.parse().map_err(|_| form.to_owned())?),
                },
                None => BodyAxes::Fixed(directions(text).ok_or_else(|| form.to_owned())?),
            },
        };
        Ok(Self(axes))
    }
}

fn directions(text: &str) -> Option<Vec<[f64; 3]>> {
    let direction = |list: &str| {
        let numbers: Option<Vec<f64>> = list.split(',').map(|x| x.trim().parse().ok()).collect();
        numbers?.try_into().ok()
    };
    text.split(';').map(direction).collect()
}

pub(crate) fn run(args: &AnalyseArgs) -> Result<Outcome> {
    in_pool(args.work.threads.map(usize::from), |_| {
        let found = source::read(&args.folder, &args.foreign, &args.frame)?;
        found.refuse_moved_cell()?;
        // Options that cannot be met are refused before any file is written.
        let tables = tables(args, &found.snapshot)?;
        let series = args.over_time.then(|| over_time(args, &tables, &found));
        let series = series.transpose()?;
        if let Origin::Pack(saved) = &found.origin {
            let summary = results::write(&args.folder, &saved.packing, &saved.usage)?;
            report(&summary, &saved.packing, &args.folder, args.work.quiet)?;
        }
        if let Some(lead) = found.lead().filter(|_| !args.work.quiet) {
            say(&lead);
        }
        write(args, &tables, series.as_ref(), &found)
    })
}

/// Mixing in all frames of a run.
fn over_time(args: &AnalyseArgs, tables: &Tables, found: &Found) -> Result<MixingSeries> {
    let Origin::Run(saved, _) = &found.origin else {
        bail!(
            "--over-time is for a run of a scene, with its run.ckpt, which {} does not have: leave it out",
            args.folder.display()
        );
    };
    let run = &saved.0;
    let mut series = MixingSeries::default();
    for (number, time) in run.frames().iter().enumerate() {
        if !run.tables_of(&args.folder, number).join(BODIES).is_file() {
            bail!(
                "frame {number} of the run in {} has no tables, which --over-time needs: only a scene with \
                 tables = true writes them",
                args.folder.display()
            );
        }
        let snapshot = run.read_frame(&args.folder, number)?;
        series.add(number, *time, &snapshot, &tables.options)?;
    }
    if series.frames.is_empty() {
        let mut missing = tables.missing.iter();
        let reason = missing.find(|entry| entry.table.starts_with("mixing_by"));
        let reason = reason.map_or("all are of one", |entry| entry.reason.as_str());
        bail!("--over-time is for bodies of several shapes or sizes, and {reason}: leave it out");
    }
    Ok(series)
}

fn tables(args: &AnalyseArgs, snapshot: &Snapshot) -> Result<Tables> {
    if snapshot.gaps.forces && args.threshold.is_some() {
        bail!(
            "--threshold is for forces, and there is no contacts.csv that tells them: leave it out"
        );
    }
    let mut core = CoreOptions::default();
    if let Some(inset) = args.core_inset {
        core.inset_over_d = inset;
        core.minimum_core_over_d = SMALLEST_CORE;
    }
    let options = TableOptions {
        core,
        force_threshold: args.threshold.unwrap_or_default(),
        axes: args.axes.as_ref().map(|axes| axes.0.clone()),
        fields: args.fields.then(|| {
            let usual = FieldOptions::default();
            FieldOptions {
                width_over_d: args.fields_width.unwrap_or(usual.width_over_d),
                spacing_over_d: args.fields_spacing.unwrap_or(usual.spacing_over_d),
            }
        }),
        ..TableOptions::default()
    };
    Ok(Tables::compute(snapshot, &options)?)
}

fn write(
    args: &AnalyseArgs,
    tables: &Tables,
    series: Option<&MixingSeries>,
    found: &Found,
) -> Result<Outcome> {
    let out: &Path = args.out.as_ref().unwrap_or(&found.folder);
    tables.write(&found.snapshot, out)?;
    if let Some(series) = series {
        let path = out.join(FOLDER).join(MixingSeries::FILE);
        output::write_file(path, |w| series.write_csv(w))?;
    }
    if !args.work.quiet {
        let (all, lists) = (out.join(JSON), out.join(FOLDER));
        let places = format!("{} and {}", all.display(), lists.display());
        say(&format!("{tables}  {:<20} {places}", "tables in"));
    }
    Ok(Outcome::Finished)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_named_or_listed() {
        let parse = |text: &str| text.parse::<Axes>().map(|axes| axes.0);
        assert_eq!(parse("long"), Ok(BodyAxes::Long));
        assert_eq!(
            parse("faces:10"),
            Ok(BodyAxes::FaceNormals { sides: Some(10) })
        );
        let two = vec![[0.0, 0.0, 1.0], [1.0, -1.0, 0.5]];
        assert_eq!(parse("0,0,1; 1,-1,0.5"), Ok(BodyAxes::Fixed(two)));
        for bad in ["", "wide", "faces:many", "1,2", "1,2,3;"] {
            assert!(
                parse(bad).is_err_and(|e| e.contains("faces:SIDES")),
                "{bad}"
            );
        }
    }
}
