//! When adaptive bodies became deformable and rigid.

use femdem_solve::FidelityChange;
use serde::{Deserialize, Serialize};

/// What has become of the adaptive bodies of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FidelityRecord {
    /// How many the scene has, those that have cracked included.
    pub(super) bodies: usize,
    /// Their changes, with the names of the bodies.
    pub(super) changes: Vec<(String, FidelityChange)>,
    /// Largest mass of all deformable bodies over that of all bodies when one changed.
    pub(super) largest_share: f64,
}

/// The adaptive bodies of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FidelitySummary {
    /// Number of adaptive bodies of the scene, those that have cracked included.
    pub bodies: usize,
    /// How often one became deformable.
    pub softened: usize,
    /// How often one became rigid again.
    pub hardened: usize,
    /// Largest stress over strength at which one became deformable: above 1 one was too late.
    pub highest: f64,
    /// Mass of all deformable bodies, fragments included, over that of all bodies, now.
    pub deformable_share: f64,
    /// The largest when a body changed, or now.
    pub largest_share: f64,
}
