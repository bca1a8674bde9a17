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
//! oscillation of either ([`DeformableBatch::set_frequency`](super::DeformableBatch::set_frequency)); 0 where ω is not
//! known. A body of which nodes are held does not move as a whole.

use super::patches::Patch;
use super::respond::{Mover, Pair};
use femdem_mesh::Vector3;

/// What it does in a step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Whole {
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

impl Pair<'_> {
    /// `energy` is that of the patch, J, `response` is r, N²/kg, and `scale` what the other dashpot makes of the elastic
    /// force: together they leave no tension.
    pub fn whole(&self, patch: &Patch, energy: f64, response: f64, scale: f64) -> Whole {
        let mut whole = Whole::default();
        let (mut all, mut power) = (0.0, 0.0);
        let (mut slowest, mut moving) = (f64::INFINITY, 0.0);
        let mut own = [0.0; 2];
        for (side, own) in own.iter_mut().enumerate() {
            let [force, about] = patch.wrench[side];
            let torque = |centre: &Vector3| about + (self.near.origin - centre).cross(&force);
            let (response, of_side) = match (&self.movers[side], self.turnings[side]) {
                (Mover::Rigid(motion), _) => {
                    let torque = torque(&motion.frame.position);
                    let turned = torque.dot(&(motion.inverse_inertia * torque));
                    let response = force.norm_squared() * motion.inverse_mass + turned;
                    let (v, w) = (&motion.velocity, &motion.angular_velocity);
                    (response, force.dot(v) + torque.dot(w))
                }
                (Mover::Nodes(_), Some(turning)) if turning.is_whole() => {
                    let torque = torque(turning.centre());
                    slowest = slowest.min(self.frequencies[side]);
                    whole.wrench[side] = [force, torque];
                    *own = turning.response(&force, &torque);
                    (*own, turning.power(&force, &torque))
                }
                _ => (0.0, 0.0),
            };
            all += response;
            power += of_side;
            moving += if response > 0.0 { 1.0 } else { 0.0 };
        }
        let softness = all / (2.0 * energy * slowest * slowest);
        let part = 1.0 / (1.0 + softness).powi(2);
        let missing = 1.0 / all.sqrt() - 1.0 / response.sqrt();
        let coefficient = part * 2.0 * self.law.damping_ratio * missing / (2.0 * energy).sqrt();
        // Written so that NaN fails it too: nothing moves as a whole, or nothing is missing.
        let acts = slowest < f64::INFINITY && coefficient > 0.0 && coefficient < f64::INFINITY;
        if !acts {
            return Whole::default();
        }
        whole.coefficient = coefficient;
        whole.scale = (-coefficient * power).max(-scale);
        whole.power = whole.scale * power;
        whole.rates = own.map(|response| coefficient * response * moving);
        for part in whole.wrench.iter_mut().flatten() {
            *part *= whole.scale;
        }
        whole
    }
}
