//! Prescribed motions in a scenario.

use femdem_mesh::Vector3;
use femdem_solve::Drive;
use serde::{Deserialize, Serialize};

use crate::scene::in_metres;

/// A prescribed motion of a wall, a body or nodes. Displacements count from their initial places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum MotionEntry {
    /// At a constant velocity between two times.
    Linear {
        /// Velocity \[m/s\].
        velocity: [f64; 3],
        /// Start \[s\].
        #[serde(default)]
        start: f64,
        /// End \[s\].
        #[serde(default = "never")]
        end: f64,
    },
    /// Shaking: whole periods of stroke (1 − cos(2 π f t))/2, which start and end at rest.
    Shake {
        /// Full stroke \[m\].
        #[serde(deserialize_with = "in_metres")]
        stroke: [f64; 3],
        /// Frequency f \[1/s\].
        frequency: f64,
        /// Start \[s\].
        #[serde(default)]
        start: f64,
        /// Number of periods.
        #[serde(default = "forever")]
        periods: u32,
    },
    /// Tapping: single periods of a shake.
    Tap {
        /// Full stroke of a tap \[m\].
        #[serde(deserialize_with = "in_metres")]
        stroke: [f64; 3],
        /// Frequency of the tap itself \[1/s\].
        frequency: f64,
        /// Time from tap to tap \[s\], at least 1/frequency.
        interval: f64,
        /// Start of the first tap \[s\].
        #[serde(default)]
        start: f64,
        /// Number of taps.
        #[serde(default = "forever")]
        taps: u32,
    },
    /// Turning at a constant rate between two times.
    Turn {
        /// Direction of the axis, of any length; the sense is right-handed.
        axis: [f64; 3],
        /// A point of the axis \[m\].
        #[serde(default, deserialize_with = "in_metres")]
        point: [f64; 3],
        /// Rate \[rad/s\].
        rate: f64,
        /// Start \[s\].
        #[serde(default)]
        start: f64,
        /// End \[s\].
        #[serde(default = "never")]
        end: f64,
    },
    /// Rocking about an axis: whole periods of angle (1 − cos(2 π f t))/2.
    Rock {
        /// Direction of the axis, of any length; the sense is right-handed.
        axis: [f64; 3],
        /// A point of the axis \[m\].
        #[serde(default, deserialize_with = "in_metres")]
        point: [f64; 3],
        /// Full stroke \[degrees\].
        angle: f64,
        /// Frequency f \[1/s\].
        frequency: f64,
        /// Start \[s\].
        #[serde(default)]
        start: f64,
        /// Number of periods.
        #[serde(default = "forever")]
        periods: u32,
    },
}

fn never() -> f64 {
    f64::MAX
}

fn forever() -> u32 {
    u32::MAX
}

impl MotionEntry {
    /// Its largest speed \[m/s\], where `reach` gives the largest distance of a body from an axis, with its point.
    pub(super) fn fastest(&self, reach: impl Fn(&[f64; 3], &[f64; 3]) -> f64) -> f64 {
        // A stroke of (1 - cos(2 pi f t))/2 has the largest rate pi f.
        let swing = |frequency: f64| std::f64::consts::PI * frequency;
        match self {
            Self::Linear { velocity, .. } => Vector3::from(*velocity).norm(),
            Self::Shake {
                stroke, frequency, ..
            }
            | Self::Tap {
                stroke, frequency, ..
            } => Vector3::from(*stroke).norm() * swing(*frequency),
            Self::Turn {
                axis, point, rate, ..
            } => rate.abs() * reach(axis, point),
            Self::Rock {
                axis,
                point,
                angle,
                frequency,
                ..
            } => angle.to_radians().abs() * swing(*frequency) * reach(axis, point),
        }
    }

    /// The motion, for a world.
    #[must_use]
    pub fn drive(&self) -> Drive {
        match *self {
            Self::Linear {
                velocity,
                start,
                end,
            } => Drive::Linear {
                velocity: velocity.into(),
                start,
                end,
            },
            Self::Shake {
                stroke,
                frequency,
                start,
                periods,
            } => Drive::Shake {
                stroke: stroke.into(),
                frequency,
                start,
                periods,
            },
            Self::Tap {
                stroke,
                frequency,
                interval,
                start,
                taps,
            } => Drive::Tap {
                stroke: stroke.into(),
                frequency,
                start,
                interval,
                taps,
            },
            Self::Turn {
                axis,
                point,
                rate,
                start,
                end,
            } => Drive::Turn {
                axis: axis.into(),
                point: point.into(),
                rate,
                start,
                end,
            },
            Self::Rock {
                axis,
                point,
                angle,
                frequency,
                start,
                periods,
            } => Drive::Rock {
                axis: Vector3::from(axis),
                point: point.into(),
                stroke: angle.to_radians(),
                frequency,
                start,
                periods,
            },
        }
    }
}
