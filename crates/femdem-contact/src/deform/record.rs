//! Results of the batch of deformable bodies.

use crate::contact::BodyId;
use crate::kernel::mean_penetration;
use femdem_mesh::Vector3;
use serde::{Deserialize, Serialize};

/// Side A of a contact with a deformable body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum DeformablePartner {
    /// Another one, of lower index, or the same: a body that touches itself.
    Deformable(u32),
    /// A rigid body.
    Rigid(BodyId),
    /// A wall, by order of addition.
    Wall(u32),
}

/// A contact, one connected patch: A, and a deformable body B. Vectors are in world axes.
///
/// Where a body touches itself, A and B are the parts of it on both sides. The forces of one that goes round, such as that
/// of a coil of several turns, cancel in the sum, so that `normal` and the forces of its record say little.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DeformableContact {
    /// Side A.
    pub a: DeformablePartner,
    /// Side B, a deformable body.
    pub b: u32,
    /// Number of the patch, from 0: the two may touch in several places.
    pub patch: u32,
    /// Centre of pressure, m.
    pub point: Vector3,
    /// Direction of the elastic force on B: from A to B.
    pub normal: Vector3,
    /// Elastic force, N.
    pub elastic_force: f64,
    /// Normal force on B along `normal`, damping included, N.
    pub normal_force: f64,
    /// Moment on B of the dashpot against rocking, N m.
    pub rocking: Vector3,
    /// Moment of rolling friction on B, N m.
    pub rolling: Vector3,
    /// Friction force on B, N.
    pub friction: Vector3,
    /// Whether every part of the contact slides.
    pub slides: bool,
    /// Contact area, m^2.
    pub area: f64,
    /// Overlap volume, m^3.
    pub volume: f64,
    /// Contact energy U, J.
    pub energy: f64,
    /// Energy in the friction springs, J.
    pub spring_energy: f64,
    /// Normal stiffness, N/m.
    pub stiffness: f64,
    /// Stiffness of all friction springs, N/m.
    pub tangential_stiffness: f64,
}

impl DeformableContact {
    /// Total force on B, N.
    pub fn force_on_b(&self) -> Vector3 {
        self.normal * self.normal_force + self.friction
    }

    /// Penetration estimate, m: overlap volume over contact area.
    pub fn penetration(&self) -> f64 {
        mean_penetration(self.volume, self.area)
    }
}

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
#[derive(Debug, Clone, Copy)]
pub struct NodalState<'a> {
    /// Positions, m.
    pub positions: &'a [Vector3],
    /// Velocities, m/s.
    pub velocities: &'a [Vector3],
    /// Inverse masses, 1/kg; 0 for prescribed nodes.
    pub inverse_masses: &'a [f64],
}
