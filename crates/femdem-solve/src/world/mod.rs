//! Layer 3: a world of rigid and deformable bodies and walls, and its step.

mod active;
mod bonds;
mod build;
mod deformables;
mod drift;
mod guide;
mod hand;
mod hash;
mod implicit;
mod lists;
mod materials;
mod medium;
mod newcomers;
mod periodic;
mod query;
mod ranks;
mod relax;
mod resistance;
mod restart;
mod stability;
mod step;
mod stop;
mod stored;
mod sums;
mod time_step;

use crate::body::{Body, Shape};
use crate::guide::Guide;
use crate::ledger::Flows;
use crate::parameters::WorldParameters;
use deformables::{Adaptives, Deformables};
use femdem_contact::{ContactBatch, Motion};
use femdem_mesh::Pose;
use serde::{Deserialize, Serialize};
use std::time::Duration;

pub(crate) use deformables::CrackFlows;
pub use deformables::{
    Adaptive, ContactStiffness, CrackFacet, Cracks, Deformable, DeformableSpec, Fidelity,
    FidelityChange, Fragmentation, ModelId,
};
pub use query::Residuals;
pub use relax::{WorldRelaxation, WorldRelaxed};
pub use resistance::CellResistance;
pub use stability::Stability;

/// Rigid and deformable bodies between walls.
///
/// The step is kick-drift-kick with one step size for all bodies, or [implicit](crate::ImplicitStep)
/// for rigid ones. Its state after n steps is the same bits for any number of threads, with or without
/// the feature `parallel`, and through [`to_bytes`](Self::to_bytes) and
/// [`from_bytes`](Self::from_bytes).
///
/// Serialised as part of something larger, it is for binary formats: its maps have composite keys, and some
/// numbers are infinite, which JSON does not support. After reading, it needs [`restore`](Self::restore)
/// before it is used.
///
/// ```
/// use femdem_contact::Wall;
/// use femdem_mesh::{Pose, Vector3, catalogue::CatalogueShape};
/// use femdem_solve::{BodySpec, Drive, World, WorldParameters};
///
/// // A block on a ramp of 20 degrees sticks at a friction of 0.5; at 0.2 it slides.
/// let slope = 20_f64.to_radians();
/// let mut went = Vec::new();
/// for friction in [0.5, 0.2] {
///     let mut parameters = WorldParameters::default();
///     parameters.gravity = 9.81 * Vector3::new(slope.sin(), 0.0, -slope.cos());
///     parameters.contact.friction = friction;
///     let mut world = World::new(parameters)?;
///     world.add_wall(Wall::half_space("ramp", Vector3::z(), 0.0)?, Drive::Fixed)?;
///     let shape = world.add_shape("block", &"P5".parse::<CatalogueShape>()?.polyhedron(0.1)?)?;
///     let half = 0.05 / 3_f64.sqrt();
///     let block = world.add_body(BodySpec::at_rest(shape, 2000.0, Pose::translation(0.0, 0.0, half)))?;
///     while world.time() < 0.3 {
///         world.step()?;
///     }
///     went.push(world.position(block).map_or(0.0, |x| x.x));
/// }
/// assert!(went[0] < 1e-3);
/// // x = g (sin - mu cos) t^2/2
/// assert!((went[1] / (0.5 * 9.81 * (slope.sin() - 0.2 * slope.cos()) * 0.09) - 1.0).abs() < 0.05);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct World {
    parameters: WorldParameters,
    shapes: Vec<Shape>,
    /// The rigid bodies by number, as the motions; the batch knows which numbers are in use, and of which kind the bodies are.
    bodies: Vec<Body>,
    motions: Vec<Motion>,
    /// Predicted motions of implicit steps; those of sleeping bodies are their present motions.
    #[serde(skip)]
    ahead: Vec<Motion>,
    /// Each with its base pose.
    wall_drives: Vec<(Guide, Pose)>,
    wall_motions: Vec<Motion>,
    batch: ContactBatch,
    /// Awake bodies, ascending.
    awake: Vec<u32>,
    /// Whether something was driven since all awake rigid bodies were last at rest.
    unsettled: bool,
    time: f64,
    steps: u64,
    /// The size of the steps, and when it may grow.
    step_control: time_step::StepControl,
    /// Whether the loads belong to the present positions.
    loaded: bool,
    /// What came since the contacts were last evaluated.
    newcomers: newcomers::Newcomers,
    /// Time by which the friction of the contacts lags, s: an implicit step advances it in the next one.
    behind: f64,
    initial_energy: f64,
    flows: Flows,
    /// What a batch does not hold of deformable bodies; absent in a world of rigid ones.
    deformables: Option<Box<Deformables>>,
    /// The bodies that are deformable near their strength only, if there are any.
    adaptives: Option<Box<Adaptives>>,
    /// What a rank knows of the others; absent in a world that has all bodies.
    share: Option<Box<ranks::Share>>,
    #[serde(skip)]
    counters: Counters,
}

/// Work counters of a world since it was made or read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Counters {
    /// Candidate pairs evaluated by the narrow phase.
    pub pair_evaluations: u64,
    /// Pairs that touched.
    pub touching_evaluations: u64,
    /// Sum over steps of the awake bodies.
    pub body_steps: u64,
    /// Linear systems of implicit steps.
    pub linear_systems: u64,
    /// Iterations of conjugate gradients in them.
    pub linear_rounds: u64,
    /// Processor time in the contact stage, of all threads of the process; time on the clock where the platform does not
    /// report it ([`processor_time`](crate::processor_time)).
    pub contact_time: Duration,
}
