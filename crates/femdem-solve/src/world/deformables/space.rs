//! Deformable bodies in deforming space.

use super::{Deformables, State, centroid};
use femdem_contact::BodyId;
use femdem_mesh::Vector3;

impl Deformables {
    /// Changes the velocity of all nodes of the free bodies among those that follow by that at their centre of mass. Returns the
    /// energy that they gain, J.
    pub(in crate::world) fn follow_space(
        &mut self,
        follows: impl Fn(BodyId) -> bool,
        change: impl Fn(&Vector3) -> Vector3,
    ) -> f64 {
        let mut gained = 0.0;
        for (id, body) in (0..).zip(&mut self.bodies) {
            if body.is_vacant() || !body.boundary.is_free() || !follows(id) {
                continue;
            }
            let masses = self.models[body.model as usize].model.masses();
            let before = body.kinetic_energy(masses);
            let change = change(&centroid(&body.positions, masses));
            body.velocities.iter_mut().for_each(|v| *v += change);
            let speeds = body.velocities.iter().map(Vector3::norm);
            body.fastest = speeds.fold(0.0, f64::max);
            gained += body.kinetic_energy(masses) - before;
        }
        gained
    }
}

impl State {
    /// Mass of a free body, kg, and its mass times the place of its centre, kg m; `None` for one that is held.
    pub(in crate::world) fn first_moment(&self, masses: &[f64]) -> Option<(f64, Vector3)> {
        let mass: f64 = masses.iter().sum();
        let is_free = self.boundary.is_free();
        is_free.then(|| (mass, centroid(&self.positions, masses) * mass))
    }
}
