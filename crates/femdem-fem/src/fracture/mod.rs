//! Where and when a brittle body cracks: strength, its scatter, and the decision which facets of a mesh are cut.
//!
//! A crack opens at a *node*. The stress of a node is the volume mean over the tetrahedra around it. Where it exceeds the
//! [`Strength`], or at the front of a crack the force that the node carries between the tetrahedra on either side of the plane that
//! fails exceeds that of the facets there, the tetrahedra are divided along that plane, and the facets between the two sides are cut, so
//! that the node splits. Under a uniform stress both say the same. At the front the mean, of tetrahedra ahead and behind, is
//! half of what the facets bear, and a crack that has to reach it takes more than its energy. Elsewhere the force would open cracks
//! beside the one that runs, which take energy, too. Criteria on single facets need all of a closed loop of facets about a node to
//! fail, whose worst oriented one sets the strength: in plain tension they ask for a third more than the strength of the material.
//!
//! 1. **Gate.** Nodes none of whose tetrahedra is near failure are not looked at: a body far from it costs one bound per
//!    tetrahedron. Both criteria are convex functions of stress, so a mean fails only if one of its tetrahedra does.
//! 2. **Order.** Nodes that fail are treated by falling ratio of stress to strength, then by number. Beside an open crack,
//!    a node that lies on no cut facet waits until its ratio is 1.15, or one crack would be many parallel ones.
//! 3. **Plane.** In tension normal to the largest principal stress. In shear one of the two planes of Mohr and Coulomb,
//!    whichever is cheaper to cut.
//! 4. **Sides.** A tetrahedron whose centroid is farther than 0.35 h from the plane is on that side (half the farthest
//!    centroid, if that is less); h^3 is six times the mean volume around the node. Without any on one side, as where the
//!    plane is open already, nothing is cut before the ratio is 1.15. The others go where the cut is cheapest, by exact
//!    minimum cut. A facet costs its area times 1 + 1.5 (1 - |n . d|) with n and d the normals of facet and plane; a facet
//!    that is cut already costs nothing, so that cracks continue each other.
//!
//! The decision is a function of its inputs alone, with the same bits in any run.
//!
//! # Sources
//!
//! - Mohr-Coulomb with tension cut-off: J. C. Jaeger, N. G. W. Cook and R. W. Zimmerman, Fundamentals of Rock Mechanics,
//!   4th ed., 2007, sections 4.5 and 4.6.
//! - Scatter: W. Weibull, J. Appl. Mech. 18 (1951) 293-297.
//! - Cracks inserted where stress demands, by facets: G. T. Camacho and M. Ortiz, Int. J. Solids Struct. 33 (1996)
//!   2899-2938; M. Ortiz and A. Pandolfi, Int. J. Numer. Meth. Engng 44 (1999) 1267-1282.
//! - Nodes that split by a tensor: J. F. O'Brien and J. K. Hodgins, SIGGRAPH 1999, 137-146, which cuts elements instead.
//! - Minimum cut: J. Edmonds and R. M. Karp, J. ACM 19 (1972) 248-264.
//!
//! # Limits
//!
//! Forces from outside on a node, and its acceleration, take from what is known of the force between halves, so that nodes which
//! others load, or at the front of a fast crack, fail by their mean stress. A node none of whose tetrahedra uses up 0.9 of its strength
//! is not looked at, whatever the force. Stress that varies over one element, as at a skin or the root of a notch, is seen by its
//! mean. Cracks run along facets, so their path depends on the mesh, and
//! some facets beside a crack are cut that part nothing.
//!
//! ```
//! use femdem_fem::ElementStress;
//! use femdem_fem::fracture::{NodalDecision, Strength, Weibull};
//! use femdem_fem::mesh::tet::CrackedMesh;
//! use femdem_fem::mesh::{Matrix3, TetMesh, Vector3};
//!
//! let bar = TetMesh::block([8, 2, 2], &Vector3::new(0.08, 0.02, 0.02))?;
//! let rock = Strength::new(5e6, 20e6, 0.67)?;
//! let weakest = Weibull::new(12.0, 1e-6, 7)?;
//! let factors = weakest.factors(0, &bar);
//! let positions: Vec<Vector3> = bar.points().iter().map(|p| p.coords).collect();
//! let mut cracked = CrackedMesh::new(&bar);
//!
//! // Uniform tension of 6 MPa along x.
//! let pulled = Matrix3::from_diagonal(&Vector3::new(6e6, 0.0, 0.0));
//! let stresses = vec![ElementStress { cauchy: pulled, volume_ratio: 1.0 }; bar.tets().len()];
//! let decision = NodalDecision {
//!     strengths: &[rock],
//!     regions: &vec![0; bar.tets().len()],
//!     factors: &factors,
//!     positions: &positions,
//!     stresses: &stresses,
//! };
//! let decided = decision.decide(&mut cracked)?;
//! assert!(decided.highest > 1.0 && !decided.splits.is_empty());
//! # Ok::<(), femdem_fem::FemError>(())
//! ```

mod decide;
mod gate;
mod inputs;
mod minimum_cut;
mod node;
mod star;
mod strength;
mod weibull;

pub use decide::{Cut, Decision};
pub use inputs::NodalDecision;
pub use strength::{FailurePlanes, FractureMode, Strength};
pub use weibull::Weibull;
