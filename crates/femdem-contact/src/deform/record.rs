//! States of deformable bodies, and what their contacts do.

use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Sums over the contacts of deformable bodies, at the last update.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct DeformableTotals {
    /// Contact energy, J.
    pub energy: f64,
    /// Energy in the friction springs, J.
    pub spring_energy: f64,
    /// Power of the damping forces at the velocities given, W; negative where they dissipate.
    pub damping_power: f64,
    /// Power of the friction forces at the velocities given, W. The part of the lost energy that is not
    /// stored as spring energy is dissipated.
    pub friction_power: f64,
    /// Candidate pairs of bodies.
    pub pairs: usize,
    /// Touching ones among them.
    pub touching: usize,
    /// Pairs of tetrahedra tested.
    pub candidates: usize,
    /// Those in which the skin of one lies in the other.
    pub pieces: usize,
}

impl std::ops::AddAssign<&Self> for DeformableTotals {
    fn add_assign(&mut self, other: &Self) {
        self.energy += other.energy;
        self.spring_energy += other.spring_energy;
        self.damping_power += other.damping_power;
        self.friction_power += other.friction_power;
        self.pairs += other.pairs;
        self.touching += other.touching;
        self.candidates += other.candidates;
        self.pieces += other.pieces;
    }
}

/// Positions, velocities and inverse masses of the nodes of a deformable body.
#[derive(Debug, Clone, Copy, Default)]
pub struct NodalState<'a> {
    /// Positions, m.
    pub positions: &'a [Vector3],
    /// Velocities, m/s.
    pub velocities: &'a [Vector3],
    /// Inverse masses, 1/kg; 0 for prescribed nodes.
    pub inverse_masses: &'a [f64],
}

/// What the contacts do to the nodes of a deformable body: one value for each node.
#[derive(Debug, Clone, Copy, Default)]
pub struct NodalLoads<'a> {
    /// Forces, N: elastic, damping and friction.
    pub forces: &'a [Vector3],
    /// The part of the forces due to damping, N.
    pub damping: &'a [Vector3],
    /// The part of the forces due to friction, N.
    pub friction: &'a [Vector3],
    /// Stiffness k, N/m: a node of mass m adds 2 k/m to the squared frequency that bounds the step.
    pub stiffness: &'a [f64],
    /// Damping rates, 1/s: the rate in [`stable_step`](crate::stable_step).
    pub rates: &'a [f64],
}
