//! Packs from elsewhere: `bodies.csv`, the shapes as surface files, and `contacts.csv` if there is one.
//!
//! | file | columns that must be there | columns that may be |
//! |---|---|---|
//! | `bodies.csv` | `shape`, `x`, `y`, `z`, `qw`, `qx`, `qy`, `qz` | `id`, `mass`, `sequence`, `sleeping` |
//! | `contacts.csv` | `i`, `j`, `x`, `y`, `z`, `nx`, `ny`, `nz`, `normal_force` | `tx`, `ty`, `tz`, `mx`, `my`, `mz`, `tangential_force`, `area`, `volume`, `class`, `patch` |
//! | `walls.csv` of a frame of a run ([`read_walls`]) | `wall`, `x`, `y`, `z`, `qw`, `qx`, `qy`, `qz` | |
//! | any table of poses ([`read_poses`]) | `x`, `y`, `z`, `qw`, `qx`, `qy`, `qz` | `shape`, `vx`, `vy`, `vz`, `wx`, `wy`, `wz`, `d` or `scale` |
//!
//! The columns have the meaning that [`output::csv`](crate::output::csv) states, in SI units and in any order;
//! others are ignored. The shape `NAME` is read from `shape-NAME.obj` (see
//! [`shape_file_names`](crate::output::surface::shape_file_names)), `NAME.obj`, or `NAME` itself if it is the
//! name of a surface file (OBJ, STL, OFF, PLY), in the folder or else in the one that holds it. Data that the files do
//! not contain are marked in the [`gaps`](Snapshot::gaps) of the snapshot.

mod bodies;
mod contacts;
mod csv;
mod plain;
mod poses;
mod walls;

pub use bodies::BODIES;
pub use contacts::CONTACTS;
pub use plain::{PlainTable, read_plain};
pub use poses::{PoseRow, read_poses};
pub use walls::{WALLS, read_walls};

use std::path::Path;

use femdem_analysis::Region;

use crate::{Body, Snapshot, ViewError};

/// Data that the files of a pack do not contain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InputOptions {
    /// Density of the bodies \[kg/m³\], where they have no column `mass`.
    pub density: Option<f64>,
    /// Gravity along −z \[m/s²\]; 0 for none.
    pub gravity: f64,
    /// Inside of the container.
    pub container: Option<Region>,
}

/// Reads the pack in a folder.
///
/// # Errors
///
/// [`ViewError::Read`], [`ViewError::Table`] with file and line, [`ViewError::Mesh`] for a shape that is not a body,
/// [`ViewError::Option`], and [`ViewError::Analysis`] for a container without a volume.
pub fn read_folder(
    folder: impl AsRef<Path>,
    options: &InputOptions,
) -> Result<Snapshot, ViewError> {
    let folder = folder.as_ref();
    options.check()?;
    let mut pack = bodies::read(folder, options.density)?;
    pack.snapshot.container = options.container;
    pack.snapshot.gravity = options.gravity;
    let path = folder.join(CONTACTS);
    if path.is_file() {
        contacts::read(&path, &mut pack)?;
    } else {
        pack.snapshot.gaps.contacts = true;
    }
    pack.snapshot.check()?;
    if let Some(container) = &pack.snapshot.container {
        let is_in = |body: &Body| container.contains(&body.pose.translation.vector.into());
        if !pack.snapshot.bodies.iter().any(is_in) {
            return Err(ViewError::Option {
                name: "inside",
                value: "a region without a body".to_owned(),
                allowed: "it has to hold the pack, in the frame and unit of the table of bodies (m)",
            });
        }
    }
    Ok(pack.snapshot)
}

impl InputOptions {
    fn check(&self) -> Result<(), ViewError> {
        let refuse = |name, value: f64, allowed| {
            Err(ViewError::Option {
                name,
                value: value.to_string(),
                allowed,
            })
        };
        if let Some(density) = self.density
            && !(density.is_finite() && density > 0.0)
        {
            return refuse("density", density, "above zero and finite (kg/m³)");
        }
        if !self.gravity.is_finite() || self.gravity < 0.0 {
            return refuse("gravity", self.gravity, "zero or more and finite (m/s²)");
        }
        if let Some(container) = &self.container {
            container.validate()?;
        }
        Ok(())
    }
}
