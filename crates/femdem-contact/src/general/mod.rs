//! The general kernel: bodies of any shape, as tetrahedra with a nodal field, and rigid walls of
//! any shape.
//!
//! ```
//! use femdem_contact::general::GeneralScratch;
//! use femdem_contact::{Field, FieldMesh, Form, Frame, GeneralKernel};
//! use femdem_mesh::{TetMesh, Vector3, catalogue::{CatalogueShape, Solid}};
//!
//! // Two cubes of side 1 m, face on face, 1 mm into each other.
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(3_f64.sqrt())?;
//! let mesh = TetMesh::centroid_fan(&cube)?.refined()?;
//! let body = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body)?;
//! let below = Frame::identity();
//! let above = Frame { position: Vector3::new(0.0, 0.0, 0.999), ..below };
//! let kernel = GeneralKernel::new(1e6, Form::Sum)?;
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
//! - sum form: U = p Σ V_ij (φ_A,i(c_ij) + φ_B,j(c_ij)), and the force on B is p Σ V_ij (g_B,j - g_A,i),
//!   its moment p Σ V_ij c_ij × (g_B,j - g_A,i). These are the skin integrals of the law (crate docs)
//!   turned into volume integrals by the divergence theorem: φ is 0 on its own skin.
//! - min form: every piece is cut once more where φ_A = φ_B; the force on B is p Σ V g_B over the
//!   parts where φ_B is the lower one. Equal bodies are four times softer than in the sum form.
//! - walls have no field: U = 2 p ∫ φ_B dV, the force 2 p Σ V_ij g_B,j (min form: p in place of 2 p, in
//!   series with a rigid wall).
//!
//! Area, centre of pressure and stiffness come from the polygons of the pieces that lie on a skin (min form:
//! on the contact surface), with the same meaning as in the convex kernel. Where faces of A and B coincide,
//! no face is counted twice. Where the energy has a kink (skins that coincide, fields that are equal in some
//! volume), the force is the mean of both sides.
//!
//! Pieces that touch across faces of tetrahedra form a [`Patch`].
//!
//! # Accuracy
//!
//! - On centroid fans every number of the [`Overlap`](crate::Overlap) agrees with the convex kernel's to
//!   2e-12, the wrench to 1e-12 (`tests/general.rs`). A mesh of a plane agrees with that wall to 1e-10.
//! - Force and torque are minus the gradient of U to 1e-7 for all fields and forms, bodies that are
//!   not convex, and poses in which faces, edges or corners coincide (`tests/general_gradient.rs`).
//! - A corner sliding over a flat side feels the [`Field::Body`] field to 1e-9 as if there were no
//!   mesh, more than one tetrahedron from the side's edges; with [`Field::Classic`] the normal force
//!   varies by 22 to 160 % and up to a third of it points sideways (`tests/general_sliding.rs`).
//!
//! # The shaped form
//!
//! [`Form::Shaped`], U = E J^1.5 / V with J = ∫ (h_A φ_A + h_B φ_B) dV, makes faces softer and corners
//! stiffer, and so promises longer steps. It is an option for single contacts only:
//!
//! - **Its stiffness is unbounded where side faces coincide.** The overlap volume has a kink where the side
//!   of one body slides past the side of the other: moved either way, V falls, and U rises with it, by (U/V)
//!   times the area of the sides in contact. For cubes of side a stacked flush, δ deep, the sideways force
//!   jumps by 2 E δ^2. If they are tilted by θ, it does so within δ θ: a stiffness of 2 E δ/θ, compared with
//!   the face's 2 E a. `tests/general_shaped.rs` finds just that, down to θ = 1e-5. The largest eigenvalue of
//!   the Hessian in 30,000 random poses of two nearly aligned cubes was 1,000 times that of faces, where the
//!   sum form stays within its own. No step chosen from the stiffness of faces is safe then, and deeper
//!   contacts are worse in proportion. This is the likely cause of stacks that explode at 0.27 √(m/k).
//! - The vanishing volume is not the cause: a corner's stiffness falls with its depth, and what is cut off
//!   below the least volume (1e-12 h^3) is negligible.
//! - Where the field is below two thirds of its mean, the traction (U/V) (1.5 h φ/(J/V) - 1) is tensile.
//! - U is not a sum over patches. All patches of a pair share one J and V, so the patches attract or repel
//!   each other.
//! - [`Foundation::stiffness`](crate::Foundation::stiffness) contains only the part of faces.
//!
//! The sum form has none of these defects, and is the default.

mod assemble;
pub(crate) mod cache;
pub(crate) mod cells;
mod kernel;
mod mesh;
pub(crate) mod near_list;
mod patch;
pub(crate) mod piece;
pub(crate) mod pieces;
pub(crate) mod posed;
mod skin_path;
pub(crate) mod sums;
mod wall;

pub use cache::GeneralCache;
pub use kernel::{Form, GeneralKernel, GeneralScratch};
pub(crate) use mesh::gauge;
pub use mesh::{Field, FieldMesh};
pub use patch::Patch;
pub use skin_path::{SkinPath, SkinWrench};
pub use wall::SolidWall;
