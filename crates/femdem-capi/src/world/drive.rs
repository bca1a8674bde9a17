//! Prescribed motions of walls and bodies of a world.

use femdem_solve::Drive;

use crate::border::{Failure, FemdemStatus, border, given};
use crate::handles::FemdemWorld;

/// Kind of a FemdemDrive: held where it is.
pub const FEMDEM_DRIVE_FIXED: i32 = 0;
/// Kind of a FemdemDrive: at the velocity `vector` in m/s from `start` to `end`.
pub const FEMDEM_DRIVE_LINEAR: i32 = 1;
/// Kind of a FemdemDrive: from `start` on, `periods` of a swing (1 - cos(2 pi `frequency` t))/2 along the stroke `vector` in m.
pub const FEMDEM_DRIVE_SHAKE: i32 = 2;
/// Kind of a FemdemDrive: about an axis `vector` through `point` at `rate` in rad/s from `start` to `end`.
pub const FEMDEM_DRIVE_TURN: i32 = 3;

/// A motion whatever touches, counted from where the wall, body or node is when it is given. What its kind has no use for is not read.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemDrive {
    /// One of the FEMDEM_DRIVE constants.
    pub kind: i32,
    /// Of a shake.
    pub periods: u32,
    /// Velocity, stroke or axis.
    pub vector: [f64; 3],
    /// A point of the axis, m.
    pub point: [f64; 3],
    /// rad/s.
    pub rate: f64,
    /// 1/s.
    pub frequency: f64,
    /// s.
    pub start: f64,
    /// s; infinite: for ever.
    pub end: f64,
}

impl FemdemDrive {
    pub(super) fn drive(&self) -> Result<Drive, Failure> {
        let (vector, start) = (self.vector.into(), self.start);
        // Ends are finite.
        let end = if self.end == f64::INFINITY {
            f64::MAX
        } else {
            self.end
        };
        Ok(match self.kind {
            FEMDEM_DRIVE_FIXED => Drive::Fixed,
            FEMDEM_DRIVE_LINEAR => Drive::Linear {
                velocity: vector,
                start,
                end,
            },
            FEMDEM_DRIVE_SHAKE => Drive::Shake {
                stroke: vector,
                frequency: self.frequency,
                start,
                periods: self.periods,
            },
            FEMDEM_DRIVE_TURN => Drive::Turn {
                axis: vector,
                point: self.point.into(),
                rate: self.rate,
                start,
                end,
            },
            kind => {
                return Err(Failure::refused(
                    "kind",
                    kind,
                    "one of the FEMDEM_DRIVE constants",
                ));
            }
        })
    }
}

/// Moves a wall as prescribed.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_drive_wall(
    world: FemdemWorld,
    wall: u32,
    drive: Option<&FemdemDrive>,
) -> FemdemStatus {
    border(|| {
        let drive = given("drive", drive)?.drive()?;
        world.with(|own| Ok(own.world.drive_wall(wall, drive)?))
    })
}

/// Moves a body as prescribed, whatever touches it; null: sets it free with the velocity that it has.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_drive_body(
    world: FemdemWorld,
    body: u32,
    drive: Option<&FemdemDrive>,
) -> FemdemStatus {
    border(|| {
        let drive = drive.map(FemdemDrive::drive).transpose()?;
        world.with(|own| Ok(own.world.drive_body(body, drive)?))
    })
}
