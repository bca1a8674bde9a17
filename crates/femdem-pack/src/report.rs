//! The state of a pack in numbers.

use crate::packing::top::{mean_top, place_and_top};
use femdem_contact::BodyId;
use femdem_solve::World;
use serde::{Deserialize, Serialize};

/// Results of the final verification, with all bodies awake and the medium switched off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Verification {
    /// Whether the required number of checks in a row passed.
    pub passed: bool,
    /// Number of attempts. Bodies are brought to rest by implicit steps before the first attempt, and an
    /// attempt ends with explicit steps. It fails if a body does not stay at rest or moves by more than 1e-3 d;
    /// then the bodies at rest sleep until the others are at rest, too, and another attempt follows. The fields
    /// below refer to the last attempt. In jobs with implicit steps they include the implicit steps before it
    /// whose checks passed, see [`Settling`](crate::Settling).
    pub tries: u32,
    /// Steps it took.
    pub steps: u64,
    /// Simulated time it took, s.
    pub time: f64,
    /// Mean distance that the centroids moved, over d.
    pub mean_displacement_over_d: f64,
    /// Largest distance that a centroid moved, over d.
    pub max_displacement_over_d: f64,
    /// Change of the mean top, over d.
    pub mean_top_change_over_d: f64,
}

/// An awake relaxation: all bodies are woken and kept awake until their mean net force is small, and are
/// stopped whenever more of them slow down than speed up. Steps are implicit unless the medium damps locally.
/// While the pack grows, relaxations take place at numbers of bodies that form a geometric series; the last one
/// precedes the verification.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Relaxation {
    /// Bodies in the pack.
    pub bodies: u32,
    /// Steps it took.
    pub steps: u64,
    /// Mean distance that the centroids moved, over d: mostly compression by loads that
    /// sleeping bodies had not passed on.
    pub mean_displacement_over_d: f64,
    /// Largest distance that a centroid moved, over d.
    pub max_displacement_over_d: f64,
}

/// The state of a pack in numbers; d is the (mean) circumscribed diameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PackReport {
    /// Whether the pack is complete and has passed the verification.
    pub settled: bool,
    /// Bodies.
    pub bodies: u32,
    /// Batches or layers released.
    pub batches: u32,
    /// Batches that were followed by the next before they had landed.
    pub cut_short: u32,
    /// Penalty, Pa.
    pub penalty: f64,
    /// Simulated time, s.
    pub time: f64,
    /// Steps.
    pub steps: u64,
    /// Highest point, m.
    pub top: f64,
    /// Mean top, m: squares of side d divide the floor plan, and the highest points of the bodies centred over
    /// each square are averaged over the squares with bodies.
    pub mean_top: f64,
    /// Net force over weight, mean over bodies.
    pub residual_mean_over_weight: f64,
    /// Net force over weight, largest.
    pub residual_max_over_weight: f64,
    /// Net force over the larger of weight and mean contact force, largest.
    pub residual_max_over_load: f64,
    /// The body with the largest residual over load.
    pub worst_body: Option<BodyId>,
    /// Largest kinetic energy of a body over its m g d.
    pub kinetic_energy_over_mgd: f64,
    /// Overlap volume over contact area, mean over contacts, over d.
    pub penetration_mean_over_d: f64,
    /// The same, largest.
    pub penetration_max_over_d: f64,
    /// The last awake relaxation, if there was one.
    pub relaxation: Option<Relaxation>,
    /// The final verification, once it is over.
    pub verification: Option<Verification>,
}

impl PackReport {
    pub(crate) fn new(
        world: &World,
        diameter: f64,
        penalty: f64,
        settled: bool,
        verification: Option<Verification>,
    ) -> Self {
        let residuals = world.residuals();
        let depths: Vec<f64> = world
            .contacts()
            .iter()
            // Liquid bridges over a gap are contacts without an area.
            .filter(|c| c.area > 0.0)
            .map(|c| c.penetration() / diameter)
            .collect();
        let places = || {
            world
                .body_ids()
                .filter_map(|body| place_and_top(world, body))
        };
        Self {
            settled,
            bodies: u32::try_from(world.body_count()).unwrap_or(u32::MAX),
            batches: 0,
            cut_short: 0,
            penalty,
            time: world.time(),
            steps: world.steps(),
            top: places().map(|(_, top)| top).fold(0.0, f64::max),
            mean_top: mean_top(places(), world.cell(), diameter),
            residual_mean_over_weight: residuals.mean_over_weight,
            residual_max_over_weight: residuals.max_over_weight,
            residual_max_over_load: residuals.max_over_load,
            worst_body: residuals.worst_body,
            kinetic_energy_over_mgd: residuals.kinetic_energy_over_mgd,
            // Not `sum`, which is -0 without contacts.
            penetration_mean_over_d: depths.iter().fold(0.0, |sum, depth| sum + depth)
                / depths.len().max(1) as f64,
            penetration_max_over_d: depths.iter().copied().fold(0.0, f64::max),
            relaxation: None,
            verification,
        }
    }

    pub(crate) fn with_history(
        self,
        batches: u32,
        cut_short: u32,
        relaxation: Option<Relaxation>,
    ) -> Self {
        Self {
            batches,
            cut_short,
            relaxation,
            ..self
        }
    }
}
