//! The cracks of a body: which nodes are split, and what its contacts see of them.

use super::CrackFlows;
use super::joints::Joint;
use super::query::CrackFacet;
use crate::world::deformables::ModelId;
use femdem_contact::deform::NodalLoads;
use femdem_mesh::tet::CrackedMesh;
use serde::{Deserialize, Serialize};

/// The cracks of a body.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct CrackState {
    /// The model without cracks.
    pub base: ModelId,
    /// The mesh of the elements: all facets that are cut.
    pub mesh: CrackedMesh,
    /// That of the contacts: the facets that are released.
    pub skin: CrackedMesh,
    /// In the order of their births.
    pub joints: Vec<Joint>,
    /// Facets that were released, as they were then.
    pub released: Vec<CrackFacet>,
    /// Stored in the joints at the present positions, J.
    pub stored: f64,
    /// Exchanged, and not booked yet.
    pub flows: CrackFlows,
    /// Stiffness of the joints at the nodes, and with that of the contacts, N/m.
    pub stiffness: Vec<f64>,
    both: Vec<f64>,
}

impl CrackState {
    /// A body that is about to crack.
    pub fn new(base: ModelId, mesh: CrackedMesh) -> Self {
        Self {
            base,
            skin: mesh.clone(),
            mesh,
            joints: Vec::new(),
            released: Vec::new(),
            stored: 0.0,
            flows: CrackFlows::default(),
            stiffness: Vec::new(),
            both: Vec::new(),
        }
    }

    /// Adds the stiffness of the contacts to that of the joints.
    pub fn take(&mut self, contacts: &NodalLoads) {
        self.both.clear();
        let both = self.stiffness.iter().zip(contacts.stiffness);
        self.both.extend(both.map(|(own, given)| own + given));
    }

    /// What contacts do to the nodes; of stiffness, with that of the joints.
    pub fn loads<'a>(&'a self, contacts: NodalLoads<'a>) -> NodalLoads<'a> {
        NodalLoads {
            stiffness: &self.both,
            ..contacts
        }
    }
}
