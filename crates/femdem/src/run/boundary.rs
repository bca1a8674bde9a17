//! Boundary conditions of deformable bodies in a scenario.

use femdem_fem::{Boundary, Curve, DeformableModel};
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

use super::{MotionEntry, SelectEntry};
use crate::Error;
use crate::error::wrong;

/// A condition on the nodes that `select` chooses, in the coordinates of the shape: exactly one of
/// `fix`, `motion`, `pressure` and `traction`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct BoundaryEntry {
    /// Name of the support (`fix` or `motion`) in results; empty: by its number.
    #[serde(default)]
    pub name: String,
    /// The nodes, such as `{ plane = { normal = [1, 0, 0] } }`.
    pub select: SelectEntry,
    /// Holds the nodes where they are.
    #[serde(default)]
    pub fix: bool,
    /// Moves the nodes as prescribed.
    #[serde(default)]
    pub motion: Option<MotionEntry>,
    /// The directions of the world (x, y, z) on which `fix` and `motion` act.
    #[serde(default = "all")]
    pub directions: [bool; 3],
    /// Pressure against the faces of the skin between the nodes \[Pa\], following them.
    #[serde(default)]
    pub pressure: Option<f64>,
    /// Traction on these faces per reference area \[Pa\], in a fixed direction.
    #[serde(default)]
    pub traction: Option<[f64; 3]>,
    /// Time over which `pressure` or `traction` rises from zero \[s\].
    #[serde(default)]
    pub rise: Option<f64>,
    /// Factor of `pressure` or `traction` over time, as points \[s, factor\] with straight lines
    /// between.
    #[serde(default)]
    pub table: Option<Vec<[f64; 2]>>,
}

fn all() -> [bool; 3] {
    [true; 3]
}

impl BoundaryEntry {
    /// Whether it holds or moves nodes.
    pub(super) fn holds(&self) -> bool {
        self.fix || self.motion.is_some()
    }

    /// The time from which on its load is constant \[s\].
    pub(super) fn settled_from(&self) -> f64 {
        let table = self.table.iter().flatten().map(|[time, _]| *time);
        table.chain(self.rise).fold(0.0, f64::max)
    }

    /// Adds the condition for a body of a model and of this radius \[m\].
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key at fault, [`Error::Fem`] where no node is selected.
    pub fn add_to(
        &self,
        boundary: &mut Boundary,
        model: &DeformableModel,
        body_radius: f64,
    ) -> Result<(), Error> {
        let selection = self.select.selection(body_radius);
        let loaded = self.pressure.is_some() || self.traction.is_some();
        if !loaded && (self.rise.is_some() || self.table.is_some()) {
            return Err(wrong(
                "rise or table",
                "given",
                "give them with pressure or traction only",
            ));
        }
        if loaded && self.directions != all() {
            return Err(wrong(
                "directions",
                "given",
                "give them with fix or motion only: a traction is a vector",
            ));
        }
        if loaded && !self.name.is_empty() {
            return Err(wrong(
                "boundary.name",
                &format!("\"{}\"", self.name),
                "give it with fix or motion only, whose forces are in the results",
            ));
        }
        if self.directions == [false; 3] {
            return Err(wrong(
                "directions",
                "[false, false, false]",
                "at least one true: the condition would hold nothing",
            ));
        }
        match (self.fix, &self.motion, &self.pressure, &self.traction) {
            (true, None, None, None) => boundary.fix(model, &selection, self.directions)?,
            (false, Some(motion), None, None) => {
                boundary.drive(model, &selection, self.directions, motion.drive())?
            }
            (false, None, Some(pressure), None) => {
                boundary.press(model, &selection, self.curve(*pressure)?)?
            }
            (false, None, None, Some(traction)) => {
                let traction = Vector3::from(*traction);
                boundary.pull(model, &selection, traction, self.curve(1.0)?)?
            }
            _ => {
                return Err(wrong(
                    "boundary",
                    "none or several of its kinds",
                    "give exactly one of fix, motion, pressure and traction",
                ));
            }
        };
        Ok(())
    }

    /// `value` over time.
    fn curve(&self, value: f64) -> Result<Curve, Error> {
        match (self.rise, &self.table) {
            (None, None) => Ok(Curve::Constant(value)),
            (Some(rise), None) => Ok(Curve::Ramp { value, rise }),
            (None, Some(table)) => Ok(Curve::factors(value, table)),
            (Some(_), Some(_)) => Err(wrong(
                "rise and table",
                "both given",
                "give one of the two, or neither",
            )),
        }
    }
}
