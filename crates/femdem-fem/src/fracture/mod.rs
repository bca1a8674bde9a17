//! Where and when a material breaks: at the nodes of a mesh.
//!
//! A node inside a mesh is held by some two dozen tetrahedra, and a crack passes it when a closed loop of facets around it is cut.
//! Criteria for single facets are met by the well-directed ones first, and the last and worst of the loop decides: they
//! overestimate strength by a third and more. Here the mean stress around a node decides, and the whole loop is cut at once:
//!
//! 1. The mean of the Cauchy stresses of the tetrahedra around a node, weighted by their volumes, against a [`Strength`], with a factor by
//!    [`Weibull`] where strength scatters.
//! 2. The plane of fracture through the node: across the largest principal stress in tension, one of the two of Mohr and Coulomb
//!    in shear.
//! 3. Tetrahedra well above and below it are on its two sides; those that it passes through go to either such that the facets in between
//!    are cheapest: area (1 + 1.5 (1 − |n·d|)), nothing for facets that are cut already. This is a minimum cut.
//!
//! [`NodalDecision::decide`] does this for a body at one moment. It moves nothing and knows no forces.
//!
//! ```
//! use femdem_fem::ElementStress;
//! use femdem_fem::fracture::{NodalDecision, Strength};
//! use femdem_mesh::tet::CrackedMesh;
//! use femdem_mesh::{Matrix3, TetMesh, Vector3};
//!
//! // A bar under 6 MPa of tension, with a strength of 5 MPa.
//! let bar = TetMesh::block([4, 1, 1], &Vector3::new(0.04, 0.01, 0.01))?;
//! let tension = Matrix3::from_diagonal(&Vector3::new(6e6, 0.0, 0.0));
//! let stresses = vec![ElementStress { cauchy: tension, volume_ratio: 1.0 }; bar.tets().len()];
//! let positions: Vec<Vector3> = bar.points().iter().map(|p| p.coords).collect();
//! let decision = NodalDecision {
//!     strength: &Strength::new(5e6, 20e6, 0.6)?,
//!     factors: &vec![1.0; positions.len()],
//!     positions: &positions,
//!     stresses: &stresses,
//!     volumes: &vec![bar.volume() / bar.tets().len() as f64; bar.tets().len()],
//! };
//! let found = decision.decide(&mut CrackedMesh::new(&bar))?;
//! assert!((found.highest - 1.2).abs() < 1e-12 && !found.splits.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Sources
//!
//! Camacho and Ortiz (1996), Int. J. Solids Struct. 33, 2899, for cracks that are inserted as they open; O'Brien and Hodgins (1999),
//! SIGGRAPH 99, 137, for nodes that split across their largest tension; Weibull (1939), Ing. Vetensk. Akad. Handl. 151.

mod decide;
mod min_cut;
mod strength;
mod weibull;

pub use decide::{Cut, Decision, NodalDecision};
pub use strength::{FractureMode, Strength};
pub use weibull::Weibull;
