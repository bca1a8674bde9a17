//! Response of a pair, and its history.

use super::bristle::Bristle;
use super::record::DeformableTotals;
use crate::contact::Load;
use crate::generalized::Resistance;
use crate::record::Contact;
use crate::rocking::RockingState;
use crate::rolling::RollingState;
use crate::spring_load::SpringLoad;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Action of a contact on a node.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct NodeLoad {
    pub node: u32,
    /// N, and the parts of it due to damping and to friction.
    pub force: Vector3,
    pub damping: Vector3,
    pub friction: Vector3,
    /// Stiffness, N/m, and damping rate, 1/s.
    pub stiffness: f64,
    pub rate: f64,
}

/// Response of a pair, and its history.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Outcome {
    pub nodes: [Vec<NodeLoad>; 2],
    /// Force and moment on A and on B as wholes, about their centres, N and N m: the dashpots against rocking and of the
    /// bodies as wholes. Their rates, 1/s.
    pub whole: [[Vector3; 2]; 2],
    pub whole_rates: [f64; 2],
    /// Load on a rigid body or wall.
    pub load: Option<Box<(Load, Resistance)>>,
    /// One for each patch.
    pub contacts: Vec<Contact>,
    pub totals: DeformableTotals,
    pub bristles: Vec<Bristle>,
    /// One for each patch.
    pub rocking: Vec<RockingState>,
    pub rolling: Vec<RollingState>,
    /// What the springs of each patch carry.
    pub springs: Vec<SpringLoad>,
}

/// The dashpot of a patch.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Dashpot {
    /// Elastic plus viscous force over elastic force: of the nodes.
    pub scale: f64,
    /// The same with what acts on the bodies as wholes.
    pub total: f64,
    /// Inverse mass of the contact along its force, 1/kg: sum |f_a|^2/m_a over |f|^2.
    pub inverse_mass: f64,
    /// The matrix of `total` on a rigid body is this times f f^T, with the elastic wrench f on it, 1/(N s).
    pub coefficient: f64,
    /// Rate of the nodes, 1/s.
    pub rate: f64,
    pub power: f64,
}
