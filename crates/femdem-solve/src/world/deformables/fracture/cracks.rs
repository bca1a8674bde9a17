//! The cracks of a body: which nodes are split, and what its contacts see of them.

use super::CrackFlows;
use super::joints::Joint;
use super::query::CrackFacet;
use crate::world::deformables::ModelId;
use femdem_contact::deform::{NodalLoads, NodalState};
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
    /// By node of the elements, the node of the contacts that stands for it, and its part of the mass of that.
    shares: Vec<(u32, f64)>,
    /// Stiffness of the joints at the nodes, N/m.
    pub stiffness: Vec<f64>,
    /// The nodes of the contacts: m, m/s, 1/kg.
    positions: Vec<Vector3>,
    velocities: Vec<Vector3>,
    inverse_masses: Vec<f64>,
    /// What contacts do to the nodes of the elements; of stiffness, with that of the joints.
    loads: Loads,
}

/// See [`NodalLoads`].
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Loads {
    forces: Vec<Vector3>,
    damping: Vec<Vector3>,
    friction: Vec<Vector3>,
    stiffness: Vec<f64>,
    rates: Vec<f64>,
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
            shares: Vec::new(),
            stiffness: Vec::new(),
            positions: Vec::new(),
            velocities: Vec::new(),
            inverse_masses: Vec::new(),
            loads: Loads::default(),
        }
    }

    /// Finds out which contact nodes stand for which nodes, after either mesh has changed. `masses` are those of the nodes
    /// (kg), and `inverse_masses` 0 for those that are prescribed in all directions.
    pub fn share(&mut self, masses: &[f64], inverse_masses: &[f64]) {
        let mut of = vec![0; masses.len()];
        for (nodes, contact) in self.mesh.tets().iter().zip(self.skin.tets()) {
            for (node, contact) in nodes.iter().zip(contact) {
                of[*node as usize] = *contact;
            }
        }
        let count = self.skin.points().len();
        let mut whole = vec![0.0; count];
        for (contact, mass) in of.iter().zip(masses) {
            whole[*contact as usize] += mass;
        }
        self.shares.clear();
        let part = |(contact, mass): (&u32, &f64)| (*contact, mass / whole[*contact as usize]);
        self.shares.extend(of.iter().zip(masses).map(part));
        self.inverse_masses.clear();
        self.inverse_masses.extend(whole.iter().map(|m| 1.0 / m));
        for (contact, inverse) in of.iter().zip(inverse_masses) {
            if *inverse == 0.0 {
                self.inverse_masses[*contact as usize] = 0.0;
            }
        }
    }

    /// Masses of the contact nodes, from those of the nodes, kg.
    pub fn contact_masses(&self, masses: &[f64]) -> Vec<f64> {
        let mut whole = vec![0.0; self.inverse_masses.len()];
        for ((contact, _), mass) in self.shares.iter().zip(masses) {
            whole[*contact as usize] += mass;
        }
        whole
    }

    /// Moves the contact nodes to where the nodes are.
    pub fn follow(&mut self, positions: &[Vector3], velocities: &[Vector3]) {
        let count = self.inverse_masses.len();
        for list in [&mut self.positions, &mut self.velocities] {
            list.clear();
            list.resize(count, Vector3::zeros());
        }
        let nodes = positions.iter().zip(velocities);
        for ((x, v), (contact, part)) in nodes.zip(&self.shares) {
            // A node alone stays exactly where it is.
            self.positions[*contact as usize] += x * *part;
            self.velocities[*contact as usize] += v * *part;
        }
    }

    /// What the contact stage sees.
    pub fn nodes(&self) -> NodalState<'_> {
        NodalState {
            positions: &self.positions,
            velocities: &self.velocities,
            inverse_masses: &self.inverse_masses,
        }
    }

    /// Takes what the contacts do to their nodes over to those of the elements; the rates of dashpots hold for each.
    pub fn take(&mut self, given: &NodalLoads) {
        let Loads {
            forces,
            damping,
            friction,
            stiffness,
            rates,
        } = &mut self.loads;
        for (own, of_contact) in [
            (forces, given.forces),
            (damping, given.damping),
            (friction, given.friction),
        ] {
            own.clear();
            let part = |(contact, part): &(u32, f64)| of_contact[*contact as usize] * *part;
            own.extend(self.shares.iter().map(part));
        }
        stiffness.clear();
        let shares = self.shares.iter().zip(&self.stiffness);
        stiffness.extend(
            shares.map(|((contact, part), joints)| {
                given.stiffness[*contact as usize] * part + joints
            }),
        );
        rates.clear();
        let rate = |(contact, _): &(u32, f64)| given.rates[*contact as usize];
        rates.extend(self.shares.iter().map(rate));
    }

    /// What contacts do to the nodes of the elements; of stiffness, with that of the joints.
    pub fn loads(&self) -> NodalLoads<'_> {
        let Loads {
            forces,
            damping,
            friction,
            stiffness,
            rates,
        } = &self.loads;
        NodalLoads {
            forces,
            damping,
            friction,
            stiffness,
            rates,
        }
    }
}
