//! Where a body and its copies begin, and how fast.

use std::collections::BTreeSet;
use std::path::Path;

use femdem_mesh::{Pose, Vector3};
use femdem_view::input::{PoseRow, read_poses};
use femdem_view::output::surface::shape_file_name;

use super::BodyEntry;
use super::geometry::Geometry;
use crate::Error;
use crate::error::wrong;

/// The beginning of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Coordinates of its shape -> world.
    pub pose: Pose,
    /// m/s.
    pub velocity: Vector3,
    /// rad/s.
    pub spin: Vector3,
    /// Its size over that of the shape.
    pub scale: f64,
}

impl BodyEntry {
    /// Places of the body and its copies.
    pub(super) fn places(&self, geometry: &Geometry) -> Result<Vec<Place>, Error> {
        let place = |pose| Place {
            pose,
            velocity: Vector3::from(self.velocity),
            spin: Vector3::from(self.spin),
            scale: 1.0,
        };
        let Some(path) = &self.poses else {
            return Ok(self.lattice()?.into_iter().map(place).collect());
        };
        let rows = rows_of(path, &geometry.name)?;
        let Some(first) = rows.first() else {
            return Err(wrong(
                "poses",
                &format!("\"{}\"", path.display()),
                "a table with at least one row",
            ));
        };
        self.refuse_columns(first)?;
        let own = 2.0 * geometry.surface.bounding_radius();
        let row = |row: &PoseRow| Place {
            pose: row.pose,
            velocity: row.velocity.unwrap_or(self.velocity.into()),
            spin: row.spin.unwrap_or(self.spin.into()),
            scale: row.diameter.map_or(1.0, |d| d / own) * row.scale.unwrap_or(1.0),
        };
        Ok(rows.iter().map(row).collect())
    }

    /// Refuses columns that contradict keys, and sizes that are given neither by columns nor by keys.
    fn refuse_columns(&self, row: &PoseRow) -> Result<(), Error> {
        let size = self.diameter.or(self.size);
        let scaled = row.diameter.is_some() || row.scale.is_some();
        let moves = row.velocity.is_some() || row.spin.is_some();
        let refusals = [
            (
                row.diameter.is_some() && size.is_some(),
                "with a column d",
                "that is the diameter of each body: leave diameter and size out, or name the column otherwise",
            ),
            (
                row.diameter.is_none() && size.is_none() && self.is_parametric(),
                "without a column d",
                "give the diameter or the size of the shape, or a column d in m",
            ),
            (
                scaled && self.behaviour.is_meshed(),
                "with a column d or scale",
                "deformable bodies of one [[body]] have one size: leave the column out",
            ),
            (
                moves && self.motion.is_some(),
                "with velocities",
                "a body with a motion moves by that alone: leave the columns out",
            ),
            (
                row.velocity.is_some() && self.velocity != [0.0; 3],
                "with columns vx, vy, vz",
                "leave them or velocity out",
            ),
            (
                row.spin.is_some() && self.spin != [0.0; 3],
                "with columns wx, wy, wz",
                "leave them or spin out",
            ),
        ];
        match refusals.iter().find(|(is_so, ..)| *is_so) {
            Some((_, value, allowed)) => Err(wrong("poses", value, allowed)),
            None => Ok(()),
        }
    }
}

/// The rows of a table of poses; of a table with several shapes those of the shape of that name.
fn rows_of(path: &Path, name: &str) -> Result<Vec<PoseRow>, Error> {
    let mut rows = read_poses(path)?;
    let shapes: BTreeSet<String> = rows.iter().filter_map(|row| row.shape.clone()).collect();
    if shapes.len() < 2 {
        return Ok(rows);
    }
    let file = format!("{name}.obj");
    let is_own = |shape: &str| shape == name || shape_file_name(shape) == file;
    rows.retain(|row| row.shape.as_deref().is_some_and(is_own));
    if rows.is_empty() {
        let shapes: Vec<String> = shapes.into_iter().collect();
        return Err(Error::Unknown {
            name: "shape",
            value: name.to_owned(),
            known: format!(
                "the shapes in {}, which has several: {}",
                path.display(),
                shapes.join(", ")
            ),
        });
    }
    Ok(rows)
}
