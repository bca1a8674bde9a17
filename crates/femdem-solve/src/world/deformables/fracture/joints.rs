//! Facets that a crack has cut and that glue, pressure and friction still join.

use super::cracks::CrackState;
use femdem_contact::glue::{GlueLaw, GluedFacet, MidSurface};
use femdem_fem::fracture::FractureMode;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A facet of the mesh that is cut and not released.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Joint {
    pub facet: u32,
    /// Its nodes in the first and in the second of its tetrahedra.
    pub sides: [[u32; 3]; 2],
    pub law: GlueLaw,
    pub glued: GluedFacet,
    /// Height of the elements beside it, m.
    pub height: f64,
    /// When it was cut, s.
    pub birth: f64,
    pub mode: FractureMode,
    /// When nothing of its glue was left, s.
    pub end: Option<f64>,
    /// What its glue has dissipated beyond what it was lent, J.
    pub taken: f64,
}

impl Joint {
    /// Where its nodes are, m.
    pub fn places(&self, positions: &[Vector3]) -> [[Vector3; 3]; 2] {
        self.sides
            .map(|side| side.map(|node| positions[node as usize]))
    }
}

impl CrackState {
    /// Advances the joints to the present positions (m), at time `time` (s), and adds their forces to those of the elements (N).
    pub fn join(&mut self, positions: &[Vector3], time: f64, forces: &mut [Vector3]) {
        self.stored = 0.0;
        for joint in &mut self.joints {
            let [a, b] = joint.places(positions);
            let lost = joint.glued.advance(&joint.law, &a, &b);
            let now = joint.glued.forces(&joint.law, &a, &b);
            joint.taken += lost.glue;
            if lost.glue > 0.0 && joint.glued.is_broken(&joint.law) {
                joint.end = Some(time);
            }
            self.flows.glue += lost.glue;
            self.flows.friction += lost.friction;
            self.stored += now.glue + now.contact;
            for (nodes, forces_on) in joint.sides.iter().zip(now.on) {
                for (node, force) in nodes.iter().zip(forces_on) {
                    forces[*node as usize] += force;
                }
            }
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
}

/// A traction (Pa) in the axes of the triangle that it acts on.
pub(super) fn in_axes(
    triangle: &[Vector3; 3],
    traction: impl Fn(&Vector3) -> Vector3,
) -> Option<[f64; 3]> {
    let middle = MidSurface::new(triangle, triangle)?;
    let traction = traction(&middle.axes[0]);
    Some(middle.axes.map(|axis| axis.dot(&traction)))
}
