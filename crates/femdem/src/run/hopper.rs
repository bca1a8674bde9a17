//! Hoppers of rectangular section in a scenario.

use femdem_contact::{MeshWall, WallShape};
use femdem_mesh::tet::RectangularShell;
use femdem_mesh::{Point3, TetMesh, Vector3};
use femdem_view::picture::sides;
use serde::{Deserialize, Serialize};

use super::revolved::{half_angle, height, position, thickness};
use crate::Error;
use crate::error::wrong;
use crate::scene::in_metres;

/// An upright bin of rectangular section with a hopper below: a wedge, where one side of the outlet is that of the bin, or a
/// pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct HopperEntry {
    /// Inner sides of the bin along x and y \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub section: [f64; 2],
    /// Sides of the outlet along x and y \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub outlet: [f64; 2],
    /// Angle with the vertical of the walls that lean more \[degrees\]; 90: a flat bottom.
    pub half_angle: f64,
    /// Height of the bin above the hopper \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub height: f64,
    /// Middle of the outlet \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub position: [f64; 3],
    /// Thickness of the plates \[m\]; `None`: a tenth of the longer side.
    #[serde(default, deserialize_with = "in_metres")]
    pub thickness: Option<f64>,
}

impl HopperEntry {
    /// The wall, by name.
    pub(super) fn shape(&self, name: &str) -> Result<WallShape, Error> {
        let longer = self.section[0].max(self.section[1]);
        let shell = RectangularShell {
            sections: self.sections()?,
            thickness: thickness(self.thickness, longer)?,
        };
        let at = position("hopper.position", self.position)?;
        let mesh = shell.mesh()?;
        let points = mesh.points().iter().map(|p| p + at).collect();
        let mesh = TetMesh::new(points, mesh.tets().to_vec())?;
        Ok(MeshWall::solid(name, &mesh).into())
    }

    /// Sides and heights above the outlet, from below.
    fn sections(&self) -> Result<Vec<[f64; 3]>, Error> {
        height("hopper.height", self.height)?;
        half_angle("hopper.half-angle", self.half_angle)?;
        let [wide, deep] = self.section;
        let [x, y] = self.outlet;
        let narrows = [wide - x, deep - y];
        let most = narrows[0].max(narrows[1]);
        if !(x > 0.0 && y > 0.0 && narrows[0] >= 0.0 && narrows[1] >= 0.0 && most > 0.0) {
            let allowed =
                "two positive sides in m, neither longer than that of the section, and one shorter";
            let given = format!("{:?} of {:?}", self.outlet, self.section);
            return Err(wrong("hopper.outlet", &given, allowed));
        }
        if self.half_angle == 90.0 && narrows.contains(&0.0) {
            let allowed =
                "shorter than the section in both directions, for a flat bottom (half-angle = 90)";
            return Err(wrong(
                "hopper.outlet",
                &format!("{:?}", self.outlet),
                allowed,
            ));
        }
        let top = match self.half_angle {
            90.0 => 0.0,
            angle => 0.5 * most / angle.to_radians().tan(),
        };
        let mut sections = vec![[x, y, 0.0], [wide, deep, top]];
        if self.height > 0.0 {
            sections.push([wide, deep, top + self.height]);
        }
        Ok(sections)
    }

    /// The inner edges, for a picture.
    pub(super) fn lines(&self) -> Vec<[Point3; 2]> {
        let at = Vector3::from(self.position);
        let corners = |[x, y, z]: [f64; 3]| {
            let signs = [[1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
            signs.map(|[a, b]| Point3::new(0.5 * a * x, 0.5 * b * y, z) + at)
        };
        let sections = self.sections().unwrap_or_default();
        let rings: Vec<[Point3; 4]> = sections.into_iter().map(corners).collect();
        let along = rings
            .windows(2)
            .flat_map(|pair| [0, 1, 2, 3].map(|k| [pair[0][k], pair[1][k]]));
        rings
            .iter()
            .flat_map(|ring| sides(ring))
            .chain(along)
            .collect()
    }
}
