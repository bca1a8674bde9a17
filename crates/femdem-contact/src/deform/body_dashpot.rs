//! The dashpot of bodies as wholes.
//!
//! The dashpot along the gradient of U (see [`super::respond`]) is that of the nodes that touch: its coefficient is the
//! fraction ζ of the critical one of their mass. A body much stiffer than its contact swings on it as a whole, with all of
//! its mass M, and would be damped by √(m/M) of what ζ asks for, the less the finer its mesh. What is missing acts on
//! the bodies as wholes: for the wrench f of the patch on each body,
//!
//! F_d = -c f (f · u), c = α 2 ζ (1/√R - 1/√r)/√(2U),
//!
//! u the velocities of the bodies as wholes (that of the centre, and the turning of [`super::rocking`]), R the sum of
//! |f|²/M + t I⁻¹ t over both with the torques t, and r the same of the nodes. F_d is spread over all nodes in proportion to
//! their masses, as if the body were rigid: it only dissipates, keeps momentum and angular momentum, strains
//! nothing, and its rate is that of a body, which costs no step. For a rigid motion both dashpots together are the
//! one of rigid bodies (see [`crate::damping`]).
//!
//! A body softer than its contact yields itself, and must not be braked as a whole while it does:
//! α = 1/(1 + (ω_c/ω)²)², with ω_c = √(R/(2U)) the frequency of the bodies on the contact and ω that of the slowest elastic
//! oscillation of either ([`ContactBatch::set_frequency`](crate::ContactBatch::set_frequency)); 0 where ω is not
//! known. A body of which nodes are held does not move as a whole.

use super::pair::{Mover, Pair};
use super::patches::Patch;
use femdem_mesh::Vector3;

/// The dashpot of one patch.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BodyDashpot {
    /// Viscous over elastic force.
    pub scale: f64,
    /// c, 1/(N s).
    pub coefficient: f64,
    /// Force and torque on A and on B about their centres, N and N m; zero on rigid bodies, which have it in their load.
    pub wrench: [[Vector3; 2]; 2],
    /// For the step, 1/s.
    pub rates: [f64; 2],
    /// W.
    pub power: f64,
}

/// Wrenches on both bodies, taken as wholes.
#[derive(Debug, Clone, Copy)]
struct AsWholes {
    /// R, and the parts of it of the bodies that deform, N²/kg.
    all: f64,
    own: [f64; 2],
    /// W.
    power: f64,
    /// The wrenches about the centres of the bodies that deform.
    wrench: [[Vector3; 2]; 2],
    /// The slowest elastic oscillation, rad/s; infinite if no body deforms and moves.
    slowest: f64,
    /// Number of bodies that move.
    moving: f64,
}

/// All patches of a pair all. Patches that press the same way share one dashpot, as those of a rigid body do
/// ([`crate::damping`]), and patches that press against each other have one each.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AllPatches {
    /// Sum of the forces of the patches, N, and their energy, J.
    pressing: f64,
    energy: f64,
    /// Inverse mass along the sum of the forces, 1/kg; infinite where they cancel.
    inverse_mass: f64,
}

impl Pair<'_> {
    fn response_as_wholes(&self, wrench: &[[Vector3; 2]; 2]) -> AsWholes {
        let mut found = AsWholes {
            all: 0.0,
            own: [0.0; 2],
            power: 0.0,
            wrench: Default::default(),
            slowest: f64::INFINITY,
            moving: 0.0,
        };
        for (side, wrench) in wrench.iter().enumerate() {
            let [force, about] = wrench;
            let torque = |centre: &Vector3| about + (self.near.origin - centre).cross(force);
            let (response, power) = match (&self.movers[side], self.turnings[side]) {
                (Mover::Rigid(motion), _) => self.rigid_response(motion, wrench),
                (Mover::Nodes(_), Some(turning)) if turning.is_whole() && !self.is_own() => {
                    let torque = torque(turning.centre());
                    found.slowest = found.slowest.min(self.frequencies[side]);
                    found.wrench[side] = [*force, torque];
                    found.own[side] = turning.response(force, &torque);
                    (found.own[side], turning.power(force, &torque))
                }
                _ => (0.0, 0.0),
            };
            found.all += response;
            found.power += power;
            found.moving += if response > 0.0 { 1.0 } else { 0.0 };
        }
        found
    }

    /// The patches of a pair with an energy, J.
    pub fn all_patches(&self, patches: &[Patch], energy: f64) -> AllPatches {
        let mut sum = [[Vector3::zeros(); 2]; 2];
        for part in patches {
            for (total, part) in sum.iter_mut().flatten().zip(part.wrench.iter().flatten()) {
                *total += part;
            }
        }
        let pressing: f64 = patches.iter().map(|p| p.wrench[1][0].norm()).sum();
        let square = sum[1][0].norm_squared();
        AllPatches {
            pressing,
            energy,
            inverse_mass: self.response_as_wholes(&sum).all * (pressing / square).powi(2),
        }
    }

    /// `rate` is what the other dashpot has of viscous over elastic force for each m/s, s/m, and `scale` what it makes of
    /// the elastic force: together they leave no tension.
    pub fn body_dashpot(
        &self,
        patch: &Patch,
        all: &AllPatches,
        rate: f64,
        scale: f64,
    ) -> BodyDashpot {
        let response = self.response_as_wholes(&patch.wrench);
        let force = patch.wrench[1][0].norm();
        // The quotient of forces that cancel has no value.
        let inverse_mass = all.inverse_mass.min(response.all / (force * force));
        let twice = 2.0 * all.energy;
        let softness = inverse_mass * all.pressing.powi(2) / (twice * response.slowest.powi(2));
        let part = 1.0 / (1.0 + softness).powi(2);
        let asked = 2.0 * self.law.damping_ratio / (twice * inverse_mass).sqrt();
        let coefficient = part * (asked - rate) / force;
        // Written so that NaN fails it too: nothing moves as a whole, or nothing is missing.
        let acts =
            response.slowest < f64::INFINITY && coefficient > 0.0 && coefficient < f64::INFINITY;
        if !acts {
            return BodyDashpot::default();
        }
        let factor = (-coefficient * response.power).max(-scale);
        BodyDashpot {
            scale: factor,
            coefficient,
            wrench: response
                .wrench
                .map(|wrench| wrench.map(|part| part * factor)),
            rates: response.own.map(|own| coefficient * own * response.moving),
            power: factor * response.power,
        }
    }
}
