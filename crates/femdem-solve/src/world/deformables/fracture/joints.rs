//! Facets that a crack has cut and that glue, or the pressure of their birth, still joins.

use femdem_contact::glue::{GlueLaw, GlueLimits, GluedFacet, GluedForces};
use femdem_fem::fracture::FractureMode;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// A facet of the mesh that is cut and not spent.
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
    /// What its glue bears, but for the factors of the strength at its nodes and the stress along the plane that fails.
    pub limits: GlueLimits,
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

    /// Its forces and energies at positions of the nodes, m.
    pub fn forces(&self, positions: &[Vector3]) -> GluedForces {
        let [a, b] = self.places(positions);
        self.glued.forces(&self.law, &a, &b)
    }

    /// Adds its forces, times a sign, to those of the nodes, N.
    pub fn add(&self, own: &GluedForces, sign: f64, forces: &mut [Vector3]) {
        for (nodes, on) in self.sides.iter().zip(&own.on) {
            for (node, force) in nodes.iter().zip(on) {
                forces[*node as usize] += force * sign;
            }
        }
    }
}
