//! Sinks, gauges and sources of a scenario.

use femdem_mesh::Vector3;
use femdem_pack::Grading;
use serde::{Deserialize, Serialize};

use super::state::{Kind, WHOLE};
use crate::Error;
use crate::error::wrong;
use crate::run::geometry::Geometry;
use crate::run::{BodyEntry, BoxEntry, PlaneEntry};
use crate::scene::{Unit, grading, in_metres};

/// Most bodies of a source.
const MOST: u64 = 1_000_000;

/// A place where bodies leave the simulation, or where those that pass are counted: exactly one of `plane` and `box`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct GateEntry {
    /// Name, as it appears in results; empty: by its number.
    pub name: String,
    /// Bodies are beyond it where their centroids have n·x below the offset.
    pub plane: Option<PlaneEntry>,
    /// Bodies are beyond it where their centroids are outside.
    pub r#box: Option<BoxEntry>,
}

/// A source of rigid bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct SourceEntry {
    /// Name, with which those of its bodies begin; empty: by its number.
    pub name: String,
    /// A parametric shape, or the path of a surface file.
    pub shape: String,
    /// Circumscribed diameter \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub diameter: Option<f64>,
    /// Size of a parametric shape by its own measure \[m\], instead of `diameter`.
    #[serde(deserialize_with = "in_metres")]
    pub size: Option<f64>,
    /// Sizes of its bodies with their shares of the mass or a distribution, as in a pack, instead of `diameter` and `size`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sizes: Option<String>,
    /// Sieve curve of its bodies by mass, in the same way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sieve: Option<String>,
    /// Unit of the coordinates in a file.
    pub unit: Unit,
    /// Whether small faults of a surface file are mended.
    pub repair: bool,
    /// Target length of the edges of the tetrahedra of a body that is not convex, in circumscribed diameters.
    pub mesh_size: Option<f64>,
    /// Material, by name.
    pub material: String,
    /// Lowest corner of the box in which centroids are placed \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub lower: [f64; 3],
    /// Highest corner \[m\].
    #[serde(deserialize_with = "in_metres")]
    pub upper: [f64; 3],
    /// Places of the centroids \[m\], one for each body in this order, instead of a box: what a crane does.
    #[serde(deserialize_with = "in_metres")]
    pub places: Vec<[f64; 3]>,
    /// Bodies per second.
    pub rate: Option<f64>,
    /// Mass per second \[kg/s\], instead of `rate`.
    pub mass_rate: Option<f64>,
    /// Number after which it ends.
    pub number: Option<u64>,
    /// Mass \[kg\] that it does not exceed, instead of `number`.
    pub mass: Option<f64>,
    /// When it begins \[s\].
    pub start: f64,
    /// When it ends \[s\].
    pub end: Option<f64>,
    /// Velocity of its bodies when they come \[m/s\].
    pub velocity: [f64; 3],
    /// Seed of places and orientations.
    pub seed: u64,
}

impl GateEntry {
    /// The planes, as unit normals and offsets: a point below any of these is beyond.
    pub(super) fn planes(&self) -> Result<Vec<([f64; 3], f64)>, Error> {
        match (&self.plane, &self.r#box) {
            (Some(plane), None) => {
                let wall = plane.wall("gate")?;
                let each = wall.planes().iter();
                Ok(each.map(|p| (p.normal.into(), p.offset)).collect())
            }
            (None, Some(space)) => {
                let walls = space.walls("gate")?;
                let each = walls.iter().flat_map(|wall| wall.planes());
                Ok(each.map(|p| (p.normal.into(), p.offset)).collect())
            }
            _ => Err(wrong(
                "plane and box",
                "none or both",
                "give exactly one of the two",
            )),
        }
    }
}

impl SourceEntry {
    /// The sizes of its bodies, if they have several.
    pub(super) fn grading(&self) -> Result<Option<Grading>, Error> {
        let grading = grading(self.sizes.as_deref(), self.sieve.as_deref())?;
        if grading.is_some() && self.diameter.or(self.size).is_some() {
            let allowed = "only one of the four";
            return Err(wrong("sizes, sieve, diameter and size", "several", allowed));
        }
        Ok(grading)
    }

    /// The shape of its bodies; of a diameter of 1 m if they have several sizes.
    pub(super) fn geometry(&self, has_sizes: bool) -> Result<Geometry, Error> {
        let body = BodyEntry {
            shape: Some(self.shape.clone()),
            diameter: if has_sizes { Some(1.0) } else { self.diameter },
            size: self.size,
            unit: self.unit,
            repair: self.repair,
            mesh_size: self.mesh_size,
            material: self.material.clone(),
            ..BodyEntry::default()
        };
        body.refuse_strangers()?;
        body.geometry()
    }

    /// Bodies per second, where one has a mass \[kg\].
    pub(super) fn bodies_per_second(&self, mass: f64) -> Result<f64, Error> {
        let (name, value, rate) = match (self.rate, self.mass_rate) {
            (Some(rate), None) => ("rate", rate, rate),
            (None, Some(rate)) => ("mass-rate", rate, rate / mass),
            _ => {
                return Err(wrong(
                    "rate and mass-rate",
                    "none or both",
                    "give exactly one of the two: bodies per second, or kg/s",
                ));
            }
        };
        if rate > 0.0 && rate.is_finite() {
            return Ok(rate);
        }
        Err(wrong(name, &value.to_string(), "a positive, finite number"))
    }

    /// Most bodies of some kinds, by rising size, that come at a rate \[1/s\] in a run of a duration \[s\].
    pub(super) fn most(&self, kinds: &[Kind], rate: f64, duration: f64) -> Result<u64, Error> {
        let smallest = kinds[0].mass;
        if let Some(given) = self
            .mass
            .filter(|given| !(*given >= smallest && given.is_finite()))
        {
            let allowed = "at least the mass of one body, in kg";
            return Err(wrong("mass", &given.to_string(), allowed));
        }
        let limit = match (self.number, self.mass) {
            (Some(_), Some(_)) => {
                let allowed = "give one of the two, or none, with which it goes on to its end";
                return Err(wrong("number and mass", "both", allowed));
            }
            (Some(number), None) => number as f64,
            (None, Some(given)) => given / smallest + WHOLE,
            (None, None) => f64::INFINITY,
        };
        let limit = match self.places.len() {
            0 => limit,
            places => limit.min(places as f64),
        };
        let lasts = self.end.unwrap_or(duration).min(duration) - self.start;
        let most = limit.min(rate * lasts + WHOLE).floor();
        if !(most >= 1.0 && most <= MOST as f64) {
            return Err(wrong(
                "a source",
                &format!("{most} bodies"),
                "1 to 1,000,000: check its rate, number, mass, start and end, and the duration",
            ));
        }
        Ok(most as u64)
    }

    /// Corners of a box around all places \[m\].
    pub(super) fn corners(&self) -> [[f64; 3]; 2] {
        let mut places = self.places.iter();
        let Some(first) = places.next() else {
            return [self.lower, self.upper];
        };
        let around = |[low, high]: [[f64; 3]; 2], place: &[f64; 3]| {
            [
                [0, 1, 2].map(|k| low[k].min(place[k])),
                [0, 1, 2].map(|k| high[k].max(place[k])),
            ]
        };
        places.fold([*first; 2], around)
    }

    /// Refuses a box, places, times and a velocity that cannot be.
    pub(super) fn check(&self) -> Result<(), Error> {
        if self.shape.is_empty() {
            let allowed = "one of the shapes, or the path of a surface file";
            return Err(wrong("shape", "none", allowed));
        }
        if !self.places.is_empty() && [self.lower, self.upper] != [[0.0; 3]; 2] {
            let allowed = "a box for all bodies, or a list of places: leave one out";
            return Err(wrong("lower, upper and places", "both", allowed));
        }
        if !self.places.iter().flatten().all(|x| x.is_finite()) {
            let allowed = "finite numbers, in m";
            return Err(wrong("places", &format!("{:?}", self.places), allowed));
        }
        if let Some(number) = self
            .number
            .filter(|n| !self.places.is_empty() && *n > self.places.len() as u64)
        {
            let allowed = "at most the number of places";
            return Err(wrong("number", &number.to_string(), allowed));
        }
        let sides = Vector3::from(self.upper) - Vector3::from(self.lower);
        if !sides.iter().all(|side| *side >= 0.0 && side.is_finite()) {
            let given = format!("{:?} and {:?}", self.lower, self.upper);
            let allowed = "two corners, in m, none of whose coordinates is higher in `lower`";
            return Err(wrong("lower and upper", &given, allowed));
        }
        let end = self.end.unwrap_or(f64::MAX);
        if !(self.start >= 0.0 && self.start < end && end.is_finite()) {
            let given = format!("{} and {end}", self.start);
            let allowed = "a time from 0 on and a later one, in s";
            return Err(wrong("start and end", &given, allowed));
        }
        if !self.velocity.iter().all(|v| v.is_finite()) {
            let allowed = "three finite numbers, in m/s";
            return Err(wrong("velocity", &format!("{:?}", self.velocity), allowed));
        }
        Ok(())
    }
}
