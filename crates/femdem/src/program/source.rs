//! The pack in a folder: of a run, or from elsewhere.

use std::path::Path;

use anyhow::{Result, bail};
use clap::Args;
use femdem::input::{self, InputOptions};
use femdem::{Snapshot, results};

use super::analyse::Inside;
use super::folder::{self, Saved};

/// Gravity where nothing else is said \[m/s²\].
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

/// Reads the checkpoint of a folder or, where there is none, its tables; the run comes with the former.
pub(crate) fn read(folder: &Path, foreign: &ForeignArgs) -> Result<(Snapshot, Option<Saved>)> {
    if !folder::has_checkpoint(folder) && folder.join(input::BODIES).is_file() {
        let options = InputOptions {
            density: foreign.density,
            gravity: foreign.gravity.unwrap_or(GRAVITY),
            container: foreign.inside.map(Inside::region),
        };
        return Ok((input::read_folder(folder, &options)?, None));
    }
    if foreign.density.or(foreign.gravity).is_some() || foreign.inside.is_some() {
        bail!(
            "--density, --gravity and --inside are for a pack from elsewhere; the checkpoint in {} knows \
             them",
            folder.display()
        );
    }
    let saved = folder::load(folder)?;
    Ok((results::snapshot(&saved.packing), Some(saved)))
}
