//! The general kernel: bodies of any shape, as tetrahedra with a nodal field, and rigid walls of
//! any shape.
//!
//! ```
//! use femdem_contact::general::GeneralScratch;
//! use femdem_contact::{Field, FieldMesh, Frame, GeneralKernel};
//! use femdem_mesh::{TetMesh, Vector3, catalogue::{CatalogueShape, Solid}};
//!
//! // Two cubes of side 1 m, face on face, 1 mm into each other.
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(3_f64.sqrt())?;
//! let mesh = TetMesh::centroid_fan(&cube)?.refined()?;
//! let body = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body)?;
//! let below = Frame::identity();
//! let above = Frame { position: Vector3::new(0.0, 0.0, 0.999), ..below };
//! let kernel = GeneralKernel::new(1e6)?;
//! let mut scratch = GeneralScratch::default();
//! let patches = kernel.evaluate(&body, &below, &body, &above, &mut scratch);
//! assert_eq!(patches.len(), 1);
//! assert!((patches[0].overlap.force.z / 4000.0 - 1.0).abs() < 3e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How it works
//!
//! The common part P_ij of a tetrahedron i of A and one j of B is a convex polyhedron, cut out and
//! integrated exactly. With the fields' gradients g and values at the centroid c_ij,
//!
//! - U = p Σ V_ij (φ_A,i(c_ij) + φ_B,j(c_ij)), and the force on B is p Σ V_ij (g_B,j - g_A,i),
//!   its moment p Σ V_ij c_ij × (g_B,j - g_A,i). These are the skin integrals of the law (crate docs)
//!   turned into volume integrals by the divergence theorem: φ is 0 on its own skin.
//! - walls have no field: U = 2 p ∫ φ_B dV, the force 2 p Σ V_ij g_B,j.
//!
//! Area, centre of pressure and stiffness come from the polygons of the pieces that lie on a skin, with the
//! same meaning as in the convex kernel. Where faces of A and B coincide, no face is counted twice. Where the
//! energy has a kink (skins that coincide), the force is the mean of both sides.
//!
//! Pieces that touch across faces of tetrahedra form a [`Patch`].
//!
//! # Accuracy
//!
//! - On centroid fans every number of the [`Overlap`](crate::Overlap) agrees with the convex kernel's to
//!   2e-12, the wrench to 1e-12 (`tests/general.rs`). A mesh of a plane agrees with that wall to 1e-10.
//! - Force and torque are minus the gradient of U to 1e-7 for both fields, bodies that are
//!   not convex, and poses in which faces, edges or corners coincide (`tests/general_gradient.rs`).
//! - A corner sliding over a flat side feels the [`Field::Body`] field to 1e-9 as if there were no
//!   mesh, more than one tetrahedron from the side's edges (`tests/general_sliding.rs`).

mod assemble;
mod cache;
mod kernel;
mod mesh;
mod patch;
mod pieces;
mod skins;
mod sums;
mod wall;

pub use cache::GeneralCache;
pub use kernel::{GeneralKernel, GeneralScratch};
pub(crate) use mesh::gauge;
pub use mesh::{Field, FieldMesh};
pub use patch::Patch;
pub use wall::SolidWall;
