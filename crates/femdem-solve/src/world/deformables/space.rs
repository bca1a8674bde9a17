//! Deformable bodies in deforming space.

use super::{Deformables, State, centroid};
use femdem_fem::DeformableModel;
use femdem_mesh::Vector3;

impl Deformables {
    /// The bodies of which no node is held, with their models.
    fn free(&self) -> impl Iterator<Item = (&State, &DeformableModel)> {
        let bodies = self.bodies.iter();
        let free = bodies.filter(|body| !body.is_vacant() && body.boundary.is_free());
        free.map(|body| (body, &self.models[body.model as usize].model))
    }

    /// Mass of the free bodies, kg, and their mass times the place of their centre, kg m.
    pub(in crate::world) fn first_moment(&self) -> (f64, Vector3) {
        let sum = |(mass, moment): (f64, Vector3), (body, model): (&State, &DeformableModel)| {
            let own: f64 = model.masses().iter().sum();
            let centre = centroid(&body.positions, model.masses());
            (mass + own, moment + centre * own)
        };
        self.free().fold((0.0, Vector3::zeros()), sum)
    }

    /// Changes the velocity of all nodes of the free bodies by that at their centre of mass. Returns the energy that they gain, J.
    pub(in crate::world) fn follow_space(&mut self, change: impl Fn(&Vector3) -> Vector3) -> f64 {
        let mut gained = 0.0;
        for body in &mut self.bodies {
            if body.is_vacant() || !body.boundary.is_free() {
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
