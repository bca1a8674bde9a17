//! Settings of a scenario for the world as a whole.

use femdem_contact::{ContactParameters, WallResponse};
use femdem_mesh::Vector3;
use femdem_solve::WorldParameters;
use serde::{Deserialize, Serialize};

use super::Scenario;
use crate::scene::{BridgeEntry, per_second};

/// The contact law of all pairs of materials without [one of their own](super::PairEntry). What it does not give is that of
/// the pack from which the scene starts, or the default of [`ContactParameters`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct ContactEntry {
    /// Penalty p of contacts of rigid bodies \[Pa\]. `None`: that of the pack, or chosen from loads, speeds and sizes.
    pub penalty: Option<f64>,
    /// Mean depth of contacts at rest that the chosen penalty aims at, in circumscribed diameters; impacts go at most ten times
    /// as deep. `None`: 0.005, with a penalty of at least 1 MPa.
    pub penetration: Option<f64>,
    /// Coulomb friction coefficient.
    pub friction: Option<f64>,
    /// Coulomb friction coefficient between bodies and walls. `None`: `friction`.
    pub wall_friction: Option<f64>,
    /// Coefficient of rolling friction.
    pub rolling_friction: Option<f64>,
    /// Fraction of critical damping of the normal contact, below 0.7071.
    pub damping: Option<f64>,
    /// Tangential over normal foundation modulus.
    pub tangential_ratio: Option<f64>,
    /// Fraction of critical damping of the tangential springs.
    pub tangential_damping: Option<f64>,
    /// How walls act on deformable bodies: `"mirror"`, as their mirror image, or `"rigid"`, half as stiffly, as
    /// they act on rigid bodies.
    pub wall_response: Option<WallResponse>,
    /// Cohesion of rigid bodies \[Pa\]: attraction over the contact area.
    pub cohesion: Option<f64>,
    /// Work of adhesion of spheres with spheres and planes \[J/m²\].
    pub adhesion_energy: Option<f64>,
    /// Liquid bridges of spheres with spheres and planes.
    pub liquid_bridge: Option<BridgeEntry>,
}

/// The choice of the time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct StepEntry {
    /// Fraction of the stability bound that is used, from 1e-6 to 1.
    pub safety: f64,
    /// Upper limit \[s\].
    pub largest: Option<f64>,
}

impl Default for StepEntry {
    fn default() -> Self {
        let step = WorldParameters::default().time_step;
        Self {
            safety: step.safety,
            largest: step.largest,
        }
    }
}

/// Damping by the medium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct MediumEntry {
    /// Drag rate a \[1/s\]: force −a m v.
    #[serde(deserialize_with = "per_second")]
    pub drag: f64,
    /// Cundall's local damping, 0 to 1.
    pub local_damping: f64,
}

/// When a run may end early. It is checked every 64 steps, independently of output.
///
/// When the kinetic energy has been below `energy` for `time`, all bodies are woken; the run ends when it has then been so for
/// `time` again and the bodies are verified to be at rest ([`RestSummary`](super::RestSummary)). It does not end before the last
/// prescribed motion or change of a load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct RestEntry {
    /// Kinetic energy of all bodies that counts as rest \[J\].
    pub energy: f64,
    /// Time for which it must stay below \[s\].
    pub time: f64,
}

impl Scenario {
    pub(super) fn parameters(&self) -> WorldParameters {
        let mut p = WorldParameters::default();
        p.gravity = self.gravity.map_or(p.gravity, Vector3::from);
        let (own, usual) = (&self.contact, p.contact);
        p.contact = ContactParameters {
            penalty: own.penalty.unwrap_or(usual.penalty),
            friction: own.friction.unwrap_or(usual.friction),
            wall_friction: own.wall_friction.or(usual.wall_friction),
            rolling_friction: own.rolling_friction.unwrap_or(usual.rolling_friction),
            damping_ratio: own.damping.unwrap_or(usual.damping_ratio),
            tangential_ratio: own.tangential_ratio.unwrap_or(usual.tangential_ratio),
            tangential_damping: own.tangential_damping.unwrap_or(usual.tangential_damping),
            wall_response: own.wall_response.unwrap_or(usual.wall_response),
            cohesion: own.cohesion.unwrap_or(usual.cohesion),
            adhesion_energy: own.adhesion_energy.unwrap_or(usual.adhesion_energy),
            liquid_bridge: own.liquid_bridge.map(Into::into),
        };
        p.time_step.safety = self.time_step.safety;
        p.time_step.largest = self.time_step.largest;
        p.medium.drag = self.medium.drag;
        p.medium.local_damping = self.medium.local_damping;
        p.sleeping.enabled = self.sleeping;
        p.sleeping.deformables = self.sleeping_deformables;
        p
    }
}
