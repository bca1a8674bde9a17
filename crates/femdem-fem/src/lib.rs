//! Deformable bodies by finite elements: materials at finite strain, elements, the constant data of a body
//! ([`DeformableModel`]), boundary conditions, tangents and static solvers. It knows no contact.
//!
//! **Use it** for single bodies, integrated explicitly ([`DeformableBody`]) or brought to rest ([`statics`]), and
//! as the elastic part of a code of your own. **Do not use it** for bodies that touch (`femdem-solve` steps many with
//! contacts), for shells or beams.
//!
//! ```
//! use femdem_fem::element::Element;
//! use femdem_fem::material::NeoHookean;
//! use femdem_fem::{DeformableModel, MaterialRegion, Workspace};
//! use femdem_mesh::{TetMesh, Vector3};
//!
//! let mesh = TetMesh::block([4, 1, 1], &Vector3::new(0.4, 0.1, 0.1))?;
//! let rubber = MaterialRegion { material: NeoHookean::new(1e6, 0.3)?.into(), density: 1000.0 };
//! let model = DeformableModel::new(&mesh, Element::T10, vec![rubber], None)?;
//!
//! // Stretched by 10 %: the energy is about E e^2 V / 2 and more, as the sides are held.
//! let x: Vec<Vector3> = model.nodes().iter().map(|x| Vector3::new(1.1 * x.x, x.y, x.z)).collect();
//! let v = vec![Vector3::zeros(); x.len()];
//! let mut forces = v.clone();
//! let state = model.internal_forces(&x, &v, &[], &mut [], &mut forces, &mut Workspace::default())?;
//! assert!(state.energy > 20.0 && state.energy < 30.0);
//! # Ok::<(), femdem_fem::FemError>(())
//! ```
//!
//! # What is here
//!
//! - [`material`]: constitutive laws behind one trait, and how to add one. [`element`]: which elements there are.
//! - [`DeformableModel`]: reference nodes, elements, materials, lumped masses; returns forces, stresses, tangents and
//!   a bound of the highest frequency for any positions of the nodes.
//! - [`Boundary`]: held and driven nodes, forces and pressures; [`Selection`] and [`NodeSets`] choose nodes;
//!   [`Drive`] prescribes a motion in time.
//! - [`fracture`]: where and when a brittle body cracks.
//! - [`statics`]: equilibrium of a single body by Newton's method.
//! - `free_body`, with the feature `implicit`: stresses of a free body under given forces, by a linear solve.
//!
//! # Units
//!
//! SI: m, kg, s, N, J, Pa; angles in rad.
//!
//! # Features
//!
//! - `parallel` (default): the work for each element on the caller's rayon pool
//!   ([`DeformableModel::internal_forces_parallel`]); the same bits without it.
//! - `implicit`: sparse Cholesky factorisation ([`statics::Linear::Cholesky`], `free_body`), which adds the dependency faer.
//!
//! # Accuracy
//!
//! Forces are minus the exact gradient of the energy, including F-bar and averaged pressures. Rigid motion
//! gives forces of rounding size (1e-12 of E times an area), however far the body is from the origin.

mod drive;
pub mod element;
mod error;
pub mod fracture;
#[cfg(feature = "implicit")]
pub mod free_body;
pub mod material;
mod model;
pub mod statics;

pub use femdem_mesh as mesh;

pub use drive::{Drive, Driven};
pub use error::FemError;
pub use model::{
    BodyLedger, Boundary, Curve, DeformableBody, DeformableModel, DeformableState, ElementStress,
    FrequencyBound, InternalState, MaterialRegion, NodeSets, Selection, Workspace, von_mises,
};
