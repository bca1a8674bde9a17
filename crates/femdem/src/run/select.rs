//! Parts of a body in a scenario, in the coordinates of its shape.

use femdem_fem::Selection;
use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::error::wrong;
use crate::scene::in_metres;

/// Nodes of a deformable body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum SelectEntry {
    /// All nodes.
    All,
    /// The nodes of the skin.
    Skin,
    /// These nodes, by number.
    Nodes(Vec<u32>),
    /// Those in a box, its sides included.
    Box {
        /// Lowest corner \[m\].
        #[serde(deserialize_with = "in_metres")]
        lower: [f64; 3],
        /// Highest corner \[m\].
        #[serde(deserialize_with = "in_metres")]
        upper: [f64; 3],
    },
    /// Those near the plane n·x = offset.
    Plane {
        /// Direction n, of any length.
        normal: [f64; 3],
        /// Distance of the plane from the origin along n \[m\].
        #[serde(default, deserialize_with = "in_metres")]
        offset: f64,
        /// Largest distance from the plane \[m\]; a millionth of the body's radius if left out.
        #[serde(default, deserialize_with = "in_metres")]
        tolerance: Option<f64>,
    },
    /// Those in a ball, its surface included.
    Sphere {
        /// Centre \[m\].
        #[serde(default, deserialize_with = "in_metres")]
        centre: [f64; 3],
        /// Radius \[m\].
        #[serde(deserialize_with = "in_metres")]
        radius: f64,
    },
}

impl SelectEntry {
    /// The selection, in a body with this radius \[m\].
    pub(super) fn selection(&self, body_radius: f64) -> Selection {
        match self {
            Self::All => Selection::All,
            Self::Skin => Selection::Skin,
            Self::Nodes(nodes) => Selection::Nodes(nodes.clone()),
            Self::Box { lower, upper } => Selection::Box {
                lower: Vector3::from(*lower),
                upper: Vector3::from(*upper),
            },
            Self::Plane {
                normal,
                offset,
                tolerance,
            } => Selection::Plane {
                normal: Vector3::from(*normal),
                offset: *offset,
                tolerance: tolerance.unwrap_or(1e-6 * body_radius),
            },
            Self::Sphere { centre, radius } => Selection::Sphere {
                centre: Vector3::from(*centre),
                radius: *radius,
            },
        }
    }
}

/// A part of a body made of another material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RegionEntry {
    /// Its material, by name.
    pub material: String,
    /// Where it is: it consists of the tetrahedra whose centroids lie there.
    pub within: Zone,
}

/// A part of space, in the coordinates of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub enum Zone {
    /// A box.
    Box {
        /// Lowest corner \[m\].
        #[serde(deserialize_with = "in_metres")]
        lower: [f64; 3],
        /// Highest corner \[m\].
        #[serde(deserialize_with = "in_metres")]
        upper: [f64; 3],
    },
    /// The half-space n·x ≥ offset.
    HalfSpace {
        /// Direction n, of any length.
        normal: [f64; 3],
        /// Distance of its plane from the origin along n \[m\].
        #[serde(default, deserialize_with = "in_metres")]
        offset: f64,
    },
    /// A ball.
    Sphere {
        /// Centre \[m\].
        #[serde(default, deserialize_with = "in_metres")]
        centre: [f64; 3],
        /// Radius \[m\].
        #[serde(deserialize_with = "in_metres")]
        radius: f64,
    },
}

impl Zone {
    /// Refuses a half-space without a direction.
    pub(super) fn check(&self) -> Result<(), Error> {
        match self {
            Self::HalfSpace { normal, .. } if Vector3::from(*normal).norm() == 0.0 => Err(wrong(
                "region.within.half-space.normal",
                "zero",
                "a direction of a length above zero",
            )),
            _ => Ok(()),
        }
    }

    pub(super) fn holds(&self, point: &Point3) -> bool {
        match self {
            Self::Box { lower, upper } => {
                (0..3).all(|k| point[k] >= lower[k] && point[k] <= upper[k])
            }
            Self::HalfSpace { normal, offset } => {
                let normal = Vector3::from(*normal);
                normal.dot(&point.coords) >= offset * normal.norm()
            }
            Self::Sphere { centre, radius } => {
                (point.coords - Vector3::from(*centre)).norm() <= *radius
            }
        }
    }
}
