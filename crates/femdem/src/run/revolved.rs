//! Walls of revolution in a scenario: tubes, drums, cones, silos and plates.

use femdem_contact::{MeshWall, Wall, WallPlane, WallShape};
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::tet::RevolvedShell;
use femdem_mesh::{Point3, Pose, Rotation, TetMesh, Vector3};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::error::wrong;
use crate::scene::in_metres;

/// Default thickness of the plates, over the largest inner diameter.
const THICKNESS: f64 = 0.1;

/// Corners of a ring and straight lines along it in pictures.
const RING: usize = 48;
const ALONG: usize = 4;

/// Which ends of a tube or a cone are closed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// Neither.
    #[default]
    None,
    /// The one at `from`.
    From,
    /// The one at `to`.
    To,
    /// Both: the wall is the space around a drum then, and has no thickness.
    Both,
}

/// A cylinder: upright about the z axis without ends, or between two points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CylinderEntry {
    /// Inner diameter \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub diameter: f64,
    /// Middle of one end \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub from: Option<[f64; 3]>,
    /// Middle of the other end \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub to: Option<[f64; 3]>,
    /// Which ends are closed.
    #[serde(default)]
    pub ends: Ends,
    /// Thickness of the plates \[m\]; `None`: a tenth of the diameter.
    #[serde(default, deserialize_with = "in_metres")]
    pub thickness: Option<f64>,
    /// Number of plane facets around the axis.
    #[serde(default = "facets")]
    pub facets: u32,
}

/// A cone that is cut off at two points of its axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ConeEntry {
    /// Inner diameters at `from` and `to` \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub diameters: [f64; 2],
    /// Middle of one end \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub from: [f64; 3],
    /// Middle of the other end \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub to: [f64; 3],
    /// Which ends are closed.
    #[serde(default)]
    pub ends: Ends,
    /// Thickness of the plates \[m\]; `None`: a tenth of the larger diameter.
    #[serde(default, deserialize_with = "in_metres")]
    pub thickness: Option<f64>,
    /// Number of plane facets around the axis.
    #[serde(default = "plates")]
    pub facets: u32,
}

/// An upright silo: a hopper with an outlet, and a cylinder on it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SiloEntry {
    /// Inner diameter of the cylinder \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub diameter: f64,
    /// Height of the cylinder \[m\]; 0: a hopper alone.
    #[serde(default, deserialize_with = "in_metres")]
    pub height: f64,
    /// Diameter of the outlet \[m\]; 0 closes it.
    #[serde(deserialize_with = "in_metres")]
    pub outlet: f64,
    /// Angle of the hopper's wall with the vertical \[degrees\]; 90: a flat bottom.
    pub half_angle: f64,
    /// Middle of the outlet \[m\].
    #[serde(default, deserialize_with = "in_metres")]
    pub position: [f64; 3],
    /// Thickness of the plates \[m\]; `None`: a tenth of the diameter.
    #[serde(default, deserialize_with = "in_metres")]
    pub thickness: Option<f64>,
    /// Number of plane facets around the axis.
    #[serde(default = "plates")]
    pub facets: u32,
}

/// A round plate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct PlateEntry {
    /// Diameter \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub diameter: f64,
    /// Middle of the face towards the bodies \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub centre: [f64; 3],
    /// Normal of that face, of any length.
    #[serde(default = "up")]
    pub normal: [f64; 3],
    /// Thickness behind the face \[m\]; `None`: a tenth of the diameter.
    #[serde(default, deserialize_with = "in_metres")]
    pub thickness: Option<f64>,
    /// Number of sides.
    #[serde(default = "plates")]
    pub facets: u32,
}

fn facets() -> u32 {
    64
}

fn plates() -> u32 {
    32
}

fn up() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// A profile (radius, height) \[m\] about an axis, and the plates behind it.
pub(super) struct Revolved {
    profile: Vec<[f64; 2]>,
    /// `None`: the wall is the space around a closed profile.
    thickness: Option<f64>,
    facets: u32,
    /// From the coordinates of the profile, about z, to the world.
    pose: Pose,
}

impl CylinderEntry {
    /// The wall, by name.
    pub(super) fn shape(&self, name: &str) -> Result<WallShape, Error> {
        length("cylinder.diameter", self.diameter)?;
        if let Some(revolved) = self.revolved()? {
            return revolved.shape(name);
        }
        if self.ends != Ends::None || self.thickness.is_some() {
            return Err(wrong(
                "cylinder.ends or thickness",
                "given",
                "for a cylinder between two points only: give from and to as well, or take it out",
            ));
        }
        Ok(Wall::cylinder(name, 0.5 * self.diameter, self.facets as usize)?.into())
    }

    /// The wall between two points, if it is one.
    pub(super) fn revolved(&self) -> Result<Option<Revolved>, Error> {
        let (from, to) = match (self.from, self.to) {
            (None, None) => return Ok(None),
            (Some(from), Some(to)) => (from, to),
            _ => {
                return Err(wrong(
                    "cylinder.from and to",
                    "one of the two",
                    "give both, the middles of the two ends, or neither for an upright one without ends about the z axis",
                ));
            }
        };
        let cone = ConeEntry {
            diameters: [self.diameter; 2],
            from,
            to,
            ends: self.ends,
            thickness: self.thickness,
            facets: self.facets,
        };
        cone.revolved("cylinder.to").map(Some)
    }
}

impl ConeEntry {
    /// The wall, by name.
    pub(super) fn shape(&self, name: &str) -> Result<WallShape, Error> {
        for diameter in self.diameters {
            length("cone.diameters", diameter)?;
        }
        self.revolved("cone.to")?.shape(name)
    }

    /// `end` is the name of the key of the second point.
    pub(super) fn revolved(&self, end: &'static str) -> Result<Revolved, Error> {
        let [from, to] = [self.from, self.to].map(Vector3::from);
        let along = to - from;
        let height = along.norm();
        if !(height > 0.0 && height.is_finite()) {
            let allowed = "a point other than `from`, with finite coordinates in m";
            return Err(wrong(end, &format!("{:?}", self.to), allowed));
        }
        let radii = self.diameters.map(|diameter| 0.5 * diameter);
        let mut profile = vec![[radii[0], 0.0], [radii[1], height]];
        if matches!(self.ends, Ends::From | Ends::Both) {
            profile.insert(0, [0.0, 0.0]);
        }
        if matches!(self.ends, Ends::To | Ends::Both) {
            profile.push([0.0, height]);
        }
        let thickness = match (self.ends, self.thickness) {
            (Ends::Both, Some(thickness)) => {
                let allowed = "none where both ends are closed: all around such a wall is solid";
                return Err(wrong("thickness", &thickness.to_string(), allowed));
            }
            (Ends::Both, None) => None,
            (_, given) => {
                let largest = self.diameters[0].max(self.diameters[1]);
                Some(thickness(given, largest)?)
            }
        };
        Ok(Revolved {
            profile,
            thickness,
            facets: self.facets,
            pose: along_axis(&along, &from),
        })
    }
}

impl SiloEntry {
    /// The wall, by name.
    pub(super) fn shape(&self, name: &str) -> Result<WallShape, Error> {
        self.revolved()?.shape(name)
    }

    pub(super) fn revolved(&self) -> Result<Revolved, Error> {
        length("silo.diameter", self.diameter)?;
        let outlet = self.outlet;
        if !(outlet >= 0.0 && outlet < self.diameter) {
            let allowed = "from 0, which closes it, to less than the diameter, in m";
            return Err(wrong("silo.outlet", &outlet.to_string(), allowed));
        }
        height("silo.height", self.height)?;
        let angle = self.half_angle;
        half_angle("silo.half-angle", angle)?;
        let (low, high) = (0.5 * outlet, 0.5 * self.diameter);
        let top = match angle {
            90.0 => 0.0,
            _ => (high - low) / angle.to_radians().tan(),
        };
        let mut profile = vec![[low, 0.0], [high, top]];
        if self.height > 0.0 {
            profile.push([high, top + self.height]);
        }
        Ok(Revolved {
            profile,
            thickness: Some(thickness(self.thickness, self.diameter)?),
            facets: self.facets,
            pose: along_axis(&Vector3::z(), &position("silo.position", self.position)?),
        })
    }
}

impl PlateEntry {
    /// The wall, by name.
    pub(super) fn shape(&self, name: &str) -> Result<WallShape, Error> {
        self.revolved()?.shape(name)
    }

    pub(super) fn revolved(&self) -> Result<Revolved, Error> {
        length("plate.diameter", self.diameter)?;
        let normal = Vector3::from(self.normal);
        if !(normal.norm() > 0.0 && normal.norm().is_finite()) {
            let allowed = "three finite numbers, not all zero: a direction towards the bodies";
            return Err(wrong(
                "plate.normal",
                &format!("{:?}", self.normal),
                allowed,
            ));
        }
        Ok(Revolved {
            profile: vec![[0.0, 0.0], [0.5 * self.diameter, 0.0]],
            thickness: Some(thickness(self.thickness, self.diameter)?),
            facets: self.facets,
            pose: along_axis(&normal, &position("plate.centre", self.centre)?),
        })
    }
}

impl Revolved {
    fn shape(&self, name: &str) -> Result<WallShape, Error> {
        let Some(thickness) = self.thickness else {
            return self.cavity(name);
        };
        let shell = RevolvedShell {
            profile: self.profile.clone(),
            thickness,
            facets: self.facets,
        };
        let mesh = shell.mesh()?;
        let points = mesh.points().iter().map(|p| self.pose * p).collect();
        let mesh = TetMesh::new(points, mesh.tets().to_vec())?;
        Ok(MeshWall::solid(name, &mesh).into())
    }

    /// The wall around the space of a closed, convex profile, as planes: exact, and much faster than a mesh.
    fn cavity(&self, name: &str) -> Result<WallShape, Error> {
        if !(3..=10_000).contains(&self.facets) {
            return Err(wrong("facets", &self.facets.to_string(), "3 to 10000"));
        }
        let mut planes = Vec::new();
        for pair in self.profile.windows(2) {
            let [[r, z], [dr, dz]] = [pair[0], [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]]];
            let flat = dz == 0.0;
            for k in 0..if flat { 1 } else { self.facets } {
                let angle = std::f64::consts::TAU * f64::from(k) / f64::from(self.facets);
                let out = Vector3::new(angle.cos(), angle.sin(), 0.0);
                let normal = (Vector3::z() * dr - out * dz).normalize();
                let offset = normal.dot(&(out * r + Vector3::z() * z));
                let normal = self.pose * normal;
                planes.push(WallPlane {
                    normal,
                    offset: offset + normal.dot(&self.pose.translation.vector),
                });
            }
        }
        Ok(Wall::new(name, planes)?.into())
    }

    /// Rings at the corners of the profile, and lines along it.
    pub(super) fn lines(&self) -> Vec<[Point3; 2]> {
        let pose = self.pose;
        let at = |[r, z]: [f64; 2], k: usize, of: usize| {
            let angle = std::f64::consts::TAU * k as f64 / of as f64;
            pose * Point3::new(r * angle.cos(), r * angle.sin(), z)
        };
        let wide = self.profile.iter().filter(|[r, _]| *r > 0.0);
        let rings = wide.flat_map(|&corner| {
            (0..RING).map(move |k| [at(corner, k, RING), at(corner, k + 1, RING)])
        });
        let along = self.profile.windows(2).flat_map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            (0..ALONG).map(move |k| [at(a, k, ALONG), at(b, k, ALONG)])
        });
        rings.chain(along).collect()
    }
}

/// The pose that brings the z axis to a direction and the origin to a point.
fn along_axis(axis: &Vector3, origin: &Vector3) -> Pose {
    let half_turn = || Rotation::from_scaled_axis(Vector3::x() * std::f64::consts::PI);
    let turn = Rotation::rotation_between(&Vector3::z(), axis).unwrap_or_else(half_turn);
    Pose::from_parts(Translation3::from(*origin), turn)
}

fn length(name: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let allowed = "a positive, finite length, in m";
    Err(wrong(name, &value.to_string(), allowed))
}

/// Refuses a height of what stands on a hopper.
pub(super) fn height(name: &'static str, value: f64) -> Result<(), Error> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    let allowed = "0, for a hopper alone, or a positive, finite length, in m";
    Err(wrong(name, &value.to_string(), allowed))
}

/// Refuses an angle of a hopper.
pub(super) fn half_angle(name: &'static str, value: f64) -> Result<(), Error> {
    if (1.0..=90.0).contains(&value) {
        return Ok(());
    }
    let allowed = "1 to 90 degrees from the vertical; 90 is a flat bottom";
    Err(wrong(name, &value.to_string(), allowed))
}

pub(super) fn position(name: &'static str, given: [f64; 3]) -> Result<Vector3, Error> {
    if given.iter().all(|x| x.is_finite()) {
        return Ok(given.into());
    }
    let allowed = "three finite coordinates, in m";
    Err(wrong(name, &format!("{given:?}"), allowed))
}

/// The thickness given, or the usual one.
pub(super) fn thickness(given: Option<f64>, diameter: f64) -> Result<f64, Error> {
    let value = given.unwrap_or(THICKNESS * diameter);
    length("thickness", value)?;
    Ok(value)
}
