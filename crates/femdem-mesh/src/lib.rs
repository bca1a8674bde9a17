//! femdem-mesh.

mod error;
mod mass;
mod merge;
mod polyhedron;

pub mod catalogue;
mod hull;
pub mod io;
#[cfg(any(test, feature = "proptest"))]
pub mod strategies;

pub use error::MeshError;
pub use hull::convex_hull;
pub use mass::{MassProperties, PrincipalFrame};
pub use nalgebra;
pub use polyhedron::{CONVEXITY_TOLERANCE, PLANARITY_TOLERANCE, Polyhedron};

/// A point \[m\].
pub type Point3 = nalgebra::Point3<f64>;
/// A vector.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A rotation, as a unit quaternion.
pub type Rotation = nalgebra::UnitQuaternion<f64>;
/// A rigid placement: takes body coordinates to world coordinates.
pub type Pose = nalgebra::Isometry3<f64>;
