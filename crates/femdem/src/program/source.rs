//! The pack in a folder: of a run, or from elsewhere.

use std::path::Path;
use std::str::FromStr;

use anyhow::{Result, bail};
use clap::Args;
use femdem::analysis::Region;
use femdem::input::{self, InputOptions};
use femdem::mesh::Point3;
use femdem::{Snapshot, results};

use super::folder::{self, Saved};

/// Default gravity \[m/s²\].
const GRAVITY: f64 = 9.81;

/// What the files of a pack from elsewhere do not tell.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct ForeignArgs {
    /// Density of the bodies in kg/m3, of a pack from elsewhere without a column mass
    #[arg(long, value_name = "KG/M3")]
    density: Option<f64>,

    /// Gravity in m/s2, of a pack from elsewhere [default: 9.81]
    #[arg(long, value_name = "M/S2")]
    gravity: Option<f64>,

    /// Inside of the container in m, of a pack from elsewhere: a box as X0,Y0,Z0,X1,Y1,Z1, or
    /// cylinder:X,Y,RADIUS,Z0,Z1
    #[arg(long, value_name = "REGION", allow_hyphen_values = true)]
    inside: Option<Inside>,
}

impl ForeignArgs {
    /// Whether any of them is given.
    pub(super) fn is_given(&self) -> bool {
        self.density.or(self.gravity).is_some() || self.inside.is_some()
    }
}

/// The inside of a container, as given on the command line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Inside(pub(super) Region);

impl FromStr for Inside {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "give X0,Y0,Z0,X1,Y1,Z1 or cylinder:X,Y,RADIUS,Z0,Z1, in m";
        let (round, list) = match text.strip_prefix("cylinder:") {
            Some(list) => (true, list),
            None => (false, text),
        };
        let numbers: Result<Vec<f64>, _> = list.split(',').map(|x| x.trim().parse()).collect();
        let region = match (round, numbers.as_deref()) {
            (false, Ok(&[x0, y0, z0, x1, y1, z1])) => Region::Box {
                min: Point3::new(x0, y0, z0),
                max: Point3::new(x1, y1, z1),
            },
            (true, Ok(&[x, y, radius, z_min, z_max])) => Region::Cylinder {
                centre: [x, y],
                radius,
                z_min,
                z_max,
            },
            _ => return Err(form.to_owned()),
        };
        region
            .validate()
            .map_err(|error| format!("{error}; {form}"))?;
        Ok(Self(region))
    }
}

/// Reads the checkpoint of a folder or, if there is none, its tables; with a checkpoint it also returns the
/// run.
pub(crate) fn read(folder: &Path, foreign: &ForeignArgs) -> Result<(Snapshot, Option<Saved>)> {
    if !folder::has_checkpoint(folder) {
        if !folder.join(input::BODIES).is_file() {
            bail!(
                "there is no {} and no {} in {}: give the folder of a run of `femdem pack`, or of a pack \
                 from elsewhere",
                folder::CHECKPOINT,
                input::BODIES,
                folder.display()
            );
        }
        let options = InputOptions {
            density: foreign.density,
            gravity: foreign.gravity.unwrap_or(GRAVITY),
            container: foreign.inside.map(|inside| inside.0),
        };
        return Ok((input::read_folder(folder, &options)?, None));
    }
    if foreign.is_given() {
        bail!(
            "--density, --gravity and --inside are for a pack from elsewhere; the checkpoint in {} knows \
             them",
            folder.display()
        );
    }
    let saved = folder::load(folder)?;
    Ok((results::snapshot(&saved.packing), Some(saved)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn insides_are_boxes_or_cylinders() {
        let parse = |text: &str| text.parse::<Inside>();
        let cube = Region::Box {
            min: Point3::new(-1.0, 0.0, 0.0),
            max: Point3::new(1.0, 2.0, 3.5),
        };
        assert_eq!(parse("-1,0, 0,1,2,3.5"), Ok(Inside(cube)));
        let drum = Region::Cylinder {
            centre: [0.0, 1.0],
            radius: 2.0,
            z_min: 0.0,
            z_max: 4.0,
        };
        assert_eq!(parse("cylinder:0,1,2,0,4"), Ok(Inside(drum)));
        for bad in ["", "1,2,3", "cylinder:1,2,3", "0,0,0,1,1,x"] {
            assert!(parse(bad).is_err_and(|e| e.contains("X0,Y0")), "{bad}");
        }
        assert!(parse("0,0,0,1,1,-1").is_err_and(|e| e.contains("max.z - min.z")));
    }
}
