//! Prescribed motion of walls and driven bodies.

use crate::error::{SolveError, check};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A translation prescribed in time. Displacements count from where the wall or body was
/// added.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Does not move.
    #[default]
    Fixed,
    /// Moves at a constant velocity between two times and stays where it is then.
    Linear {
        /// Velocity, m/s.
        velocity: Vector3,
        /// Start of the motion, s.
        start: f64,
        /// End of the motion, s.
        end: f64,
    },
    /// Shaking: whole periods of amplitude (1 - cos(2 pi f t))/2, which starts and ends at
    /// rest.
    Shake {
        /// Full stroke, m.
        stroke: Vector3,
        /// Frequency f, 1/s.
        frequency: f64,
        /// Start, s.
        start: f64,
        /// Number of periods.
        periods: u32,
    },
    /// Tapping: single periods of a shake, one every `interval`.
    Tap {
        /// Full stroke of a tap, m.
        stroke: Vector3,
        /// Frequency of the tap itself, 1/s.
        frequency: f64,
        /// Start of the first tap, s.
        start: f64,
        /// Time from tap to tap, s; at least 1/frequency.
        interval: f64,
        /// Number of taps.
        taps: u32,
    },
}

/// Displacement and velocity of a driven thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Driven {
    pub displacement: Vector3,
    pub velocity: Vector3,
}

impl Drive {
    pub(crate) fn validate(&self) -> Result<(), SolveError> {
        let finite = |name, v: &Vector3| check(name, v.norm(), true, "finite");
        let time = |name, t: f64| check(name, t, true, "finite, in s");
        let frequency = |f: f64| check("drive.frequency", f, f > 0.0, "positive, in 1/s");
        match self {
            Self::Fixed => Ok(()),
            Self::Linear {
                velocity,
                start,
                end,
            } => {
                finite("drive.velocity", velocity)?;
                time("drive.start", *start)?;
                check(
                    "drive.end",
                    *end,
                    end >= start,
                    "at least drive.start, in s",
                )
            }
            Self::Shake {
                stroke,
                frequency: f,
                start,
                ..
            } => {
                finite("drive.stroke", stroke)?;
                time("drive.start", *start)?;
                frequency(*f)
            }
            Self::Tap {
                stroke,
                frequency: f,
                start,
                interval,
                ..
            } => {
                finite("drive.stroke", stroke)?;
                time("drive.start", *start)?;
                frequency(*f)?;
                check(
                    "drive.interval",
                    *interval,
                    *interval * f >= 1.0,
                    "at least one period, 1/frequency, in s",
                )
            }
        }
    }

    /// Whether it moves at time `t` or within `ahead` after it.
    pub(crate) fn is_active(&self, t: f64, ahead: f64) -> bool {
        let (from, to) = match *self {
            Self::Fixed => return false,
            Self::Linear { start, end, .. } => (start, end),
            Self::Shake {
                frequency,
                start,
                periods,
                ..
            } => (start, start + f64::from(periods) / frequency),
            Self::Tap {
                frequency,
                start,
                interval,
                taps,
                ..
            } => {
                let last = start + interval * f64::from(taps.saturating_sub(1));
                (start, last + 1.0 / frequency)
            }
        };
        t + ahead >= from && t <= to
    }

    /// Where it is at time `t`.
    pub(crate) fn at(&self, t: f64) -> Driven {
        let rest = Driven {
            displacement: Vector3::zeros(),
            velocity: Vector3::zeros(),
        };
        match *self {
            Self::Fixed => rest,
            Self::Linear {
                velocity,
                start,
                end,
            } => Driven {
                displacement: velocity * (t.clamp(start, end) - start),
                velocity: if t >= start && t < end {
                    velocity
                } else {
                    Vector3::zeros()
                },
            },
            Self::Shake {
                stroke,
                frequency,
                start,
                periods,
            } => swing(&stroke, frequency, t - start, f64::from(periods)),
            Self::Tap {
                stroke,
                frequency,
                start,
                interval,
                taps,
            } => {
                let since = t - start;
                let number = (since / interval).floor();
                if since < 0.0 || number >= f64::from(taps) {
                    rest
                } else {
                    swing(&stroke, frequency, since - number * interval, 1.0)
                }
            }
        }
    }
}

/// `periods` periods of stroke (1 - cos)/2 from time 0.
fn swing(stroke: &Vector3, frequency: f64, t: f64, periods: f64) -> Driven {
    let phase = t * frequency;
    if !(0.0..periods).contains(&phase) {
        return Driven {
            displacement: Vector3::zeros(),
            velocity: Vector3::zeros(),
        };
    }
    let (sin, cos) = (TAU * phase).sin_cos();
    Driven {
        displacement: stroke * (0.5 * (1.0 - cos)),
        velocity: stroke * (0.5 * TAU * frequency * sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_is_the_derivative_of_displacement() {
        let drives = [
            Drive::Linear {
                velocity: Vector3::new(1.0, 2.0, 3.0),
                start: 0.5,
                end: 2.0,
            },
            Drive::Shake {
                stroke: Vector3::z() * 0.02,
                frequency: 3.0,
                start: 0.1,
                periods: 4,
            },
            Drive::Tap {
                stroke: Vector3::x() * 0.01,
                frequency: 10.0,
                start: 0.2,
                interval: 0.5,
                taps: 3,
            },
        ];
        for drive in drives {
            drive.validate().unwrap();
            for k in 0..200 {
                let t = 0.013 * f64::from(k) + 1e-4;
                let h = 1e-6;
                let slope =
                    (drive.at(t + h).displacement - drive.at(t - h).displacement) / (2.0 * h);
                assert!(
                    (slope - drive.at(t).velocity).norm() < 1e-6,
                    "{drive:?} at {t}"
                );
            }
        }
    }

    #[test]
    fn a_tap_faster_than_its_interval_is_refused() {
        let drive = Drive::Tap {
            stroke: Vector3::z(),
            frequency: 1.0,
            start: 0.0,
            interval: 0.5,
            taps: 2,
        };
        assert!(
            drive
                .validate()
                .unwrap_err()
                .to_string()
                .contains("interval")
        );
    }
}
