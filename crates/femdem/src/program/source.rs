//! The pack in a folder: of a run, or from elsewhere.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Result, bail};
use clap::Args;
use femdem::analysis::Region;
use femdem::input::{self, InputOptions};
use femdem::mesh::Point3;
use femdem::output::{counted, short_number};
use femdem::run::Run;
use femdem::{Snapshot, Usage, results};

use super::complain;
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

    /// Inside of the container in m, of a pack from elsewhere or a run: a box as X0,Y0,Z0,X1,Y1,Z1, or
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

/// Which state of a run of `femdem run`.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct FrameArgs {
    /// Number of a frame, from 0, of a run whose scene says tables = true [default: the end of the run]
    #[arg(long, value_name = "N", conflicts_with = "time")]
    frame: Option<usize>,

    /// Simulated time in s: the frame nearest to it, instead of --frame
    #[arg(long, value_name = "S")]
    time: Option<f64>,
}

impl FrameArgs {
    /// Whether any of them is given.
    pub(super) fn is_given(&self) -> bool {
        self.frame.is_some() || self.time.is_some()
    }

    /// The number of the frame that is asked for.
    fn number(&self, run: &Run) -> Result<Option<usize>> {
        let times = run.frames();
        let Some(last) = times.len().checked_sub(1) else {
            if self.is_given() {
                bail!("the run has written no frame yet: leave out --frame and --time");
            }
            return Ok(None);
        };
        if let Some(number) = self.frame.filter(|number| *number > last) {
            bail!("--frame = {number} is not allowed: the run has the frames 0 to {last}");
        }
        let Some(time) = self.time else {
            return Ok(self.frame);
        };
        if !time.is_finite() {
            bail!("--time = {time} is not allowed: give a simulated time in s");
        }
        let far = |number: &usize| (times[*number] - time).abs();
        Ok((0..=last).min_by(|a, b| far(a).total_cmp(&far(b))))
    }
}

/// A pack as it was read.
pub(crate) struct Found {
    pub snapshot: Snapshot,
    pub origin: Origin,
    /// Where results belong, unless the user says another place.
    pub folder: PathBuf,
}

/// Where a pack was read from.
pub(crate) enum Origin {
    /// The checkpoint of `femdem pack`.
    Pack(Box<Saved>),
    /// The checkpoint of `femdem run`; with the number of the frame whose tables were read, if not its end.
    Run(Box<(Run, Usage)>, Option<usize>),
    /// Tables.
    Elsewhere,
}

impl Found {
    /// Refuses frames of a periodic cell that may have moved since: their tables do not tell its edges.
    pub(super) fn refuse_moved_cell(&self) -> Result<()> {
        if let Origin::Run(_, Some(frame)) = &self.origin
            && self
                .snapshot
                .space
                .is_some_and(|space| space.cell.volume().is_some())
        {
            bail!(
                "the tables of frame {frame} do not tell the edges of the periodic cell then: leave out --frame and --time to \
                 measure the end of the run; cells.csv has solid fractions, stresses and strains over time"
            );
        }
        Ok(())
    }

    /// Refuses a state of a run without a body, and names the last frame with some.
    pub(super) fn refuse_empty(&self, folder: &Path) -> Result<()> {
        let Origin::Run(saved, frame) = &self.origin else {
            return Ok(());
        };
        if !self.snapshot.bodies.is_empty() {
            return Ok(());
        }
        let run = &saved.0;
        let holds_bodies = |number: &usize| {
            let bodies = input::read_plain(run.tables_of(folder, *number).join(input::BODIES));
            bodies.is_ok_and(|table| !table.rows.is_empty())
        };
        let what = frame.map_or("the end".to_owned(), |number| format!("frame {number}"));
        let advice = match (0..run.frames().len()).rev().find(holds_bodies) {
            Some(last) => {
                format!("give --frame {last}, the last that holds bodies, or another before it")
            }
            None => {
                "run the scene with tables = true, and give a frame by --frame or --time".to_owned()
            }
        };
        bail!(
            "{what} of the run in {} holds no body: {advice}; `femdem report` shows what the run has measured",
            folder.display()
        );
    }

    /// What was read, in a line; `None` for a pack, which has a summary.
    pub(super) fn lead(&self) -> Option<String> {
        let snapshot = &self.snapshot;
        let (bodies, contacts) = (snapshot.bodies.len(), snapshot.contacts.len());
        let kind = snapshot.shape_name();
        let from = match &self.origin {
            Origin::Pack(_) => return None,
            Origin::Elsewhere if snapshot.gaps.forces => "found from their overlaps".to_owned(),
            Origin::Elsewhere => "from tables".to_owned(),
            Origin::Run(saved, frame) => {
                let run = &saved.0;
                let at = |time: f64| format!("at {} s", short_number(time));
                match frame {
                    None => format!("of the run {}", at(run.simulation().world.time())),
                    Some(frame) => format!("of frame {frame} {}", at(run.frames()[*frame])),
                }
            }
        };
        Some(format!(
            "{} {kind} with {}, {from}",
            counted(bodies, "body", "bodies"),
            counted(contacts, "contact", "contacts")
        ))
    }
}

/// As [`read_any`], of a state that holds bodies.
pub(crate) fn read(folder: &Path, foreign: &ForeignArgs, frame: &FrameArgs) -> Result<Found> {
    let found = read_any(folder, foreign, frame)?;
    found.refuse_empty(folder)?;
    Ok(found)
}

/// Reads the checkpoint of a folder or, if there is none, its tables.
pub(crate) fn read_any(folder: &Path, foreign: &ForeignArgs, frame: &FrameArgs) -> Result<Found> {
    if folder::holds_run(folder) {
        return of_run(folder, foreign, frame);
    }
    if frame.is_given() {
        bail!(
            "--frame and --time are for a run of a scene, with its run.ckpt, which {} does not have: leave them out",
            folder.display()
        );
    }
    let own = folder.to_path_buf();
    if !folder::has_checkpoint(folder) {
        if !folder.join(input::BODIES).is_file() {
            super::stages::refuse_folder_of_stages(folder)?;
            bail!(
                "there is no {}, no {} and no {} in {}: give the folder of a run of `femdem pack` or `femdem run`, \
                 or of a pack from elsewhere",
                folder::CHECKPOINT,
                folder::RUN_CHECKPOINT,
                input::BODIES,
                folder.display()
            );
        }
        let options = InputOptions {
            density: foreign.density,
            gravity: foreign.gravity.unwrap_or(GRAVITY),
            container: foreign.inside.map(|inside| inside.0),
        };
        let mut snapshot = input::read_folder(folder, &options)?;
        if snapshot.gaps.contacts
            && let Err(error) = results::find_contacts(&mut snapshot)
        {
            complain(&format!(
                "warning: there is no {}, and contacts were not found from the bodies: {error}",
                input::CONTACTS
            ));
        }
        return Ok(Found {
            snapshot,
            origin: Origin::Elsewhere,
            folder: own,
        });
    }
    if foreign.is_given() {
        bail!(
            "--density, --gravity and --inside are for a pack from elsewhere; the checkpoint in {} knows \
             them",
            folder.display()
        );
    }
    let saved = folder::load(folder)?;
    Ok(Found {
        snapshot: results::snapshot(&saved.packing),
        origin: Origin::Pack(Box::new(saved)),
        folder: own,
    })
}

/// The end of a run, or the tables of one of its frames.
fn of_run(folder: &Path, foreign: &ForeignArgs, frame: &FrameArgs) -> Result<Found> {
    if foreign.density.or(foreign.gravity).is_some() {
        bail!(
            "--density and --gravity are for a pack from elsewhere; the checkpoint in {} knows them",
            folder.display()
        );
    }
    let (run, usage) = Run::read(folder)?;
    let number = frame.number(&run)?;
    let (mut snapshot, place) = match number {
        None => (run.simulation().snapshot()?, folder.to_path_buf()),
        Some(number) => {
            let place = run.tables_of(folder, number);
            if !place.join(input::BODIES).is_file() {
                bail!(
                    "frame {number} of the run in {} has no tables: only a scene with tables = true writes them; \
                     without --frame and --time the end of the run is taken",
                    folder.display()
                );
            }
            (run.read_frame(folder, number)?, place)
        }
    };
    if let Some(Inside(region)) = foreign.inside {
        if snapshot.space.is_some() {
            bail!(
                "--inside is not for a run in a periodic cell, which is its own container: leave it out"
            );
        }
        snapshot.container = Some(region);
    }
    Ok(Found {
        snapshot,
        origin: Origin::Run(Box::new((run, usage)), number),
        folder: place,
    })
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
