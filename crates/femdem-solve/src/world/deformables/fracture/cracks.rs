//! The cracks of a body.

use super::CrackFlows;
use super::facet::CrackFacet;
use super::joints::Joint;
use crate::world::World;
use crate::world::deformables::{Deformables, State};
use femdem_contact::deform::NodalLoads;
use femdem_mesh::Vector3;
use femdem_mesh::tet::CrackedMesh;
use serde::{Deserialize, Serialize};

/// Looks at the stresses between two looks at what is spent.
const LOOKS: u64 = 4;

/// The cracks of a body.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct CrackState {
    /// The mesh of the elements: all facets that are cut.
    pub mesh: CrackedMesh,
    /// The same with those facets alone that are spent.
    pub broken: CrackedMesh,
    /// In the order of their births.
    pub joints: Vec<Joint>,
    /// Whether some have come to be spent, or nodes have been split, since its parts were last looked for.
    pub loosened: bool,
    /// Stored in the joints at the present positions, J.
    pub stored: f64,
    /// Exchanged, and not booked yet.
    pub flows: CrackFlows,
    /// Stiffness of the joints at the nodes, and with that of the contacts, N/m.
    pub stiffness: Vec<f64>,
    pub(super) both: Vec<f64>,
}

impl CrackState {
    /// A body that has just cracked along `mesh`.
    pub fn new(mesh: CrackedMesh, whole: CrackedMesh) -> Self {
        Self {
            broken: whole,
            mesh,
            joints: Vec::new(),
            loosened: false,
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
            let (lost, now) = joint.glued.step(&joint.law, &a, &b);
            joint.taken += lost.glue;
            if joint.end.is_none() && joint.glued.is_broken(&joint.law) {
                joint.end = Some(time);
            }
            self.flows.glue += lost.glue;
            self.flows.friction += lost.friction;
            self.flows.released += lost.pressure;
            self.stored += now.glue + now.contact;
            joint.add(&now, 1.0, forces);
        }
    }

    /// Finds the stiffness of the joints at the nodes, the sums of its rows: a pair of nodes of masses m and n on a spring k has the
    /// squared frequency k/m + k/n, which is no more than twice the larger part.
    pub fn stiffen(&mut self, nodes: usize) {
        self.stiffness.clear();
        self.stiffness.resize(nodes, 0.0);
        for joint in &self.joints {
            let stiffness = joint.glued.stiffness(&joint.law);
            let [first, second] = &joint.sides;
            for ((a, b), k) in first.iter().zip(second).zip(stiffness) {
                // A node that is not split has no opening.
                if a != b {
                    self.stiffness[*a as usize] += k;
                    self.stiffness[*b as usize] += k;
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

    /// Takes spent joints off the list, and adds them to `spent`. `nodes` are the places of the points of the mesh, m.
    fn retire(&mut self, positions: &[Vector3], nodes: &[Vector3], spent: &mut Vec<CrackFacet>) {
        let Self {
            mesh,
            joints,
            broken,
            ..
        } = self;
        let mut facets = Vec::new();
        joints.retain(|joint| {
            let is_spent = joint.glued.is_spent(&joint.law);
            if is_spent {
                spent.push(CrackFacet::of(joint, positions, mesh.facets(), nodes));
                facets.push(joint.facet);
            }
            !is_spent
        });
        // The facets are those of the mesh.
        let cut = broken.cut(&facets);
        debug_assert!(cut.is_ok(), "facets of this mesh");
        if !facets.is_empty() {
            self.loosened = true;
            self.stiffen(positions.len());
        }
    }
}

impl World {
    /// Takes spent facets off the lists of joints. Called after each step.
    pub(in crate::world) fn retire_cracks(&mut self) {
        let steps = self.steps;
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return;
        };
        let Deformables { models, bodies, .. } = deformables;
        for body in bodies {
            let nodes = models[body.model as usize].model.nodes();
            let State {
                breakable,
                positions,
                rest,
                ..
            } = body;
            if let Some(breakable) = breakable.as_deref_mut()
                && steps.is_multiple_of(LOOKS * u64::from(breakable.fracture.every))
                && !rest.asleep
                && let Some(cracks) = breakable.cracks.as_deref_mut()
            {
                cracks.retire(positions, nodes, &mut breakable.spent);
            }
        }
    }
}
