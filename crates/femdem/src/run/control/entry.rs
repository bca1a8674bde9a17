//! Controlled walls in a scenario.

use femdem_fem::Curve;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::error::wrong;

/// How a wall is controlled: a plane or a wall from a file by `force` or by `pressure` on an `area`; a box by what its axes
/// `x`, `y` and `z` are to do. A periodic cell has axes, too, and `shear`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct ControlEntry {
    /// Force with which the wall presses along its direction \[N\].
    pub force: Option<f64>,
    /// The same as a pressure on `area` \[Pa\].
    pub pressure: Option<f64>,
    /// Area on which the pressure acts \[m²\].
    pub area: Option<f64>,
    /// Direction in which the wall moves and presses, of any length. `None`: the normal of a plane.
    pub direction: Option<[f64; 3]>,
    /// Largest speed \[m/s\].
    pub speed: Option<f64>,
    /// Factor of the force or pressure over time, as points \[s, factor\] with straight lines between.
    pub table: Option<Vec<[f64; 2]>>,
    /// The walls of a box across x.
    pub x: Option<AxisEntry>,
    /// The walls of a box across y.
    pub y: Option<AxisEntry>,
    /// The walls of a box across z.
    pub z: Option<AxisEntry>,
    /// Shear of a periodic cell.
    pub shear: Option<ShearEntry>,
}

/// How a periodic cell is sheared: what lies higher along z moves along x.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ShearEntry {
    /// Velocity along x over height along z \[1/s\].
    pub rate: f64,
    /// Factor of the rate over time, as points \[s, factor\] with straight lines between.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Vec<[f64; 2]>>,
}

impl ShearEntry {
    /// The rate over time \[1/s\].
    pub(super) fn rate(&self) -> Result<Curve, Error> {
        curve(self.rate, self.table.as_ref())
    }

    fn largest(&self) -> f64 {
        self.rate.abs() * largest_factor(self.table.as_ref())
    }
}

/// What the two walls of a box across an axis do: exactly one of `stress`, `force` and `strain-rate`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct AxisEntry {
    /// Mean stress of the two walls on their present area, positive in compression \[Pa\].
    pub stress: Option<f64>,
    /// Mean force of the two walls, positive in compression \[N\]; not in a periodic cell.
    pub force: Option<f64>,
    /// Rate of the logarithmic strain, positive in compression \[1/s\].
    pub strain_rate: Option<f64>,
    /// Largest speed of each wall \[m/s\].
    pub speed: Option<f64>,
    /// Which of the two walls move.
    pub sides: Sides,
    /// Factor of the stress or rate over time, as points \[s, factor\] with straight lines between.
    pub table: Option<Vec<[f64; 2]>>,
}

/// The walls of a box across an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sides {
    /// Both, by the same way towards each other.
    #[default]
    Both,
    /// The one of the lower coordinate.
    Lower,
    /// The one of the higher coordinate.
    Upper,
}

impl ControlEntry {
    /// The axes of a box, with their numbers.
    pub(super) fn axes(&self) -> impl Iterator<Item = (usize, &AxisEntry)> {
        let axes = [&self.x, &self.y, &self.z];
        (0..)
            .zip(axes)
            .filter_map(|(k, axis)| Some((k, axis.as_ref()?)))
    }

    /// The force over time \[N\] and the limit of speed, for a wall that is no box.
    pub(super) fn force(&self) -> Result<(Curve, f64), Error> {
        if self.axes().next().is_some() {
            return Err(wrong(
                "control.x, y or z",
                "given",
                "for a wall with `box` only: give force, or pressure and area",
            ));
        }
        self.refuse_shear()?;
        let force = match (self.force, self.pressure, self.area) {
            (Some(force), None, None) => compression("control.force", force)?,
            (None, Some(pressure), Some(area)) => {
                if !(area > 0.0 && area.is_finite()) {
                    let allowed = "a positive, finite area, in m²";
                    return Err(wrong("control.area", &area.to_string(), allowed));
                }
                compression("control.pressure", pressure)? * area
            }
            _ => {
                return Err(wrong(
                    "control",
                    "no force, or more than one way to say it",
                    "give force, or pressure together with area",
                ));
            }
        };
        let table = pressing(self.table.as_ref())?;
        Ok((curve(force, table)?, speed(self.speed)?))
    }

    /// The direction of a wall that is no box; `normal` is that of a plane.
    pub(super) fn direction(&self, normal: Option<Vector3>) -> Result<Vector3, Error> {
        let Some(given) = self.direction else {
            let allowed = "give the direction in which the wall is to press: it has no normal";
            return normal.ok_or_else(|| wrong("control.direction", "none", allowed));
        };
        let direction = Vector3::from(given);
        if !direction.norm().is_finite() {
            let allowed = "three finite numbers";
            return Err(wrong("control.direction", &format!("{given:?}"), allowed));
        }
        direction.try_normalize(0.0).ok_or_else(|| {
            let allowed = "not all zero";
            wrong("control.direction", &format!("{given:?}"), allowed)
        })
    }

    fn refuse_shear(&self) -> Result<(), Error> {
        match self.shear {
            Some(_) => {
                let allowed = "for a periodic cell only: walls are moved by `motion`";
                Err(wrong("control.shear", "given", allowed))
            }
            None => Ok(()),
        }
    }

    /// Refuses what belongs to other walls than boxes.
    pub(super) fn check_box(&self) -> Result<(), Error> {
        self.refuse_shear()?;
        self.check_axes(self.axes().next().is_some())
    }

    /// Refuses what belongs to walls.
    pub(super) fn check_cell(&self) -> Result<(), Error> {
        if self.axes().any(|(_, axis)| axis.sides != Sides::Both) {
            let allowed = "for walls only: a periodic cell has no sides";
            return Err(wrong("control.sides", "given", allowed));
        }
        if self.axes().any(|(_, axis)| axis.force.is_some()) {
            let allowed = "for walls only: give a stress to a periodic cell";
            return Err(wrong("force", "given", allowed));
        }
        self.check_axes(self.shear.is_some() || self.axes().next().is_some())
    }

    /// Refuses what belongs to single walls, and a control of nothing.
    fn check_axes(&self, any: bool) -> Result<(), Error> {
        let others = [self.force, self.pressure, self.area, self.speed];
        if others.iter().any(Option::is_some) || self.direction.is_some() || self.table.is_some() {
            return Err(wrong(
                "control",
                "a force, pressure, area, direction, speed or table of a box or a cell",
                "give them to the axes, such as control.z = { stress = 1e5, speed = 0.1 }",
            ));
        }
        if !any {
            let allowed = "give at least one of the axes x, y and z, or, to a periodic cell, shear";
            return Err(wrong("control", "empty", allowed));
        }
        Ok(())
    }

    /// The largest speed that it allows or prescribes, where a box has these sides \[m/s\].
    pub(in crate::run) fn fastest(&self, sides: [f64; 3]) -> f64 {
        let of_axis = |(k, axis): (usize, &AxisEntry)| {
            let rate = axis.strain_rate.unwrap_or(0.0) * largest_factor(axis.table.as_ref());
            axis.speed.unwrap_or(0.0).max(rate.abs() * sides[k])
        };
        let shear = self.shear.as_ref().map(|shear| shear.largest() * sides[2]);
        let axes = self.axes().map(of_axis).chain(shear).fold(0.0, f64::max);
        axes.max(self.speed.unwrap_or(0.0))
    }

    /// The largest stress, where `area` is on what a force presses \[Pa\].
    pub(in crate::run) fn largest_stress(&self, area: f64) -> f64 {
        let of_axis = |(_, axis): (usize, &AxisEntry)| {
            let stress = axis.stress.or(axis.force.map(|force| force / area));
            stress.unwrap_or(0.0) * largest_factor(axis.table.as_ref())
        };
        let axes = self.axes().map(of_axis).fold(0.0, f64::max);
        let pressed = self.force.map(|force| force / area).or(self.pressure);
        axes.max(pressed.unwrap_or(0.0) * largest_factor(self.table.as_ref()))
    }

    /// The time from which on its goals are constant \[s\].
    pub(in crate::run) fn settled_from(&self) -> f64 {
        let axes = self.axes().filter_map(|(_, axis)| axis.table.as_ref());
        let shear = self.shear.as_ref().and_then(|shear| shear.table.as_ref());
        let points = axes.chain(&self.table).chain(shear).flatten();
        points.map(|[time, _]| *time).fold(0.0, f64::max)
    }
}

impl AxisEntry {
    /// The stress \[Pa\] or force \[N\] over time and the limit of speed, or the rate of strain over time \[1/s\].
    pub(super) fn goal(&self) -> Result<(Curve, Option<f64>), Error> {
        match (self.stress, self.force, self.strain_rate) {
            (Some(stress), None, None) => self.pressing(compression("stress", stress)?),
            (None, Some(force), None) => self.pressing(compression("force", force)?),
            (None, None, Some(rate)) => {
                if self.speed.is_some() {
                    let allowed = "for a stress only: a rate of strain has its speed";
                    return Err(wrong("speed", "given", allowed));
                }
                Ok((curve(rate, self.table.as_ref())?, None))
            }
            _ => Err(wrong(
                "an axis of control",
                "none or several of its kinds",
                "give one of stress, force and strain-rate",
            )),
        }
    }

    fn pressing(&self, most: f64) -> Result<(Curve, Option<f64>), Error> {
        let curve = curve(most, pressing(self.table.as_ref())?)?;
        Ok((curve, Some(speed(self.speed)?)))
    }
}

fn compression(name: &'static str, value: f64) -> Result<f64, Error> {
    if value >= 0.0 && value.is_finite() {
        return Ok(value);
    }
    let allowed = "0 or more and finite: walls press, they cannot pull";
    Err(wrong(name, &value.to_string(), allowed))
}

/// A table of factors of a force, which are not negative.
fn pressing(table: Option<&Vec<[f64; 2]>>) -> Result<Option<&Vec<[f64; 2]>>, Error> {
    for [_, factor] in table.into_iter().flatten() {
        compression("a factor of the table", *factor)?;
    }
    Ok(table)
}

fn speed(given: Option<f64>) -> Result<f64, Error> {
    given.ok_or_else(|| {
        let allowed = "give the largest speed of the wall, in m/s";
        wrong("speed", "none", allowed)
    })
}

/// `value` over time.
fn curve(value: f64, table: Option<&Vec<[f64; 2]>>) -> Result<Curve, Error> {
    let curve = table.map_or(Curve::Constant(value), |table| Curve::factors(value, table));
    curve.validate()?;
    Ok(curve)
}

fn largest_factor(table: Option<&Vec<[f64; 2]>>) -> f64 {
    let Some(table) = table else { return 1.0 };
    table
        .iter()
        .map(|[_, factor]| factor.abs())
        .fold(0.0, f64::max)
}
