//! Polyhedra, the catalogue of Platonic and Archimedean solids, mass properties and surface files.
//!
//! For programs that simulate or analyse bodies of polyhedral shape: a [`Polyhedron`] is a closed, oriented
//! surface that has been checked, with its planes, convexity, volume, centroid and inertia computed once. The
//! crate contains no physics. It is not for editing meshes, Boolean operations, remeshing, or open surfaces.
//!
//! ```
//! use femdem_mesh::catalogue::{CatalogueShape, Solid};
//! use femdem_mesh::{Point3, convex_hull, io};
//!
//! // A truncated dodecahedron in a sphere of 20 mm diameter.
//! let body = CatalogueShape::from(Solid::A10).polyhedron(0.02)?;
//! assert!(body.is_convex());
//! let mass = body.mass_properties();
//! println!("{:.3e} m^3, {:.3e} m^5", mass.volume, mass.inertia[(0, 0)]);
//!
//! // A body of one's own, written as OBJ and read back.
//! let corners = [[0., 0., 0.], [3., 0., 0.], [0., 2., 0.], [0., 0., 1.]].map(Point3::from);
//! let wedge = convex_hull(&corners)?;
//! let mut file = Vec::new();
//! io::obj::write(&wedge, &mut file)?;
//! assert_eq!(io::obj::read(&file[..])?, wedge);
//! # Ok::<(), femdem_mesh::MeshError>(())
//! ```
//!
//! # What is here
//!
//! - [`Polyhedron`]: the checked surface; [`MassProperties`], [`PrincipalFrame`].
//! - [`convex_hull`]: the hull of points, with polygon faces.
//! - [`catalogue`]: the 18 solids by identifier, name and diameter, chiral ones in both hands.
//! - [`TetMesh`]: the checked tetrahedral mesh; [`tet`]: fans, refinement and a general mesher.
//! - [`bvh`]: a tree of boxes. [`unit_pose`] and [`checked_pose`]: turn poses from elsewhere into rigid motions.
//! - [`shapes`]: spheres, pellets, boulders, armour units and other bodies with named parameters.
//! - [`io`]: OBJ, STL, OFF and PLY surfaces in and out, Gmsh meshes of tetrahedra, VTU out.
//! - [`repair`]: from loose facets to a body, with errors that name facets, and repair on request.
//! - `strategies`: random rotations, poses and bodies for property tests (feature `proptest`).
//!
//! # Units
//!
//! SI: lengths in m, areas in m^2, volumes in m^3. Inertia is given for a density of 1 kg/m^3, in
//! m^5: times a density it is in kg m^2. Vertices are in body coordinates; a [`Pose`] takes them to
//! world coordinates. Files carry no unit and are read as metres.
//!
//! # Features
//!
//! - `proptest` (off by default): the module `strategies`.
//!
//! # Accuracy
//!
//! - Bounding boxes have diagonals of 1e-30 to 1e30 m, and of at least 1e-9 of the body's distance
//!   from the origin.
//! - Integrals are exact polynomials of the vertices, summed about a point inside the body: the
//!   catalogue's volumes, areas, inertias and inradii agree with reference data to 1e-12.
//! - A face is planar if its vertices lie within [`PLANARITY_TOLERANCE`] of the bounding box's
//!   diagonal from its plane; convexity is judged with [`CONVEXITY_TOLERANCE`].
//! - Hulls decide orientation by exact predicates and resolve features down to 1e-9 of the
//!   diagonal.
//! - The same input gives the same bits in every run; nothing here is parallel.

mod error;
mod mass;
mod merge;
mod periodic;
mod polyhedron;
mod pose;
mod triangle;

pub mod bvh;
pub mod catalogue;
mod hull;
pub mod io;
pub mod repair;
pub mod shapes;
#[cfg(any(test, feature = "proptest"))]
pub mod strategies;
pub mod tet;

pub use error::MeshError;
pub use hull::convex_hull;
pub use mass::{MassProperties, PrincipalFrame};
pub use nalgebra;
pub use periodic::PeriodicCell;
pub use polyhedron::{CONVEXITY_TOLERANCE, PLANARITY_TOLERANCE, Polyhedron};
pub use pose::{checked_pose, unit_pose};
pub use tet::TetMesh;
pub use triangle::closest_point;

/// A point \[m\].
pub type Point3 = nalgebra::Point3<f64>;
/// A vector.
pub type Vector3 = nalgebra::Vector3<f64>;
/// A 3 x 3 matrix.
pub type Matrix3 = nalgebra::Matrix3<f64>;
/// A rotation, as a unit quaternion.
pub type Rotation = nalgebra::UnitQuaternion<f64>;
/// A rigid placement: transforms body coordinates to world coordinates.
pub type Pose = nalgebra::Isometry3<f64>;
