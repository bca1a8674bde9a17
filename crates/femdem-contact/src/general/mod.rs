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
//! With the fields φ, 0 on the skin of their own body, and outward normals n,
//!
//! - U = p ∫ (φ_A + φ_B) dV over the overlap, the force on B is p ∫ φ_B n dS over A's skin in B less p ∫ φ_A n dS over
//!   B's skin in A, and its moment p ∫ x × φ n dS likewise;
//! - walls have no field: U = 2 p ∫ φ_B dV, and the force 2 p ∫ φ_B n dS over the wall's skin in B.
//!
//! So the skins are enough: their triangles are cut by the tetrahedra of the other body, and every polygon is integrated
//! exactly. The energy and the volume follow from fluxes through the same polygons (`tets/skins.rs`); a node
//! with pressure that lies in the other body adds a share of the tetrahedra around it. Area, centre of pressure and stiffness
//! have the same meaning as in the convex kernel. Skins that coincide carry no pressure, so that it does not matter whether they are
//! counted.
//!
//! Polygons that touch across edges of the skin or across faces of tetrahedra, and polygons of both skins in the same two
//! tetrahedra, form a [`Patch`]. Where there are several, each must be closed and enclose a positive volume, since the
//! boundary of a hole in an overlap is no patch.
//!
//! Where round-off would decide (a skin lies in a face inside the other body, or at a node with pressure), and where the
//! skins do not tell the patches, the common parts P_ij of tetrahedra i of A and j of B are cut out instead
//! ([`GeneralKernel::evaluate_pieces`]). With the fields' gradients g, and values at the centroid c_ij, U = p Σ V_ij
//! (φ_A,i(c_ij) + φ_B,j(c_ij)), the force on B is p Σ V_ij (g_B,j - g_A,i), and its moment p Σ V_ij c_ij × (g_B,j - g_A,i).
//! Parts that touch across faces of tetrahedra form a patch. Where faces of A and B coincide, no face is counted twice, and the
//! force is the mean of both sides of the kink of the energy.
//!
//! # Accuracy
//!
//! - On centroid fans every number of the [`Overlap`](crate::Overlap) agrees with the convex kernel's to
//!   2e-12, the wrench to 1e-12 (`tests/general.rs`). A mesh of a plane agrees with that wall to 1e-10.
//! - Sums over skins and over common parts agree to 1e-11, patch by patch, in random poses and where faces, edges and
//!   corners coincide (`tests/general_skins.rs`).
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
