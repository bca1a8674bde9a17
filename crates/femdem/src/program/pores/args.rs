//! Options of `femdem pores`.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use femdem::scene::Length;

use crate::program::source::{ForeignArgs, FrameArgs, Inside};

pub(crate) const HELP: &str = "\
The folder pores then holds
  pores.json                 the results in numbers; docs/pores.md has its keys
  pore-sizes.csv             the distribution of pore diameters
  labels.vti, fields.vti     for ParaView: bodies; distance, pore diameter, path length
  labels.mhd, phases.mhd     for Fiji, ITK and lattice Boltzmann codes, with their .raw files
  flow/                      closed surfaces in named parts, and a case of OpenFOAM around them

Lengths are in d, the mean circumscribed diameter, or in m or mm with the unit: 0.05, 0.5mm, 2e-4m.";

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

/// A length with its unit, or in body diameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size(pub(super) Length);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "give a number of body diameters, such as 0.05, or a length with its unit, such as 0.5mm or 2e-4m";
        let read = match text.trim().strip_suffix("mm") {
            Some(number) => match number.trim_end().parse::<f64>() {
                Ok(x) if x.is_finite() && x >= 0.0 => Some(Length::Metres(1e-3 * x)),
                _ => None,
            },
            None => text.parse().ok(),
        };
        read.map(Self).ok_or_else(|| form.to_owned())
    }
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

    /// Side of a voxel; changed a little, so that a whole number fits [default: 0.05]
    #[arg(long, value_name = "LENGTH")]
    pub voxel: Option<Size>,

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
    pub gap: Option<Size>,

    /// Radius of the cylinders of --contacts bridge, at least 1.5 voxels [default: 0.1]
    #[arg(long, value_name = "LENGTH")]
    pub bridge: Option<Size>,

    /// Length of the empty tube before and after the bodies in the surfaces [default: 1]
    #[arg(long, value_name = "LENGTH", conflicts_with = "region")]
    pub margin: Option<Size>,

    /// Image, distances, pores and paths only
    #[arg(long, conflicts_with_all = ["contacts", "factor", "gap", "bridge", "margin"])]
    pub no_surface: bool,

    /// Folder for the results [default: pores in the folder of the pack, or of the tables of the frame]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    #[command(flatten)]
    pub frame: FrameArgs,

    #[command(flatten)]
    pub foreign: ForeignArgs,

    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// No summary on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,
}

impl PoresArgs {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        for (text, length) in [
            ("0.5mm", Length::Metres(5e-4)),
            ("2e-4m", Length::Metres(2e-4)),
            ("0.05", Length::Diameters(0.05)),
        ] {
            assert_eq!(text.parse::<Size>(), Ok(Size(length)));
        }
        for bad in ["", "mm", "-1mm", "wide", "infmm", "1cm"] {
            assert!(
                bad.parse::<Size>().is_err_and(|e| e.contains("0.5mm")),
                "{bad}"
            );
        }
    }
}
