//! The cracks of a body.

use super::CrackFlows;
use super::facet::CrackFacet;
use super::joints::Joint;
use crate::world::deformables::ModelId;
use femdem_contact::deform::NodalLoads;
use femdem_mesh::Vector3;
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
    pub(super) both: Vec<f64>,
}

impl CrackState {
    /// A body that has just cracked along `mesh`, with the skin of `whole`.
    pub fn new(base: ModelId, mesh: CrackedMesh, whole: CrackedMesh) -> Self {
        Self {
            base,
            skin: whole,
            mesh,
            joints: Vec::new(),
            released: Vec::new(),
            stored: 0.0,
            flows: CrackFlows::default(),
            stiffness: Vec::new(),
            both: Vec::new(),
        }
    }

    /// Advances the joints to the present positions (m), at time `time` (s), and adds their forces to those of the elements (N).
    pub fn join(&mut self, positions: &[Vector3], time: f64, forces: &mut [Vector3]) {
        self.stored = 0.0;
        for joint in &mut self.joints {
            let [a, b] = joint.places(positions);
            let lost = joint.glued.advance(&joint.law, &a, &b);
            let now = joint.forces(positions);
            joint.taken += lost.glue;
            if joint.end.is_none() && joint.glued.is_broken(&joint.law) {
                joint.end = Some(time);
            }
            self.flows.glue += lost.glue;
            self.flows.friction += lost.friction;
            self.stored += now.glue + now.contact;
            joint.add(&now, 1.0, forces);
        }
    }

    /// Finds the stiffness of the joints at the nodes: a pair of nodes of masses m and n on a spring k has the squared
    /// frequency k/m + k/n, which is no more than twice the larger part.
    pub fn stiffen(&mut self, nodes: usize) {
        self.stiffness.clear();
        self.stiffness.resize(nodes, 0.0);
        for joint in &self.joints {
            let stiffness = joint.glued.stiffness(&joint.law);
            for side in &joint.sides {
                for (node, k) in side.iter().zip(stiffness) {
                    self.stiffness[*node as usize] += k;
                }
            }
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
