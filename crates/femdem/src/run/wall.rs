//! Walls of a scenario.

use std::path::{Path, PathBuf};

use femdem_contact::{MaterialId, MeshWall, Wall, WallShape};
use femdem_mesh::tet::{self, MeshOptions};
use femdem_mesh::{Point3, Vector3};
use femdem_solve::World;
use serde::{Deserialize, Serialize};

use super::revolved::Revolved;
use super::{
    ConeEntry, ControlEntry, CylinderEntry, HopperEntry, MotionEntry, PlateEntry, SiloEntry,
};
use crate::Error;
use crate::error::wrong;
use crate::scene::{ShapeNote, Unit, in_metres, surface};

/// A wall, described by exactly one of `plane`, `box`, `cylinder`, `cone`, `silo`, `hopper`, `plate` and `file`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct WallEntry {
    /// Name, as it appears in results; empty: by its number.
    pub name: String,
    /// A half-space.
    pub plane: Option<PlaneEntry>,
    /// A box around the space for the bodies; its walls are called by the name and x-, x+, and so on.
    pub r#box: Option<BoxEntry>,
    /// An upright cylinder about the z axis, or one between two points.
    pub cylinder: Option<CylinderEntry>,
    /// A cone between two points.
    pub cone: Option<ConeEntry>,
    /// An upright silo or hopper.
    pub silo: Option<SiloEntry>,
    /// A bin of rectangular section with a hopper below.
    pub hopper: Option<HopperEntry>,
    /// A round plate.
    pub plate: Option<PlateEntry>,
    /// Surface file of a solid.
    pub file: Option<PathBuf>,
    /// Unit of the coordinates in the file.
    pub unit: Unit,
    /// Whether small faults of the file are mended.
    pub repair: bool,
    /// Material, by name, by which contacts find the laws of pairs. `None`: one of which no pair is.
    pub material: Option<String>,
    /// Prescribed motion.
    pub motion: Option<MotionEntry>,
    /// A force, a stress or a rate of strain that the wall is moved to reach.
    pub control: Option<ControlEntry>,
    /// When the wall is taken away \[s\]. `None`: never.
    pub opens: Option<f64>,
}

/// A half-space of bodies: n·x ≥ offset |n|.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PlaneEntry {
    /// Normal n into the space for the bodies, of any length.
    pub normal: [f64; 3],
    /// Distance of the plane from the origin along the normal, whatever the length of that \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub offset: f64,
}

/// The space in a box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct BoxEntry {
    /// Lowest corner \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub lower: [f64; 3],
    /// Highest corner \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub upper: [f64; 3],
    /// Whether it has no lid.
    #[serde(default)]
    pub open: bool,
}

impl WallEntry {
    /// Adds the wall, or the walls of a box, to a world, and returns how its file was read, if it has one; `name` is
    /// that of the entry. Its control and the time at which it opens are of a simulation, not of a world.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key at fault, and those of the file.
    pub fn add_to(
        &self,
        name: &str,
        material: MaterialId,
        world: &mut World,
    ) -> Result<Option<ShapeNote>, Error> {
        let drive = self.motion.map(|motion| motion.drive()).unwrap_or_default();
        let (shapes, note) = self.shapes(name)?;
        for shape in shapes {
            let wall = world.add_wall(shape, drive)?;
            world.set_wall_material(wall, material)?;
        }
        Ok(note)
    }

    /// The wall, or the walls of a box, where they stand at first, and how its file was read, if it has one; `name` is that of
    /// the entry.
    ///
    /// # Errors
    ///
    /// As [`add_to`](Self::add_to).
    pub fn shapes(&self, name: &str) -> Result<(Vec<WallShape>, Option<ShapeNote>), Error> {
        self.refuse_strangers()?;
        if self.kinds() != 1 {
            return Err(wrong(
                "wall",
                "none or several of its kinds",
                "give exactly one of plane, box, cylinder, cone, silo, hopper, plate and file",
            ));
        }
        if let Some(path) = &self.file {
            let (shape, note) = self.of_file(name, path)?;
            return Ok((vec![shape], Some(note)));
        }
        if let Some(space) = &self.r#box {
            let walls = space.walls(name)?;
            return Ok((walls.into_iter().map(WallShape::from).collect(), None));
        }
        let shapes = [
            self.plane.map(|plane| Ok(plane.wall(name)?.into())),
            self.cylinder.map(|cylinder| cylinder.shape(name)),
            self.cone.map(|cone| cone.shape(name)),
            self.silo.map(|silo| silo.shape(name)),
            self.hopper.map(|hopper| hopper.shape(name)),
            self.plate.map(|plate| plate.shape(name)),
        ];
        let shapes: Result<Vec<WallShape>, Error> = shapes.into_iter().flatten().collect();
        Ok((shapes?, None))
    }

    /// How many kinds of walls it describes.
    pub(super) fn kinds(&self) -> usize {
        let given = [
            self.plane.is_some(),
            self.r#box.is_some(),
            self.cylinder.is_some(),
            self.cone.is_some(),
            self.silo.is_some(),
            self.hopper.is_some(),
            self.plate.is_some(),
            self.file.is_some(),
        ];
        given.into_iter().filter(|is_given| *is_given).count()
    }

    /// The edges of a wall of revolution or a hopper in a picture, in the coordinates of the scene; those of an upright cylinder between
    /// two heights.
    pub(super) fn outline(&self, [low, high]: [f64; 2]) -> Vec<[Point3; 2]> {
        let upright = |cylinder: CylinderEntry| CylinderEntry {
            from: cylinder.from.or(Some([0.0, 0.0, low])),
            to: cylinder.to.or(Some([0.0, 0.0, high])),
            ..cylinder
        };
        let revolved = [
            self.cylinder
                .and_then(|entry| upright(entry).revolved().ok()?),
            self.cone.and_then(|entry| entry.revolved("cone.to").ok()),
            self.silo.and_then(|entry| entry.revolved().ok()),
            self.plate.and_then(|entry| entry.revolved().ok()),
        ];
        let each = revolved.iter().flatten();
        let hopper = self.hopper.iter().flat_map(HopperEntry::lines);
        each.flat_map(Revolved::lines).chain(hopper).collect()
    }

    /// Refuses keys that have no effect without a file.
    pub(super) fn refuse_strangers(&self) -> Result<(), Error> {
        if self.file.is_some() {
            return Ok(());
        }
        if self.unit != Unit::default() {
            return Err(wrong(
                "unit",
                "given",
                "give it with a file only: other lengths are in m",
            ));
        }
        if self.repair {
            return Err(wrong(
                "repair",
                "true",
                "give it with a file only: nothing else is mended",
            ));
        }
        Ok(())
    }

    fn of_file(&self, name: &str, path: &Path) -> Result<(WallShape, ShapeNote), Error> {
        let (surface, report) = surface::read(path, self.unit, self.repair)?;
        let (mesh, meshed) = tet::mesh(&surface, &MeshOptions::default())
            .map_err(|problem| surface::in_file(path, problem))?;
        let file = Some((path.to_path_buf(), self.unit, report));
        let note = ShapeNote::new(name.to_owned(), file, &surface, Some(meshed));
        Ok((MeshWall::solid(name, &mesh).into(), note))
    }
}

impl PlaneEntry {
    /// The half-space as a wall.
    pub(super) fn wall(&self, name: &str) -> Result<Wall, Error> {
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
        Ok(Wall::half_space(name, normal, self.offset * length)?)
    }
}

impl BoxEntry {
    /// Its walls.
    pub(super) fn walls(&self, name: &str) -> Result<Vec<Wall>, Error> {
        let walls = Wall::closed_box(Vector3::from(self.lower), Vector3::from(self.upper))?;
        let lid = |wall: &&Wall| wall.planes().iter().any(|p| p.normal.z < -0.5);
        let kept = walls.iter().filter(|wall| !(self.open && lid(wall)));
        let named = |wall: &Wall| {
            let own = Wall::new(&format!("{name} {}", wall.name()), wall.planes().to_vec());
            Ok(own?)
        };
        kept.map(named).collect()
    }
}
