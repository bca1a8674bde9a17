//! The periodic cell of a scenario.

use femdem_analysis::PeriodicSpace;
use femdem_contact::{BodyId, PeriodicCell};
use femdem_mesh::{Point3, Pose, Vector3};
use serde::{Deserialize, Serialize};

use super::{ControlEntry, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;
use crate::scene::in_metres;

/// A box that repeats itself along some of its axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CellEntry {
    /// Lowest corner \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub lower: [f64; 3],
    /// Highest corner \[m\]; along an axis that does not repeat itself it says nothing.
    #[serde(deserialize_with = "in_metres")]
    pub upper: [f64; 3],
    /// Axes along which the box repeats itself, such as "xy".
    #[serde(default = "all")]
    pub axes: String,
    /// What the cell is to do.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub control: Option<ControlEntry>,
}

/// Axes along which every cell can repeat itself.
const AXES: [char; 3] = ['x', 'y', 'z'];

fn all() -> String {
    AXES.iter().collect()
}

impl CellEntry {
    /// Sides \[m\].
    pub(super) fn sides(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.upper[k] - self.lower[k])
    }

    /// The middle \[m\], which stays where it is.
    pub(super) fn centre(&self) -> Vector3 {
        0.5 * (Vector3::from(self.lower) + Vector3::from(self.upper))
    }

    /// Whether it repeats itself along an axis.
    pub(super) fn repeats(&self, axis: usize) -> bool {
        self.axes.contains(AXES[axis])
    }

    fn cell(&self) -> Result<PeriodicCell, Error> {
        let known = self.axes.chars().all(|axis| AXES.contains(&axis));
        let count = (0..3).filter(|&axis| self.repeats(axis)).count();
        if !known || count == 0 || count != self.axes.len() {
            let allowed = "each of the letters x, y and z at most once, such as \"xy\"";
            return Err(wrong("cell.axes", &format!("\"{}\"", self.axes), allowed));
        }
        let finite = |corner: &[f64; 3]| corner.iter().all(|x| x.is_finite());
        for (name, corner) in [("cell.lower", &self.lower), ("cell.upper", &self.upper)] {
            if !finite(corner) {
                let allowed = "three finite numbers, in m";
                return Err(wrong(name, &format!("{corner:?}"), allowed));
            }
        }
        let sides = self.sides();
        if (0..3).any(|axis| self.repeats(axis) && sides[axis] <= 0.0) {
            let allowed = "above cell.lower along the axes";
            return Err(wrong("cell.upper", &format!("{:?}", self.upper), allowed));
        }
        Ok(PeriodicCell::new(
            [0, 1, 2].map(|axis| self.repeats(axis).then_some(sides[axis])),
        )?)
    }
}

impl Scenario {
    /// Makes space periodic in a world without bodies.
    pub(super) fn make_periodic(&self, simulation: &mut Simulation) -> Result<(), Error> {
        if let Some(entry) = &self.cell {
            let falls = simulation.world.parameters().gravity != Vector3::zeros();
            if falls && (0..3).all(|axis| entry.repeats(axis)) {
                let gravity = simulation.world.parameters().gravity;
                let allowed = "[0, 0, 0] in a cell that repeats itself along x, y and z: nothing can bear a weight";
                return Err(wrong(
                    "gravity",
                    &format!("{:?}", gravity.as_slice()),
                    allowed,
                ));
            }
            simulation.world.set_cell(entry.cell()?)?;
            simulation.centre = entry.centre();
        }
        Ok(())
    }
}

impl Simulation {
    /// The periodic cell, and the lowest corner of the box of its sides, which fills space as the cell does where that leans.
    pub(super) fn space(&self) -> Option<PeriodicSpace> {
        let cell = *self.world.cell()?;
        let lower = Point3::from(self.centre - 0.5 * cell.edges().diagonal());
        Some(PeriodicSpace { cell, lower })
    }

    /// The image of a place that lies in that box \[m\].
    pub(super) fn wrapped(&self, x: &Vector3) -> Vector3 {
        let place = Point3::from(*x);
        self.space()
            .map_or(*x, |space| space.wrapped(&place).coords)
    }

    /// The pose of a rigid body, or of the image of it that lies in the periodic cell.
    pub(super) fn shown(&self, id: BodyId) -> Option<Pose> {
        let (mut pose, centroid) = (self.world.pose(id)?, self.world.position(id)?);
        pose.translation.vector += self.wrapped(&centroid) - centroid;
        Some(pose)
    }

    /// Lowest and highest corner of the box in which frames show the periodic cell, if it repeats itself along all axes \[m\].
    pub(super) fn shown_cell(&self) -> Option<[Vector3; 2]> {
        let cell = self.world.cell()?;
        cell.volume()?;
        let half = 0.5 * cell.edges().diagonal();
        Some([self.centre - half, self.centre + half])
    }
}
