//! Kinetic damping: bodies are stopped where they pass their equilibrium (Barnes 1999, "Form finding and analysis of tension
//! structures by dynamic relaxation"). What it takes is booked as [`Ledger::frozen`](crate::Ledger::frozen).

use super::World;
use crate::error::SolveError;
use crate::halo::Halo;
use femdem_mesh::Vector3;

impl World {
    pub(super) fn stop_body(&mut self, i: usize) {
        let body = &mut self.bodies[i];
        self.flows.frozen += body.kinetic_energy();
        body.velocity = Vector3::zeros();
        body.momentum = Vector3::zeros();
        self.motions[i] = body.motion();
        if let Some(ahead) = self.ahead.get_mut(i) {
            *ahead = self.motions[i];
        }
    }

    /// Stops all awake rigid bodies except driven ones. Their kinetic energy is booked as
    /// [`Ledger::frozen`](crate::Ledger::frozen).
    ///
    /// Called whenever the bodies begin to [slow down](Self::is_slowing), this is kinetic damping (Barnes
    /// 1999, "Form finding and analysis of tension structures by dynamic relaxation"): each slow oscillation
    /// ends within a few quarters of its period, and steady motion is not resisted.
    pub fn stop(&mut self) {
        self.stop_rigid();
        // The recorded dashpot forces belong to the earlier velocities.
        self.loaded = false;
    }

    /// The same, for bodies without dashpots.
    pub(super) fn stop_rigid(&mut self) {
        for k in 0..self.awake.len() {
            let i = self.awake[k] as usize;
            if self.bodies[i].driven.is_none() {
                self.stop_body(i);
            }
        }
    }

    /// Whether more of the awake rigid bodies are losing kinetic energy than gaining it; driven ones do not
    /// count. It counts bodies instead of comparing the total energy, so that a single body does not decide.
    pub fn is_slowing(&self) -> bool {
        let [losing, gaining] = self.slowing();
        losing > gaining
    }

    /// As [`is_slowing`](Self::is_slowing), of the bodies of all ranks.
    ///
    /// # Errors
    /// What `halo` reports.
    pub fn is_slowing_on(&self, halo: &mut dyn Halo) -> Result<bool, SolveError> {
        let mut counts = self.slowing();
        halo.sum(&mut counts)?;
        Ok(counts[0] > counts[1])
    }

    /// How many awake rigid bodies are losing kinetic energy, and how many are gaining it.
    fn slowing(&self) -> [u64; 2] {
        let loads = self.batch.loads();
        let mut counts = [0; 2];
        for &i in &self.awake {
            let (body, load) = (&self.bodies[i as usize], &loads[i as usize]);
            if body.driven.is_some() {
                continue;
            }
            let weight = self.parameters.gravity * body.mass;
            let mut wrench = load.total;
            wrench += &body.applied();
            let power = (wrench.force + weight).dot(&body.velocity)
                + wrench.torque.dot(&body.angular_velocity());
            counts[0] += u64::from(power < 0.0);
            counts[1] += u64::from(power > 0.0);
        }
        counts
    }
}
