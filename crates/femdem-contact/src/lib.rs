//! Contact of polyhedra, convex or not, and of balls: where bodies overlap, the force that pushes them apart, and the
//! friction between them.
//!
//! **Use it** to add contacts of polyhedra and balls, against each other and against walls, to your granular or
//! multibody code. The normal force is the exact gradient of an overlap energy, so it conserves energy for
//! any kind of contact. Bodies may be rigid or deformable ([`deform`]), and exact balls ([`Sphere`]) mix with them.
//! **Do not use it** where nothing may overlap at all (the bodies are penalty bodies), or if you want
//! the bodies integrated for you (femdem-solve does that).
//!
//! ```
//! use femdem_contact::kernel::Scratch;
//! use femdem_contact::{ConvexShape, Frame, PairKernel};
//! use femdem_mesh::{Vector3, catalogue::{CatalogueShape, Solid}};
//!
//! // Two cubes of side 1 m, face on face, 1 mm into each other.
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(3_f64.sqrt())?;
//! let shape = ConvexShape::new(&cube)?;
//! let below = Frame::identity();
//! let above = Frame { position: Vector3::new(0.0, 0.0, 0.999), ..below };
//! let kernel = PairKernel::new(1e6)?;
//! let touch = kernel.evaluate(&shape, &below, &shape, &above, &mut Scratch::default());
//! let touch = touch.ok_or("the cubes overlap")?;
//! // F = p a delta (1/h_A + 1/h_B), with a = 1 m^2, delta = 1 mm and h = 0.5 m.
//! // (Less by a term in delta^2: at the rim the sides are nearer than the face.)
//! assert!((touch.force.z / 4000.0 - 1.0).abs() < 3e-3 && (touch.volume - 1e-3).abs() < 1e-12);
//! assert!((touch.normal - Vector3::z()).norm() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Three layers
//!
//! Take the lowest that does the job.
//!
//! 1. [`PairKernel`]: two prepared shapes, two frames and a penalty in; an [`Overlap`] out (energy, force,
//!    moment, point, area, stiffness). The only state is a scratch buffer and, optionally, a
//!    [`kernel::PairCache`]; the caller owns both. [`kernel::CavityKernel`] does the same for a wall.
//!    [`GeneralKernel`] takes bodies of any shape, as tetrahedra with a field ([`FieldMesh`]), and walls of
//!    any shape ([`SolidWall`]); it gives one overlap for each connected part. For convex bodies it costs
//!    many times as much as [`PairKernel`]. [`SphereKernel`] takes a ball and another, a wall of planes or a convex
//!    polyhedron, in closed form along the radius and, but for spheres and single planes, to rounding along edges.
//! 2. [`ContactBatch`]: many bodies and walls of any kind ([`BodyShape`], [`WallShape`]), each pair
//!    evaluated by the kernel it needs. It finds the pairs, keeps caches and friction history, and turns one
//!    [`Motion`] per body into sorted [`Contact`]s and a [`Load`] per body. Your code integrates; the batch
//!    also bounds the stable step ([`ContactBatch::largest_step`]).
//! 3. `World`, in femdem-solve: owns the bodies and steps them.
//!
//! Vectors, polyhedra and tetrahedra are those of femdem-mesh, which is re-exported as [`mesh`].
//!
//! For deformable bodies, layer 1 is [`deform::DeformableKernel`], and layer 2 the same batch:
//! nodal positions in ([`ContactBatch::update_deformables`]), nodal forces out.
//!
//! # The law
//!
//! - Normal: U = p ∫ (φ_A + φ_B) dV over the overlap, φ = 1 − gauge, and the force is −grad U. For
//!   rigid bodies this is eq. (3) of Xiang, Latham and Farsi (2016). It is integrated exactly, polygon
//!   by polygon.
//! - Walls are rigid and have no field of their own; their penalty is 2 p, so that a face lies on a wall as
//!   stiffly as on an equal face. Against deformable bodies it is 4 p, as if the wall were their mirror image
//!   ([`WallResponse`]).
//! - Damping: a dashpot along grad U whose rate depends on U. Its ratio ζ alone sets the coefficient of
//!   [`restitution`], for faces, edges and vertices alike. [`ContactBatch::update`] expects leapfrog
//!   velocities, half a step old, and corrects for that lag. It also corrects the first force of a new
//!   contact for the fraction of the step in which it has existed. With equal steps before and after the
//!   first touch (see [`ContactBatch::may_touch`]) the error is of second order.
//! - Rattle: the elastic rocking of a body on its face, which the first dashpot does not see, has a dashpot of
//!   the same ratio. It acts on the part of the rotation that the patch follows elastically, and vanishes where the
//!   pressure travels with the patch: nothing resists rolling, or toppling over an edge.
//! - Friction: anchors in both bodies stretch a tangential spring, and a torsion spring twists about the
//!   normal; the limit surface of a disc bounds both ([`LimitSurface`]). The anchors follow the patch as it moves, so
//!   that rolling and turning under stretched springs gains no energy. Friction does not resist rolling.
//! - Rolling friction, 0 by default: a spring against rolling that slides at the moment μ_r N r, with the
//!   rolling radius r of the pair ([`RigidContact::rolling_radius`]).
//! - Materials: one law for all, or one for each pair of materials ([`ContactLaws`]), with its friction, damping and
//!   penalty.
//! - Attraction: a cohesion over the area of a contact, the pull-off force of balls ([`ContactParameters`]), and liquid
//!   bridges, which pull over a gap once balls have touched ([`LiquidBridge`]).
//! - Glue: the cohesive law of two faces that a crack separates, for codes that cut meshes ([`glue`]). The batch does not
//!   use it.
//! - Patches: bodies that are not convex may touch in several patches, each a [`Contact`] with a separate
//!   friction history. A patch that splits divides its springs among the new ones, and merging patches
//!   combine theirs by least squares. Neither creates energy, and the energy of a patch that vanishes is
//!   dissipated. The dashpots of patches that press the same way add up to those of one contact.
//!
//! # Units
//!
//! SI: m, kg, s, N, J; penalty in Pa. Frames take body coordinates, about the centroid, to world
//! coordinates. A normal points from A to B; forces and moments are those on B.
//!
//! # Features
//!
//! - `parallel` (default): [`ContactBatch::update`] evaluates pairs on the caller's rayon pool. Results
//!   are the same bits with any number of threads and without the feature.
//! - `proptest` (off by default): the module `strategies`, bodies and touching pairs for property
//!   tests of your own kernel.
//!
//! # Accuracy
//!
//! - Force and torque agree with central differences of the energy to 1e-6 and better, for all 18
//!   catalogue solids in random poses (`tests/gradient.rs`), and for balls (`tests/spheres.rs`).
//! - Everything is computed relative to the contact, not to the world's origin; positions themselves
//!   are `f64`, so that a body 1 km away is placed to 1e-13 m.
//! - Vertex and crossed-edge contacts are soft at first touch (F ~ δ³, an edge on a face δ², face on face δ).
//!   These soft contacts determine the penetration, and faces the time step.
//! - Every face plane must be farther from the centroid than 1e-6 of the bounding radius
//!   ([`ContactError::TooThin`]). Overlaps of any depth have an exact gradient, but a body pushed past
//!   another's centroid is pushed out on the far side.
//! - [`Contact::penetration`] is overlap volume over area, an estimate of the depth; the torsion arm
//!   [`Overlap::torsion_radius`] is within 3 % for discs, squares and conical pressure.
//!
//! # Sources
//!
//! Xiang, Latham and Farsi, "Algorithms and capabilities of Solidity to simulate interactions and
//! packing of complex shapes", DEM7 (2016), for the contact integral. The rest of the law is derived
//! in the docs of its modules.

mod adhesion;
mod axes;
mod batch;
mod body_shape;
pub mod bond;
mod bridge;
mod broadphase;
mod contact;
mod damping;
pub mod deform;
mod disjoint;
mod error;
mod exact;
mod foundation;
mod friction;
pub mod general;
mod generalized;
pub mod glue;
pub mod kernel;
mod law;
mod laws;
mod limit_surface;
mod mark;
mod materials;
mod motion;
mod periodic;
mod record;
mod rocking;
mod rolling;
mod shape;
mod sides;
mod slots;
mod sphere;
mod spring_load;
#[cfg(feature = "proptest")]
pub mod strategies;
mod tets;
mod walls;

pub use femdem_mesh as mesh;

pub use adhesion::{Adhesion, VectorArea};
pub use batch::{
    BatchTotals, BodyRecord, BodyRecords, BondId, ContactBatch, EndedBonds, PairRecord, Snapshot,
};
pub use body_shape::BodyShape;
pub use bridge::LiquidBridge;
pub use contact::{BodyId, ContactForce, Dashpots, Load, Partner, RigidContact, Springs, Wrench};
pub use error::ContactError;
pub use exact::ExactSum;
pub use femdem_mesh::PeriodicCell;
pub use foundation::Foundation;
pub use general::{Field, FieldMesh, GeneralKernel, SolidWall};
pub use generalized::{Generalized, Resistance, stable_step};
pub use kernel::{Overlap, PairKernel, mean_penetration};
pub use law::{ContactLaw, ContactParameters, WallResponse, restitution};
pub use laws::{ContactLaws, MaterialId};
pub use limit_surface::LimitSurface;
pub use motion::{Inertia, Motion};
pub use periodic::EdgeLoad;
pub use record::Contact;
pub use shape::{ConvexShape, Frame};
pub use sphere::{Sphere, SphereKernel};
pub use spring_load::SpringLoad;
pub use walls::{MeshWall, Wall, WallPlane, WallShape};

#[cfg(all(doctest, feature = "proptest"))]
#[doc = include_str!("../../../docs/embedding.md")]
mod embedding {}
