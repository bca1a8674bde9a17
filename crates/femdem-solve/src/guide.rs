//! What moves as prescribed: by a [`Drive`], which is a function of time, or step by step as the host says.

use crate::error::{SolveError, check};
use femdem_fem::{Drive, Driven};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// How a wall or a body moves as prescribed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) enum Guide {
    Drive(Drive),
    /// As the host said: now, and at the end of the step that is being taken.
    Host {
        now: Driven,
        then: Driven,
    },
}

impl Guide {
    /// A guide that stands still.
    pub const FIXED: Self = Self::Drive(Drive::Fixed);

    /// Of a host that has said only where the thing is now.
    pub fn host(now: Driven) -> Self {
        let then = Driven {
            velocity: Vector3::zeros(),
            rate: 0.0,
            ..now
        };
        Self::Host { now, then }
    }

    /// Where it is at the present time, s.
    pub fn now(&self, time: f64) -> Driven {
        match self {
            Self::Drive(drive) => drive.at(time),
            Self::Host { now, .. } => *now,
        }
    }

    /// Where it will be at the end of the step, s.
    pub fn then(&self, end: f64) -> Driven {
        match self {
            Self::Drive(drive) => drive.at(end),
            Self::Host { then, .. } => *then,
        }
    }

    /// Whether it stands still for good.
    pub fn is_fixed(&self) -> bool {
        *self == Self::FIXED
    }

    /// Whether it moves at time `t` or within `ahead` after it, s.
    pub fn is_active(&self, t: f64, ahead: f64) -> bool {
        match self {
            Self::Drive(drive) => drive.is_active(t, ahead),
            Self::Host { now, then } => {
                let moves = |x: &Driven| x.velocity != Vector3::zeros() || x.rate != 0.0;
                moves(now)
                    || moves(then)
                    || now.displacement != then.displacement
                    || now.angle != then.angle
            }
        }
    }

    /// Steps that resolve its oscillation, s. A host bounds the steps itself.
    pub fn resolving_step(&self, t: f64, ahead: f64) -> f64 {
        match self {
            Self::Drive(drive) => drive.resolving_step(t, ahead),
            Self::Host { .. } => f64::INFINITY,
        }
    }

    /// The drive, if it is one.
    pub fn drive(&self) -> Option<Drive> {
        match self {
            Self::Drive(drive) => Some(*drive),
            Self::Host { .. } => None,
        }
    }

    /// Checks that its numbers are finite and in their ranges.
    pub fn validate(&self) -> Result<(), SolveError> {
        match self {
            Self::Drive(drive) => Ok(drive.validate()?),
            Self::Host { now, then } => [now, then].into_iter().try_for_each(check_driven),
        }
    }

    /// Takes what the host says of the end of the step; with nothing said, it stays where it is.
    pub fn follow(&mut self, said: Option<Driven>) -> Result<(), SolveError> {
        let Self::Host { now, then } = self else {
            return Ok(());
        };
        let Some(said) = said else {
            *self = Self::host(*now);
            return Ok(());
        };
        check_driven(&said)?;
        let turns = |x: &Driven| x.angle != 0.0 || x.rate != 0.0;
        if turns(now) && turns(&said) {
            let off = (said.axis - now.axis).norm() + (said.point - now.point).norm();
            check(
                "change of the axis of a motion that the host prescribes",
                off,
                off == 0.0,
                "0 while it is turned: begin a new motion where it is, by drive_body_by_host or drive_wall_by_host",
            )?;
        }
        *then = said;
        Ok(())
    }

    /// The step has been taken.
    pub fn arrive(&mut self) {
        if let Self::Host { now, then } = self {
            *now = *then;
        }
    }
}

/// Refuses what is not finite, and a turn about no axis.
pub(crate) fn check_driven(driven: &Driven) -> Result<(), SolveError> {
    let vectors = [driven.displacement, driven.velocity, driven.point];
    let sum = vectors.iter().map(Vector3::norm).sum::<f64>() + driven.angle + driven.rate;
    let allowed = "finite in all its numbers";
    check("motion that the host prescribes", sum, true, allowed)?;
    let length = driven.axis.norm();
    let turns = driven.angle != 0.0 || driven.rate != 0.0;
    check(
        "length of the axis of a motion that the host prescribes",
        length,
        !turns || (length - 1.0).abs() <= 1e-9,
        "1 to 1e-9 if it is turned",
    )
}
