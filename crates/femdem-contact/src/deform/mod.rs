//! Contact of deformable bodies with each other, with rigid bodies and with walls.
//!
//! ```
//! use femdem_contact::deform::{
//!     DeformableKernel, DeformableScratch, DeformableShape, Modulus, Operand,
//! };
//! use femdem_mesh::{TetMesh, Vector3, catalogue::{CatalogueShape, Solid}};
//!
//! // Two cubes of side 1 m, face on face, 1 mm into each other.
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(3_f64.sqrt())?;
//! let mesh = TetMesh::centroid_fan(&cube)?.refined()?;
//! let shape = DeformableShape::new(&mesh)?;
//! let below: Vec<Vector3> = mesh.points().iter().map(|p| p.coords).collect();
//! let above: Vec<Vector3> = below.iter().map(|x| x + Vector3::z() * 0.999).collect();
//! let kernel = DeformableKernel::default();
//! let [a, b] = [&below, &above].map(|x| (Operand::Deformable(&shape, x), Modulus::Penalty(1e6)));
//! let contact = kernel.evaluate(a, b, &mut DeformableScratch::default())?;
//! let contact = contact.ok_or("the cubes overlap")?;
//! // F = p a delta (1/h_A + 1/h_B), with a = 1 m^2, delta = 1 mm and h = 0.5 m.
//! assert!((contact.wrenches[1].force.z / 4000.0 - 1.0).abs() < 3e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How it works
//!
//! A [`DeformableShape`] is a mesh of linear tetrahedra with a nodal field φ that is fixed in the material: 0
//! on the skin, growing with the distance to it in the reference state. The contact energy is that of the
//! [general kernel](crate::general), for the bodies in their current shape,
//!
//! U = ∫ (p_A φ_A + p_B φ_B) dV over the overlap,
//!
//! and the force on node a of A is minus its derivative. With N_a its shape function, over B's skin in A and A's
//! skin in B (normals outwards), and over A's tetrahedra i,
//!
//! f_a = ∫_B p_A φ_A N_a n dS - ∫_A p_B φ_B N_a n dS - Σ_i I_i grad N_a,  I_i = ∫ p_A φ_A dV over the part of i in B.
//!
//! For this, only triangles of skin are cut by tetrahedra. I_i, of which the energy is the sum, is the flux
//! of a field through the same polygons: with g = 1 - N_k, (x - x_k)(1/3 - g/4 - 1/(12 g³)) has the
//! divergence N_k, lies in the faces at x_k and is zero on the fourth. The last term sums to zero over the
//! nodes of a tetrahedron. Classic codes omit a term like it; their forces derive from no energy.
//!
//! Instead, the common parts of tetrahedra are cut out for pairs in which round-off would decide which
//! tetrahedron a skin belongs to (it lies in a face inside the other body). With V and c the volume and the
//! centroid of one part, and g = grad (p φ), f_a = Σ V [(g_A - g_B) N_a(c) - p_B φ_B(c) grad N_a]. Both ways
//! agree to 1e-11.
//!
//! - **Stiffness**: see [`Modulus`]. Walls have no field; they act as the body's mirror image, U = 4 ∫ p_B
//!   φ_B dV, or as against rigid bodies, 2 ∫ p_B φ_B dV: see [`WallResponse`](crate::WallResponse). A rigid body
//!   has a field, and acts like any other partner.
//! - **Friction**: a spring for each triangle of the finer skin in contact, with its own normal force (the pressure
//!   on it and on what lies in front of it), stiffness and bound. Its ends are points of both materials,
//!   which follow the centre of pressure. A triangle newly in contact takes over the stretch of its
//!   neighbours, as far as the energy of vanished springs allows.
//! - **Patches**: where two bodies touch in several places, each is a contact with a dashpot of its own, and with its
//!   own record; they share the energy of the pair as linear springs do.
//! - **Contact with itself** ([`ContactBatch::set_self_contact`](crate::ContactBatch::set_self_contact)): U = ∫ p φ (m - 1) dV over the body, where m parts of
//!   it lie at the same place, summed over common parts of its tetrahedra; those with a common node overlap only where
//!   the skin folds over at it.
//! - **Damping**: all elastic forces of a patch are scaled by 1 + 2 ζ (dU/dt)/(√(2U) √(Σ |f_a|²/m_a)) ≥ 0,
//!   where rigid bodies enter the sum with their inertia. For motion along the forces the restitution is that
//!   of [`restitution`](crate::restitution). A body that is stiff compared with its contacts is damped with all
//!   of its mass, if its frequency is known ([`ContactBatch::set_frequency`](crate::ContactBatch::set_frequency)). Rocking is damped by a moment
//!   against the rotation of the bodies as a whole, with the rocking stiffness of the patch and the same ζ.
//! - **Step**: every node gets the sum of w S N_a(c) over the polygons of skin in contact (w the stiffness
//!   per area, S the area, c the centroid), and its share of the tangential springs. Twice the largest of
//!   these over the masses bounds the largest eigenvalue (it is 1.5 to 2.3 times it: `tests/deform_gradient.rs`).
//!
//! # Accuracy
//!
//! - Nodal forces on both sides and the wrench of a rigid partner agree with central differences of U to 1e-8
//!   of the largest, for strongly deformed bodies, convex and not, linear and quadratic
//!   (`tests/deform_gradient.rs`; 6e-11 is seen). The wrench of an undeformed body agrees with the general
//!   kernel's to 1e-12.
//! - Forces balance to round-off, friction and damping included.
//! - Friction of flat blocks (`tests/deform_friction.rs`): under a common rigid motion of the pair the force
//!   rotates with it to 1e-10. Slip to and fro dissipates the energy of Coulomb's law to 0.2 %. Sliding over
//!   meshes of many elements, the force is within 0.3 % of μ F. Shaking by a fifth of the load costs 0.03 %
//!   of a sticking force in 200 shakes. At the rim single triangles slip early: a closed path of stick loses
//!   up to 1e-5 of force times path length on meshes, nothing on planes.
//! - Restitution of an impact along the forces: within 2 % of the formula.
//! - The lips of a crack in a body have the forces of two bodies to 1e-9 (`tests/deform_itself.rs`).
//! - Sums over skins and over common parts agree to 1e-11, in random poses and where faces or nodes of one
//!   body lie in skins of the other (`tests/deform_skins.rs`).
//! - Cost: 0.6 to 0.9 µs per pair of tetrahedra in which the skin of one lies inside the other, everything
//!   included. That is 60 to 70 % of the cost of sums over common parts. Bodies that
//!   touch nothing cost 1 to 2 ns per tetrahedron and step. Light contacts of boulders have 10 to 20 such
//!   pairs each.
//! - A quadratic tetrahedron is treated as eight linear ones; curved faces are replaced by the triangles of
//!   their nodes.

mod add_up;
mod batch;
mod body_dashpot;
mod bristle;
mod folds;
mod itself;
mod kernel;
mod near;
mod operand;
mod outcome;
mod pair;
mod parts;
mod patches;
mod record;
mod respond;
mod rub;
mod scratch;
mod shape;
mod side;
mod skins;
mod sums;
mod turning;
mod walk;

pub use batch::FragmentShape;
pub(crate) use batch::{Around, DeformablePart, Sleep, SoftBody, SoftPair};
pub use kernel::{DeformableKernel, DeformableOverlap, NodeForce};
pub use operand::Operand;
pub use record::{DeformableTotals, NodalLoads, NodalState};
pub use scratch::DeformableScratch;
pub use shape::{DeformableShape, Modulus};
pub(crate) use side::Side;
