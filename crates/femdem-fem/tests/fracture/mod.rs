//! Strength, its scatter, and where cracks open.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

mod decide;
mod halves;
mod parts;
mod refusals;
mod strength;
mod weibull;

use femdem_fem::ElementStress;
use femdem_fem::fracture::{Decision, NodalDecision, Strength};
use femdem_mesh::nalgebra::Rotation3;
use femdem_mesh::tet::CrackedMesh;
use femdem_mesh::{Matrix3, TetMesh, Vector3};

const TENSILE: f64 = 5e6;

/// Friction angle with tangent 0.8, cohesion 20 MPa.
fn rock() -> Strength {
    Strength::new(TENSILE, 20e6, 0.8_f64.atan()).unwrap()
}

/// Stress of a uniaxial tension (Pa) along a unit vector.
fn uniaxial(along: &Vector3, stress: f64) -> Matrix3 {
    along * along.transpose() * stress
}

/// Numbers in [-1, 1] from an index.
fn noise(i: u64) -> f64 {
    let x = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 29)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x >> 11) as f64 / (1_u64 << 52) as f64) - 1.0
}

fn noisy(i: u64) -> Vector3 {
    Vector3::from([0, 1, 2].map(|k| noise(i.wrapping_mul(3).wrapping_add(k))))
}

fn rotation(i: u64) -> Matrix3 {
    Rotation3::new(noisy(i) * 3.0).into_inner()
}

/// A mesh, its strengths, positions and stresses.
struct Body {
    cracked: CrackedMesh,
    strengths: Vec<Strength>,
    regions: Vec<u32>,
    factors: Vec<f64>,
    positions: Vec<Vector3>,
    stresses: Vec<ElementStress>,
}

impl Body {
    /// A body under the same stress everywhere.
    fn new(mesh: &TetMesh, cauchy: Matrix3) -> Self {
        Self {
            cracked: CrackedMesh::new(mesh),
            strengths: vec![rock()],
            regions: vec![0; mesh.tets().len()],
            factors: vec![1.0; mesh.points().len()],
            positions: mesh.points().iter().map(|p| p.coords).collect(),
            stresses: vec![
                ElementStress {
                    cauchy,
                    volume_ratio: 1.0
                };
                mesh.tets().len()
            ],
        }
    }

    fn state(&self) -> NodalDecision<'_> {
        NodalDecision {
            strengths: &self.strengths,
            regions: &self.regions,
            factors: &self.factors,
            positions: &self.positions,
            stresses: &self.stresses,
        }
    }

    /// Decides, and gives new nodes their positions.
    fn decide(&mut self) -> Decision {
        let mut cracked = self.cracked.clone();
        let decision = self.state().decide(&mut cracked).unwrap();
        self.cracked = cracked;
        for split in &decision.splits {
            self.positions.push(self.positions[split.node as usize]);
        }
        decision
    }

    /// Area vector of a facet.
    fn area(&self, facet: u32) -> Vector3 {
        let [a, b, c] =
            self.cracked.sides(facet).unwrap()[0].map(|node| self.positions[node as usize]);
        (b - a).cross(&(c - a)) * 0.5
    }
}

/// A block with its points displaced by up to a fifth of a cell, so that no plane of facets is left; `size` in cells of 1 cm.
fn crooked(cells: [u32; 3], seed: u64) -> TetMesh {
    let block = TetMesh::block(cells, &(Vector3::from(cells.map(f64::from)) * 0.01)).unwrap();
    let points = block.points().iter().zip(0..);
    let moved = points.map(|(p, i)| p + noisy(seed * 1_000_003 + i) * 2e-3);
    TetMesh::new(moved.collect(), block.tets().to_vec()).unwrap()
}
