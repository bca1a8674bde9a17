//! Options of `femdem pores`.

use std::path::PathBuf;

use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};
use femdem::output::short_number;
use femdem::scene::Length;

use crate::program::args::WorkArgs;
use crate::program::source::{ForeignArgs, FrameArgs, Inside};

pub(crate) const HELP: &str = "\
The folder pores then holds
  pores.json                 the results in numbers; docs/pores.md has its keys
  pore-sizes.csv             the distribution of pore diameters
  labels.vti, fields.vti     for ParaView: bodies; distance, pore diameter, path length
  labels.mhd, phases.mhd     for Fiji, ITK and lattice Boltzmann codes, with their .raw files
  flow/                      closed surfaces in named parts, and a case of OpenFOAM around them

Lengths other than --region are in d, the mean circumscribed diameter, or in m or mm with the unit: 0.05, 0.5mm, 2e-4m.";

/// How contacts are treated in the surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Contacts {
    /// All bodies are scaled about their centroids, by --factor
    Shrink,
    /// Bodies that touch are scaled about their centroids until --gap is left (convex bodies)
    Gap,
    /// Bodies that touch lose a flat cap, so that --gap is left there (convex bodies)
    Cap,
    /// Bodies are joined by a cylinder of the radius --bridge at each contact; made on the voxels
    Bridge,
}

/// What the upright sides of the region are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SidesKind {
    /// Walls: distances, pores and the flow end there
    Wall,
    /// Cuts through a pack that goes on beyond
    Open,
}

/// Options of `femdem pores`.
#[derive(Debug, Args)]
pub(crate) struct PoresArgs {
    /// Folder of a run, which holds pack.ckpt or run.ckpt, or of a pack from elsewhere, which holds bodies.csv
    pub folder: PathBuf,

    /// The part of space to look at, in m: a box as X0,Y0,Z0,X1,Y1,Z1, or cylinder:X,Y,RADIUS,Z0,Z1 [default:
    /// the container up to the mean top of the pack; surfaces: from --margin below the lowest body to --margin
    /// above the highest]
    #[arg(long, value_name = "REGION", allow_hyphen_values = true)]
    pub region: Option<Inside>,

    /// Side of a voxel, in d without a unit; changed a little, so that a whole number fits [default: 0.05]
    #[arg(long, value_name = "LENGTH")]
    pub voxel: Option<Length>,

    /// What the upright sides of the region are [default: wall, if it is as wide as the container; else open]
    #[arg(long, value_enum)]
    pub sides: Option<SidesKind>,

    /// How contacts are treated in the surfaces [default: cap, if all bodies are convex; else shrink]
    #[arg(long, value_enum)]
    pub contacts: Option<Contacts>,

    /// Factor of --contacts shrink, 0.5 to 1 [default: 0.99, or as much less, to 0.9, as takes all bodies apart]
    #[arg(long, value_name = "X")]
    pub factor: Option<f64>,

    /// Gap of --contacts gap and cap [default: 0.01]
    #[arg(long, value_name = "LENGTH")]
    pub gap: Option<Length>,

    /// Radius of the cylinders of --contacts bridge, at least 1.5 voxels [default: 0.1]
    #[arg(long, value_name = "LENGTH")]
    pub bridge: Option<Length>,

    /// Length of the empty tube before and after the bodies in the surfaces [default: 1]
    #[arg(long, value_name = "LENGTH", conflicts_with = "region")]
    pub margin: Option<Length>,

    /// Superficial velocity of the flow along z in m/s: the flow over the whole cross-section [default: such that
    /// the Reynolds number, of this velocity and d, is 1]
    #[arg(long, value_name = "M/S")]
    pub velocity: Option<f64>,

    /// Kinematic viscosity of the fluid in m2/s [default: 1e-6, of water]
    #[arg(long, value_name = "M2/S")]
    pub viscosity: Option<f64>,

    /// Image, distances, pores and paths only
    #[arg(long, conflicts_with_all = ["contacts", "factor", "gap", "bridge", "margin", "velocity", "viscosity"])]
    pub no_surface: bool,

    /// Folder for the results [default: pores in the folder of the pack, or of the tables of the frame]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    #[command(flatten)]
    pub frame: FrameArgs,

    #[command(flatten)]
    pub foreign: ForeignArgs,

    #[command(flatten)]
    pub work: WorkArgs,
}

/// Kinematic viscosity of water at 20 °C \[m²/s\].
const WATER: f64 = 1e-6;

/// Fluid and flow of the case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fluid {
    /// Superficial velocity \[m/s\].
    pub velocity: f64,
    /// Kinematic viscosity \[m²/s\].
    pub viscosity: f64,
}

impl PoresArgs {
    /// Fluid and flow around bodies of a mean diameter \[m\].
    pub(super) fn fluid(&self, diameter: f64) -> Result<Fluid> {
        let given = [
            ("velocity", self.velocity, "m/s"),
            ("viscosity", self.viscosity, "m2/s"),
        ];
        for (name, value, unit) in given {
            let value = value.unwrap_or(1.0);
            ensure!(
                value > 0.0 && value.is_finite(),
                "--{name} {} is not allowed: give a number above 0 in {unit}",
                short_number(value)
            );
        }
        let viscosity = self.viscosity.unwrap_or(WATER);
        Ok(Fluid {
            velocity: self.velocity.unwrap_or(viscosity / diameter),
            viscosity,
        })
    }

    /// The treatment of contacts; `None` without surfaces.
    pub(super) fn treatment(&self, all_convex: bool) -> Option<Contacts> {
        let usual = if all_convex {
            Contacts::Cap
        } else {
            Contacts::Shrink
        };
        (!self.no_surface).then(|| self.contacts.unwrap_or(usual))
    }

    /// Refuses options that have no effect beside the treatment of contacts.
    pub(super) fn refuse_idle(&self, treatment: Contacts) -> Result<()> {
        let named = |kind: Contacts| match kind {
            Contacts::Shrink => "shrink",
            Contacts::Gap => "gap",
            Contacts::Cap => "cap",
            Contacts::Bridge => "bridge",
        };
        for (name, given, used) in [
            ("factor", self.factor.is_some(), &[Contacts::Shrink][..]),
            ("gap", self.gap.is_some(), &[Contacts::Gap, Contacts::Cap]),
            ("bridge", self.bridge.is_some(), &[Contacts::Bridge]),
        ] {
            if given && !used.contains(&treatment) {
                let kinds: Vec<&str> = used.iter().map(|kind| named(*kind)).collect();
                bail!(
                    "--{name} has no effect with --contacts {}: give --contacts {} or leave it out",
                    named(treatment),
                    kinds.join(" or ")
                );
            }
        }
        Ok(())
    }
}
