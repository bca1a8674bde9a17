//! Walls of a scenario.

use std::path::PathBuf;

use femdem_contact::{MeshWall, Wall, WallShape};
use femdem_mesh::tet::{self, MeshOptions};
use femdem_mesh::{Vector3, io};
use femdem_solve::World;
use serde::{Deserialize, Serialize};

use super::MotionEntry;
use super::body::wrong;
use crate::Error;
use crate::scene::Unit;

/// A wall, described by exactly one of `plane`, `box`, `cylinder` and `file`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct WallEntry {
    /// Name, as it appears in results; empty: by its number.
    pub name: String,
    /// A half-space.
    pub plane: Option<PlaneEntry>,
    /// A box around the space for the bodies; its walls are called by the name and x-, x+, and so on.
    pub r#box: Option<BoxEntry>,
    /// An upright cylinder about the z axis.
    pub cylinder: Option<CylinderEntry>,
    /// Surface file of a solid.
    pub file: Option<PathBuf>,
    /// Unit of the coordinates in the file.
    pub unit: Unit,
    /// Prescribed motion.
    pub motion: Option<MotionEntry>,
}

/// A half-space of bodies: n·x ≥ offset |n|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PlaneEntry {
    /// Normal n into the space for the bodies, of any length.
    pub normal: [f64; 3],
    /// Distance of the plane from the origin along the normal, whatever the length of that \[m\].
    #[serde(default)]
    pub offset: f64,
}

/// The space in a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct BoxEntry {
    /// Lowest corner \[m\].
    pub lower: [f64; 3],
    /// Highest corner \[m\].
    pub upper: [f64; 3],
    /// Whether it has no lid.
    #[serde(default)]
    pub open: bool,
}

/// An upright cylinder about the z axis, without ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CylinderEntry {
    /// Inner diameter \[m\].
    pub diameter: f64,
    /// Number of plane facets.
    #[serde(default = "facets")]
    pub facets: usize,
}

fn facets() -> usize {
    64
}

impl WallEntry {
    /// Adds the wall, or the walls of a box, to a world; `name` is that of the entry.
    pub(super) fn add_to(&self, name: &str, world: &mut World) -> Result<(), Error> {
        let drive = self.motion.map(|motion| motion.drive()).unwrap_or_default();
        for shape in self.shapes(name)? {
            world.add_wall(shape, drive)?;
        }
        Ok(())
    }

    /// Number of walls that it is in a world.
    pub(super) fn count(&self) -> Result<u32, Error> {
        match &self.r#box {
            Some(space) => Ok(space.shapes("box")?.len() as u32),
            None => Ok(1),
        }
    }

    fn shapes(&self, name: &str) -> Result<Vec<WallShape>, Error> {
        if self.unit != Unit::default() && self.file.is_none() {
            return Err(wrong(
                "unit",
                "given",
                "give it with a file only: other lengths are in m",
            ));
        }
        match (&self.plane, &self.r#box, &self.cylinder, &self.file) {
            (Some(plane), None, None, None) => Ok(vec![plane.shape(name)?]),
            (None, Some(space), None, None) => space.shapes(name),
            (None, None, Some(cylinder), None) => {
                let diameter = cylinder.diameter;
                if !(diameter > 0.0 && diameter.is_finite()) {
                    let allowed = "a positive, finite length, in m";
                    return Err(wrong("cylinder.diameter", &diameter.to_string(), allowed));
                }
                let wall = Wall::cylinder(name, 0.5 * cylinder.diameter, cylinder.facets)?;
                Ok(vec![wall.into()])
            }
            (None, None, None, Some(path)) => {
                let (surface, _) = io::read_file_with(path, &io::Options::default())?;
                let surface = surface.scaled(self.unit.metres())?;
                let (mesh, _) = tet::mesh(&surface, &MeshOptions::default())?;
                Ok(vec![MeshWall::solid(name, &mesh).into()])
            }
            _ => Err(wrong(
                "wall",
                "none or several of its kinds",
                "give exactly one of plane, box, cylinder and file",
            )),
        }
    }
}

impl PlaneEntry {
    fn shape(&self, name: &str) -> Result<WallShape, Error> {
        let normal = Vector3::from(self.normal);
        let length = normal.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(wrong(
                "plane.normal",
                &format!("{:?}", self.normal),
                "three finite numbers, not all zero: a direction into the space for the bodies",
            ));
        }
        if !self.offset.is_finite() {
            return Err(wrong(
                "plane.offset",
                &self.offset.to_string(),
                "a finite distance from the origin along the normal, in m",
            ));
        }
        // A wall has n·x ≥ offset with n as given.
        Ok(Wall::half_space(name, normal, self.offset * length)?.into())
    }
}

impl BoxEntry {
    fn shapes(&self, name: &str) -> Result<Vec<WallShape>, Error> {
        let walls = Wall::closed_box(Vector3::from(self.lower), Vector3::from(self.upper))?;
        let lid = |wall: &&Wall| wall.planes().iter().any(|p| p.normal.z < -0.5);
        let kept = walls.iter().filter(|wall| !(self.open && lid(wall)));
        let named = |wall: &Wall| {
            let own = Wall::new(&format!("{name} {}", wall.name()), wall.planes().to_vec());
            Ok(own?.into())
        };
        kept.map(named).collect()
    }
}
