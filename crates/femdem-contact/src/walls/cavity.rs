//! Rigid walls: half-spaces and convex cavities bounded by planes.

use crate::error::ContactError;
use femdem_mesh::Vector3;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

/// A plane of a wall in the wall's own axes: the free side is n.x >= offset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WallPlane {
    /// Unit normal, pointing into the free space.
    pub normal: Vector3,
    /// n.x on the plane, m.
    pub offset: f64,
}

/// A rigid wall: everything outside the convex free space that its planes bound.
///
/// One plane is a half-space. Several planes are one smooth wall (the faceted mantle of a
/// cylinder): a body touches it in one contact, and where two of its planes meet nothing
/// is counted twice.
///
/// ```
/// use femdem_contact::Wall;
/// use femdem_mesh::Vector3;
///
/// // A ramp that rises along x, and a tube of 1 m with 48 sides, which is one wall.
/// let ramp = Wall::half_space("ramp", Vector3::new(-0.5, 0.0, 1.0), 0.0)?;
/// let tube = Wall::cylinder("tube", 0.5, 48)?;
/// assert_eq!((ramp.planes().len(), tube.planes().len()), (1, 48));
/// // The distance of a point inside from the nearest plane.
/// assert!((tube.clearance(&Vector3::new(0.1, 0.0, 3.0)) - 0.4).abs() < 2e-3);
/// # Ok::<(), femdem_contact::ContactError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    name: String,
    #[serde(deserialize_with = "read_planes")]
    planes: Vec<WallPlane>,
}

/// Squared lengths this near to 1 are those of unit normals to rounding.
const UNIT: f64 = 1e-14;

/// Reads the planes of a wall: as they are, bit for bit, if they are those of a valid one.
fn read_planes<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<WallPlane>, D::Error> {
    let planes = Vec::<WallPlane>::deserialize(from)?;
    let made = Wall::new("read", planes.clone()).map_err(D::Error::custom)?;
    let is_unit = |p: &WallPlane| (p.normal.norm_squared() - 1.0).abs() <= UNIT;
    Ok(if planes.iter().all(is_unit) {
        planes
    } else {
        made.planes
    })
}

impl Wall {
    /// A wall of one or more planes in its own axes; normals are normalised.
    ///
    /// # Errors
    /// [`ContactError::Wall`] without planes, with a zero or non-finite normal, or with
    /// more than 65,535 planes.
    pub fn new(name: &str, planes: Vec<WallPlane>) -> Result<Self, ContactError> {
        let fail = |why: String| ContactError::Wall {
            name: name.to_owned(),
            why,
        };
        if planes.is_empty() || planes.len() > usize::from(u16::MAX) {
            return Err(fail(format!(
                "it has {} planes, but 1 to 65535 are needed",
                planes.len()
            )));
        }
        let mut unit = Vec::with_capacity(planes.len());
        for (i, p) in planes.iter().enumerate() {
            let length = p.normal.norm();
            let usable = length.is_finite() && length > 0.0 && (p.offset / length).is_finite();
            if !usable {
                return Err(fail(format!(
                    "plane {i} has normal {:?} and offset {}; give a finite non-zero normal \
                     that points into the free space and a finite offset in m",
                    p.normal.as_slice(),
                    p.offset
                )));
            }
            unit.push(WallPlane {
                normal: p.normal / length,
                offset: p.offset / length,
            });
        }
        Ok(Self {
            name: name.to_owned(),
            planes: unit,
        })
    }

    /// The half-space whose free side is n.x >= offset.
    ///
    /// # Errors
    /// As [`Wall::new`].
    pub fn half_space(name: &str, normal: Vector3, offset: f64) -> Result<Self, ContactError> {
        Self::new(name, vec![WallPlane { normal, offset }])
    }

    /// The six walls of a closed box from `low` to `high`, named x-, x+, y-, y+, z-, z+.
    ///
    /// # Errors
    /// [`ContactError::Wall`] if a side is not positive and finite.
    pub fn closed_box(low: Vector3, high: Vector3) -> Result<Vec<Self>, ContactError> {
        let mut walls = Vec::with_capacity(6);
        for (k, axis) in ["x", "y", "z"].iter().enumerate() {
            let side = high[k] - low[k];
            if !(side.is_finite() && side > 0.0) {
                return Err(ContactError::Wall {
                    name: format!("box {axis}"),
                    why: format!(
                        "its side from {} to {} m is {side} m; it must be positive and finite",
                        low[k], high[k]
                    ),
                });
            }
            let mut e = Vector3::zeros();
            e[k] = 1.0;
            walls.push(Self::half_space(&format!("{axis}-"), e, low[k])?);
            walls.push(Self::half_space(&format!("{axis}+"), -e, -high[k])?);
        }
        Ok(walls)
    }

    /// The mantle of an upright cylinder about the z axis as one wall of `facets` planes,
    /// each tangent to the circle of `radius`. The cross-section is larger than the
    /// circle's by the factor tan(pi/n) n/pi (0.036 % for 96 facets).
    ///
    /// # Errors
    /// [`ContactError::Wall`] for a radius that is not positive and finite, fewer than
    /// 3 facets or more than 65,535.
    pub fn cylinder(name: &str, radius: f64, facets: usize) -> Result<Self, ContactError> {
        let facets_fit = (3..=usize::from(u16::MAX)).contains(&facets);
        if !(radius.is_finite() && radius > 0.0 && facets_fit) {
            return Err(ContactError::Wall {
                name: name.to_owned(),
                why: format!(
                    "radius {radius} m with {facets} facets; the radius must be positive and \
                     finite, and 3 to 65535 facets are needed"
                ),
            });
        }
        let planes = (0..facets)
            .map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / facets as f64;
                WallPlane {
                    normal: -Vector3::new(angle.cos(), angle.sin(), 0.0),
                    offset: -radius,
                }
            })
            .collect();
        Self::new(name, planes)
    }

    /// The wall's name, as it appears in results.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The planes, in the wall's axes.
    pub fn planes(&self) -> &[WallPlane] {
        &self.planes
    }

    /// Signed distance of a point in the wall's axes from the free space's boundary, m:
    /// positive inside the free space. A lower bound of the distance.
    pub fn clearance(&self, x: &Vector3) -> f64 {
        self.planes
            .iter()
            .map(|p| p.normal.dot(x) - p.offset)
            .fold(f64::INFINITY, f64::min)
    }
}
