//! Rigid and deformable bodies in motion and at rest: the step, its size, the active set, the energy ledger and
//! checkpoints.
//!
//! **Use it** to follow bodies of any shape that fall, collide, deform, slide, break into others and come to rest between
//! walls that may move, with the energy of the whole run accounted for. **Do not use it** for steps longer than the
//! stability limit of contacts and elements (the scheme is explicit, except with [`ImplicitStep`]), or to fill
//! containers (femdem-pack has the protocols). A code with its own integrator needs only femdem-contact; single
//! deformable bodies without contact are in femdem-fem.
//!
//! ```
//! use femdem_contact::Wall;
//! use femdem_mesh::catalogue::{CatalogueShape, Solid};
//! use femdem_mesh::{Pose, Vector3};
//! use femdem_solve::{BodySpec, Drive, World, WorldParameters};
//!
//! // A cube of side 0.1 m and 2 kg falls 10 mm onto a floor.
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(0.1 * 3_f64.sqrt())?;
//! let mut parameters = WorldParameters::default();
//! parameters.time_step.safety = 0.2;
//! let mut world = World::new(parameters)?;
//! world.add_wall(Wall::half_space("floor", Vector3::z(), 0.0)?, Drive::Fixed)?;
//! let shape = world.add_shape("cube", &cube)?;
//! let body = world.add_body(BodySpec::at_rest(shape, 2000.0, Pose::translation(0.0, 0.0, 0.06)))?;
//! while world.time() < 1.0 {
//!     world.step()?;
//! }
//! let height = world.position(body).map(|x| x.z).unwrap_or_default();
//! assert!(height < 0.05 && height > 0.0499, "a contact carries its weight by a small overlap");
//! assert!(world.residuals().max_over_weight < 0.02);
//! assert!(world.ledger().error_relative().abs() < 5e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is here
//!
//! - [`World`]: shapes, bodies and walls, one [`World::step`] at a time, and queries of its state
//!   ([`Residuals`], [`Stability`], [`Counters`], contacts).
//! - [`WorldParameters`]: gravity, the contact law, the time step, the active set, the medium; every
//!   field has a default.
//! - [`World::add_shape`] takes convex surfaces, [`World::add_sphere`] exact balls, [`World::add_mesh_shape`] any closed
//!   surface with tetrahedra that fill it; [`World::add_wall`] takes planes and meshes.
//! - [`World::add_model`] and [`World::add_deformable`] take deformable bodies
//!   ([`DeformableModel`](femdem_fem::DeformableModel)), which share the step, the walls and the ledger with the
//!   rigid ones; [`World::relax`] brings all to rest, [`World::solve_single_bodies`] those that touch nothing.
//! - [`Drive`]: prescribed motion of a wall or a body: shaken, tapped, drawn along a line, turned
//!   about an axis.
//! - Rigid and deformable bodies are numbered together. [`World::body_ids`], [`World::position`], [`World::velocity`],
//!   [`World::mass`], [`World::set_load`] and [`World::remove_body`] are for both; [`World::deformable`] has the nodes.
//! - For hosts, at any time between steps: [`World::remove_body`] and [`World::remove_wall`]; [`World::set_pose`], [`World::set_velocity`] and [`World::set_nodes`]; forces and torques by
//!   [`World::set_load`]; walls and bodies that the host moves step by step, by [`World::step_with`].
//! - [`Ledger`]: where every joule came from and went.
//! - [`checkpoint`]: files that survive crashes; [`World::to_bytes`] and [`World::state_hash`].
//! - [`contact`], [`fem`] and [`mesh`]: femdem-contact, femdem-fem and femdem-mesh, whose types appear in the
//!   interfaces.
//!
//! # The step
//!
//! Kick, drift, contacts, kick, with one step size for all bodies. The drift turns a body by the rational
//! plane rotations of the DLM splitting, without a trigonometric call. Then, at fixed step numbers, bodies at
//! rest are frozen and disturbed ones woken. A body is judged by means of its net force, moment and
//! velocities at rest: every impact rings through a pack, and only a lasting imbalance has a mean
//! ([`SleepParameters`]). Frozen bodies cost nothing. Deformable bodies are frozen only if
//! [`SleepParameters::deformables`] is set.
//!
//! # A host
//!
//! A host changes the world between any two steps. Numbers of what was removed are given out again, the lowest first:
//! iterate with [`World::body_ids`], [`World::deformable_ids`] and [`World::walls`], and forget the numbers of what you remove.
//! Until it is given out again such a number is refused ([`SolveError::NoSuch`]) or answered with `None`.
//!
//! ```
//! use femdem_contact::{Wall, Wrench};
//! use femdem_mesh::catalogue::{CatalogueShape, Solid};
//! use femdem_mesh::{Pose, Vector3};
//! use femdem_solve::{BodySpec, Drive, Driven, World, WorldParameters};
//!
//! let cube = CatalogueShape::from(Solid::P5).polyhedron(0.1 * 3_f64.sqrt())?;
//! let mut parameters = WorldParameters::default();
//! parameters.time_step.safety = 0.3;
//! let mut world = World::new(parameters)?;
//! world.add_wall(Wall::half_space("floor", Vector3::z(), 0.0)?, Drive::Fixed)?;
//! let shape = world.add_shape("cube", &cube)?;
//! let body = world.add_body(BodySpec::at_rest(shape, 2000.0, Pose::translation(0.0, 0.0, 0.05)))?;
//!
//! // A servo: a plate comes down on the cube and presses it with 100 N.
//! let plate = world.add_wall(Wall::half_space("plate", -Vector3::z(), -0.1001)?, Drive::Fixed)?;
//! let mut place = Vector3::zeros();
//! world.drive_wall_by_host(plate, Driven::default())?;
//! while world.time() < 0.2 {
//!     let bears = world.wall_load(plate).map_or(0.0, |load| load.total.force.z);
//!     let (from, start, velocity) = (place, world.time(), Vector3::z() * (2e-4 * (bears - 100.0)));
//!     let at = |time: f64| from + velocity * (time - start);
//!     world.step_with(|_, time| Some(Driven { displacement: at(time), velocity, ..Driven::default() }))?;
//!     place = at(world.time());
//! }
//! let bears = world.wall_load(plate).map_or(0.0, |load| load.total.force.z);
//! assert!((bears - 100.0).abs() < 1.0);
//!
//! // The plate goes, a force of a tenth of the weight pulls the cube along and friction holds it.
//! world.remove_wall(plate)?;
//! world.set_load(body, Wrench { force: Vector3::x() * 2.0, torque: Vector3::zeros() })?;
//! // A sink and a source: bodies that have fallen off go, others come.
//! for _ in 0..100 {
//!     world.step()?;
//!     let gone: Vec<_> = world.body_ids().filter(|&id| world.position(id).is_none_or(|x| x.z < -1.0)).collect();
//!     for id in gone {
//!         world.remove_body(id)?;
//!     }
//!     if world.body_count() < 2 {
//!         world.add_body(BodySpec::at_rest(shape, 2000.0, Pose::translation(0.0, 0.0, 0.2)))?;
//!     }
//! }
//! assert!(world.ledger().error_relative().abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units
//!
//! SI: m, kg, s, N, J, Pa; angles in rad. Poses map the coordinates of a shape's polyhedron to the world;
//! velocities are those of the centroid.
//!
//! # Features
//!
//! - `parallel` (default): contacts, and the work for each deformable body, are computed on the caller's
//!   rayon pool. The state is the same bits with any number of threads, without the feature, and through a
//!   checkpoint.
//!
//! # Accuracy
//!
//! - Without friction and damping the energy has no trend: 27 bodies colliding in a closed box for 1 s keep
//!   theirs to 1e-5 at a step of 1e-5 s, and momentum is conserved to round-off (`tests/physics.rs`); 20
//!   hollow pellets and dolosse keep theirs to 1e-4 at 2e-5 s (`tests/any_shape.rs`).
//! - The step is shortened so that no body moves by more than a tenth of its radius in it (no node by more
//!   than a tenth of the depth of its body), relative to walls and bodies that are driven. Speed never makes
//!   it shorter than 1/32 of the stable step, unless a body was launched that fast. A body that then moves by
//!   more than a quarter of its radius in a step is reported as a blow-up.
//! - The step is a fraction, [`TimeStepParameters::safety`], of a stability bound from an upper estimate of
//!   the highest frequency; [`World::stability`] measures the true limit. Where a body may touch something,
//!   the bound is that of a face contact. At the default of 0.9 the impact of a single flat face is resolved
//!   by few steps: the cube above then misses 3 % of its energy in the ledger, 0.2 % at 0.2 (the error falls
//!   with the square of the step). The restitution of rigid bodies is right to 15 % (2 % at 0.3, 1 % at 0.1;
//!   edges and vertices to 1 % at 0.6). Use 0.2 or less to study single impacts; in packs, contacts are
//!   softer and such errors cancel.
//! - The active set counts in steps, not in seconds. With a much smaller step, lengthen
//!   [`SleepParameters::window`] as much, or switch it off; otherwise bodies
//!   may be frozen before they have come to rest. A block on a slope half a degree steeper than its friction
//!   angle, whose net force is 1 % of its weight, slides at a penalty of 1e7 Pa and stays at 1e8 Pa.
//! - [Implicit steps](ImplicitStep) bring packs of rigid bodies to rest at a fifth of the cost of explicit
//!   ones; 500 bodies released at once end 0.005 ± 0.003 less dense. Small steps give the motion of explicit
//!   ones. Large ones conserve momentum to round-off, respect the bounds of friction, and stop falling bodies
//!   without rebound unless the step resolves the impact. They dissipate a tenth to a fifth of the energy
//!   numerically ([`Ledger::dissipated_step`]); the ledger misses up to 6 % of a heap's. A column of aligned
//!   cubes that is dropped comes to rest upright, shifted by a hundredth of d and twisted by a hundredth of a
//!   radian on average (one of some 1,500 fell over). Verify with explicit steps
//!   ([`World::step_explicitly`]); see `tests/implicit.rs`.
//! - Deformable bodies without damping keep their energy to 1e-3 at half the critical step: a cube between
//!   two walls, eight cubes in a box (`tests/deformable_world`). A cube that falls flat on its face is the worst case,
//!   since the whole contact begins within one step: 1e-2 of its energy at a safety of 0.5, 2e-3 at 0.25, 3e-4 at 0.1.
//! - A body much stiffer than its contacts rebounds as a rigid one: within 2 % of
//!   [`restitution`](femdem_contact::restitution) whatever its mesh. One as soft as its contacts rebounds by its own
//!   vibrations, and ζ damps what touches only: 0.73 to 0.83 for a cube at a contact ratio of 1, on a wall, with ζ from 0.6
//!   to 0.1. A block sticks to a slope without creep and
//!   slides on it with the right acceleration to 2 %, on a wall, on a rigid and on a deformable body.
//! - Freezing removes kinetic energy, which the ledger states. A frozen body tolerates an imbalance of up to
//!   [`SleepParameters::wake`] of its weight, or of its load if asked for ([`SleepMeasure`]), a deformable one up to
//!   twice [`SleepParameters::tolerance`]; so a pack that grew while it slept transfers new loads downwards too
//!   late. For a final state, and from time to time before, wake all bodies ([`World::set_sleeping`]) and let them
//!   come to rest.
//! - The same bits on one machine and build. Platforms that round `f64` arithmetic alike agree too, as long
//!   as no medium (which calls `exp`) and no shaking or rotation (which call `cos`) is used.
//!
//! # Sources
//!
//! Rotation: Dullweber, Leimkuhler and McLachlan, J. Chem. Phys. 107, 5840 (1997). Local damping:
//! Cundall (1987). The contact law is that of femdem-contact.

mod applied;
mod body;
pub mod checkpoint;
mod clock;
mod error;
mod fracture;
mod guide;
mod halo;
mod ledger;
mod parameters;
mod rest;
mod rotation;
mod servo;
mod world;

pub use femdem_contact as contact;
pub use femdem_fem as fem;
pub use femdem_mesh as mesh;

pub use applied::AppliedLoad;
pub use body::{BodySpec, Shape, ShapeId};
pub use clock::processor_time;
pub use error::SolveError;
pub use femdem_fem::{Drive, Driven};
pub use fracture::{Fracture, Fragments};
pub use halo::{Alone, Halo};
pub use ledger::Ledger;
pub use parameters::{
    ImplicitStep, Medium, SleepMeasure, SleepParameters, TimeStepParameters, WorldParameters,
};
pub use servo::{Resistance, Servo};
pub use world::{
    Adaptive, CellResistance, ContactStiffness, Counters, CrackFacet, Cracks, Deformable,
    DeformableSpec, Fidelity, FidelityChange, Fragmentation, ModelId, Residuals, Stability, World,
    WorldRelaxation, WorldRelaxed,
};
