//! Prescribed motion of walls and driven bodies.

use crate::error::{FemError, check};
use femdem_mesh::nalgebra::{Translation3, Unit};
use femdem_mesh::{Pose, Rotation, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A motion prescribed in time. Displacements and angles count from where the wall or body
/// was added.
///
/// ```
/// use femdem_fem::Drive;
/// use femdem_mesh::Vector3;
///
/// // A floor that is shaken by 2 mm at 50 Hz for ten periods, from 1 s on.
/// let shake = Drive::Shake { stroke: Vector3::new(0.0, 0.0, 2e-3), frequency: 50.0, start: 1.0, periods: 10 };
/// shake.validate()?;
/// assert_eq!(shake.at(0.5).displacement, Vector3::zeros());
/// // Half a period after the start it is at its full stroke, at rest.
/// let top = shake.at(1.01);
/// assert!((top.displacement.z - 2e-3).abs() < 1e-12 && top.velocity.norm() < 1e-9);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
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
    /// Turning at a constant rate between two times, as a drum does.
    Turn {
        /// Direction of the axis, of any length; the sense is right-handed.
        axis: Vector3,
        /// A point of the axis, m.
        point: Vector3,
        /// Rate, rad/s.
        rate: f64,
        /// Start of the motion, s.
        start: f64,
        /// End of the motion, s.
        end: f64,
    },
    /// Rocking about an axis: whole periods of stroke (1 - cos(2 pi f t))/2, which starts
    /// and ends at rest.
    Rock {
        /// Direction of the axis, of any length; the sense is right-handed.
        axis: Vector3,
        /// A point of the axis, m.
        point: Vector3,
        /// Full stroke, rad.
        stroke: f64,
        /// Frequency f, 1/s.
        frequency: f64,
        /// Start, s.
        start: f64,
        /// Number of periods.
        periods: u32,
    },
}

/// Least number of steps in a period of a swing: its stroke is then found to 1 %.
const STEPS_OF_PERIOD: f64 = 20.0;

/// Where a driven thing has come to from its base, and how it moves.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Driven {
    /// m.
    pub displacement: Vector3,
    /// m/s.
    pub velocity: Vector3,
    /// Unit axis; zero for a translation.
    pub axis: Vector3,
    /// A point of the axis, m.
    pub point: Vector3,
    /// rad.
    pub angle: f64,
    /// rad/s.
    pub rate: f64,
}

impl Driven {
    fn turned(axis: &Vector3, point: Vector3, angle: f64, rate: f64) -> Self {
        Self {
            axis: axis.try_normalize(0.0).unwrap_or_default(),
            point,
            angle,
            rate,
            ..Self::default()
        }
    }

    fn rotation(&self) -> Rotation {
        Rotation::from_axis_angle(&Unit::new_unchecked(self.axis), self.angle)
    }

    /// The pose that a base pose has come to.
    pub fn place(&self, base: &Pose) -> Pose {
        let from = base.translation.vector;
        if self.angle == 0.0 {
            let to = from + self.displacement;
            return Pose::from_parts(Translation3::from(to), base.rotation);
        }
        let turn = self.rotation();
        let to = self.point + turn * (from - self.point) + self.displacement;
        Pose::from_parts(Translation3::from(to), turn * base.rotation)
    }

    /// The base pose that has come to `pose`.
    pub fn base_of(&self, pose: &Pose) -> Pose {
        let to = pose.translation.vector - self.displacement;
        if self.angle == 0.0 {
            return Pose::from_parts(Translation3::from(to), pose.rotation);
        }
        let back = self.rotation().inverse();
        let from = self.point + back * (to - self.point);
        Pose::from_parts(Translation3::from(from), back * pose.rotation)
    }

    /// rad/s.
    pub fn angular_velocity(&self) -> Vector3 {
        self.axis * self.rate
    }

    /// Velocity of the driven thing's point that is at `position` now, m/s.
    pub fn velocity_at(&self, position: &Vector3) -> Vector3 {
        self.velocity + self.angular_velocity().cross(&(position - self.point))
    }

    /// Largest speed of its points within `radius` of a point, m/s.
    pub fn fastest_near(&self, x: &Vector3, radius: f64) -> f64 {
        let turning = self.rate.abs() * ((x - self.point).norm() + radius);
        self.velocity.norm() + if self.rate == 0.0 { 0.0 } else { turning }
    }

    /// Bound of the way of points up to `reach` from the point of the axis, from an earlier
    /// state, m.
    pub fn way_from(&self, earlier: &Self, reach: f64) -> f64 {
        (self.displacement - earlier.displacement).norm()
            + (self.angle - earlier.angle).abs() * reach
    }
}

impl Drive {
    /// Checks that its numbers are finite and in their ranges.
    ///
    /// # Errors
    /// [`FemError::Parameter`] names the number.
    pub fn validate(&self) -> Result<(), FemError> {
        let finite = |name, v: &Vector3| check(name, v.norm(), true, "finite");
        let time = |name, t: f64| check(name, t, true, "finite, in s");
        let frequency =
            |f: f64| check("drive.frequency", f, f > 0.0, "positive and finite, in 1/s");
        let direction = |v: &Vector3| {
            let length = v.norm();
            check("drive.axis", length, length > 0.0, "of a length above zero")
        };
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
                    "finite and at least the start, in s",
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
                    *interval >= 1.0 / f,
                    "at least one period, 1/frequency, in s",
                )
            }
            Self::Turn {
                axis,
                point,
                rate,
                start,
                end,
            } => {
                direction(axis)?;
                finite("drive.point", point)?;
                check("drive.rate", *rate, true, "finite, in rad/s")?;
                time("drive.start", *start)?;
                check(
                    "drive.end",
                    *end,
                    end >= start,
                    "finite and at least the start, in s",
                )
            }
            Self::Rock {
                axis,
                point,
                stroke,
                frequency: f,
                start,
                ..
            } => {
                direction(axis)?;
                finite("drive.point", point)?;
                check("drive.stroke", *stroke, true, "finite, in rad")?;
                time("drive.start", *start)?;
                frequency(*f)
            }
        }
    }

    /// Whether it moves at time `t` or within `ahead` after it.
    pub fn is_active(&self, t: f64, ahead: f64) -> bool {
        let within = |from: f64, to: f64| t + ahead >= from && t <= to;
        match *self {
            Self::Fixed => false,
            Self::Linear {
                velocity,
                start,
                end,
            } => velocity != Vector3::zeros() && within(start, end),
            Self::Turn {
                rate, start, end, ..
            } => rate != 0.0 && within(start, end),
            Self::Shake {
                stroke,
                frequency,
                start,
                periods,
            } => {
                stroke != Vector3::zeros() && within(start, start + f64::from(periods) / frequency)
            }
            Self::Rock {
                stroke,
                frequency,
                start,
                periods,
                ..
            } => stroke != 0.0 && within(start, start + f64::from(periods) / frequency),
            Self::Tap {
                stroke,
                frequency,
                start,
                interval,
                taps,
            } => {
                if taps == 0 || stroke == Vector3::zeros() {
                    return false;
                }
                // The last tap that has begun by then, or by round-off the one before: others are over.
                let begun = ((t + ahead - start) / interval).floor();
                [begun, begun - 1.0].into_iter().any(|number| {
                    let from = start + interval * number.clamp(0.0, f64::from(taps - 1));
                    within(from, from + 1.0 / frequency)
                })
            }
        }
    }

    /// Steps that resolve what it does at time `t` or within `ahead` after it, s: parts of the period while it swings,
    /// else infinite.
    pub fn resolving_step(&self, t: f64, ahead: f64) -> f64 {
        match *self {
            Self::Shake { frequency, .. }
            | Self::Rock { frequency, .. }
            | Self::Tap { frequency, .. }
                if self.is_active(t, ahead) =>
            {
                1.0 / (STEPS_OF_PERIOD * frequency)
            }
            _ => f64::INFINITY,
        }
    }

    /// Where it is at time `t`.
    pub fn at(&self, t: f64) -> Driven {
        match *self {
            Self::Fixed => Driven::default(),
            Self::Linear {
                velocity,
                start,
                end,
            } => {
                let [since, moves] = ramp(t, start, end);
                translated(&velocity, since, moves)
            }
            Self::Shake {
                stroke,
                frequency,
                start,
                periods,
            } => {
                let [part, rate] = swing(frequency, t - start, f64::from(periods));
                translated(&stroke, part, rate)
            }
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
                    return Driven::default();
                }
                let [part, rate] = swing(frequency, since - number * interval, 1.0);
                translated(&stroke, part, rate)
            }
            Self::Turn {
                axis,
                point,
                rate,
                start,
                end,
            } => {
                let [since, moves] = ramp(t, start, end);
                Driven::turned(&axis, point, rate * since, rate * moves)
            }
            Self::Rock {
                axis,
                point,
                stroke,
                frequency,
                start,
                periods,
            } => {
                let [part, rate] = swing(frequency, t - start, f64::from(periods));
                Driven::turned(&axis, point, stroke * part, stroke * rate)
            }
        }
    }
}

fn translated(along: &Vector3, part: f64, rate: f64) -> Driven {
    Driven {
        displacement: along * part,
        velocity: along * rate,
        ..Driven::default()
    }
}

/// Time since `start` until `end`, and its rate.
fn ramp(t: f64, start: f64, end: f64) -> [f64; 2] {
    let moves = t >= start && t < end;
    [t.clamp(start, end) - start, f64::from(u8::from(moves))]
}

/// `periods` periods of (1 - cos)/2 from time 0, and their rate.
fn swing(frequency: f64, t: f64, periods: f64) -> [f64; 2] {
    let phase = t * frequency;
    if !(0.0..periods).contains(&phase) {
        return [0.0; 2];
    }
    let (sin, cos) = (TAU * phase).sin_cos();
    [0.5 * (1.0 - cos), 0.5 * TAU * frequency * sin]
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

    /// A point of a turning thing moves at the velocity that is stated, and `base_of` undoes
    /// `place`.
    #[test]
    fn points_move_at_the_velocity_of_the_turn() {
        let (axis, point) = (Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.3, 0.1, -0.2));
        let drives = [
            Drive::Turn {
                axis,
                point,
                rate: -1.7,
                start: 0.2,
                end: 1.5,
            },
            Drive::Rock {
                axis,
                point,
                stroke: 0.8,
                frequency: 2.0,
                start: 0.1,
                periods: 3,
            },
        ];
        let turn = Rotation::from_euler_angles(0.1, 0.2, 0.3);
        let base = Pose::from_parts(Translation3::new(1.0, 2.0, 3.0), turn);
        let x = Vector3::new(0.4, 0.5, -0.6);
        for drive in drives {
            drive.validate().unwrap();
            let at = |t: f64| drive.at(t).place(&base).transform_point(&x.into()).coords;
            for k in 0..200 {
                let (t, h) = (0.0093 * f64::from(k) + 1e-4, 1e-6);
                let slope = (at(t + h) - at(t - h)) / (2.0 * h);
                let driven = drive.at(t);
                let off = (slope - driven.velocity_at(&at(t))).norm();
                assert!(off < 1e-6, "{drive:?} at {t}: {off:e}");
                let back = driven.base_of(&driven.place(&base));
                assert!((back.translation.vector - base.translation.vector).norm() < 1e-13);
                assert!(back.rotation.angle_to(&base.rotation) < 1e-7);
                assert!((at(t) - at(0.0)).norm() <= driven.way_from(&drive.at(0.0), 5.0));
            }
        }
        let flat = Drive::Turn {
            axis: Vector3::zeros(),
            point,
            rate: 1.0,
            start: 0.0,
            end: 1.0,
        };
        assert!(flat.validate().unwrap_err().to_string().contains("axis"));
    }

    /// A tap right after the other: 1/49 times 49 is below 1.
    #[test]
    fn taps_without_a_pause_are_allowed() {
        let drive = Drive::Tap {
            stroke: Vector3::z(),
            frequency: 49.0,
            start: 0.0,
            interval: 1.0 / 49.0,
            taps: 2,
        };
        drive.validate().unwrap();
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
